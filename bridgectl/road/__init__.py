"""Roads: read, measured and made; the ramps a tire meets on them; bumps and joints.

`RoadProfile` and what reads, writes and makes whole roads are names of `bridgectl` itself.
"""

from bridgectl._gone import no_attribute
from bridgectl.road.events import add_events
from bridgectl.road.files.lines import ProfileFileError as ProfileFileError
from bridgectl.road.files.read import read_profile as read_profile
from bridgectl.road.files.read import read_tracks as read_tracks
from bridgectl.road.files.read import utia_road as utia_road
from bridgectl.road.files.write import write_profile as write_profile
from bridgectl.road.filtered import shaping_filter
from bridgectl.road.footprint import tire_footprint
from bridgectl.road.iso8608 import iso8608_elevations
from bridgectl.road.iso8608 import iso8608_profile as iso8608_profile
from bridgectl.road.profile import RoadProfile as RoadProfile
from bridgectl.road.shapes import bump, plank, ramp, settlement, step

__all__ = [
    "add_events", "bump", "iso8608_elevations", "plank", "ramp", "settlement", "shaping_filter",
    "step", "tire_footprint",
]  # fmt: skip


def __getattr__(name: str) -> object:
    raise no_attribute(__name__, name)
