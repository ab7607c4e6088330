"""A crossing in slow motion, as a page that any browser shows."""

from pathlib import Path

import bridgectl as bc

road = bc.iso8608_profile("B", 45, seed=1, start=-20)
film = bc.crossing_animation(bc.li2006.beam(), bc.li2006.car(), 80 / 3.6, road, start=-20, frames=8)
Path("crossing.html").write_text(film.to_jshtml(), encoding="utf-8")
print(f"{len(list(film.new_frame_seq()))} pictures, {film.event_source.interval:g} ms each")
