"""A crossing in slow motion, as a page that any browser shows."""

from pathlib import Path

import bridgectl as bc

road = bc.iso8608_profile("B", 50, seed=1, start=-20)
film = bc.crossing_animation(
    bc.li2006.beam(), bc.trucks.load("T2"), 80 / 3.6, road, start=-20, frames=20
)
page = Path("crossing.html")
page.write_text(film.to_jshtml())
print(f"{page}: {page.stat().st_size / 1e3:.0f} KB")
