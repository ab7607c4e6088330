"""A crossing in slow motion, as a page that any browser shows."""

from pathlib import Path

import bridgectl as bc

road, page = bc.iso8608_profile("B", 45, seed=1, start=-20), Path("crossing.html")
film = bc.crossing_animation(bc.li2006.beam(), bc.li2006.car(), 80 / 3.6, road, start=-20, frames=8)
page.write_text(film.to_jshtml(), encoding="utf-8")
print(f"{page.name}: {page.read_text(encoding='utf-8').count('data:image/png')} pictures")
