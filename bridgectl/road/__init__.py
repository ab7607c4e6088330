"""Roads: read, measured and made; the ramps a tire meets on them; bumps and joints."""

from bridgectl.road.events import RoadEvent, add_events
from bridgectl.road.files.lines import ProfileFileError
from bridgectl.road.files.read import read_profile, read_tracks, utia_road
from bridgectl.road.files.write import write_profile
from bridgectl.road.filtered import shaping_filter
from bridgectl.road.footprint import tire_footprint
from bridgectl.road.iso8608 import iso8608_elevations, iso8608_profile, ramp_covariance
from bridgectl.road.profile import RoadProfile
from bridgectl.road.psd import PsdFit, RoadPsd, class_roughness
from bridgectl.road.shapes import bump, plank, pothole, ramp, settlement, step

__all__ = [
    "ProfileFileError", "PsdFit", "RoadEvent", "RoadProfile", "RoadPsd", "add_events", "bump",
    "class_roughness", "iso8608_elevations", "iso8608_profile", "plank", "pothole", "ramp",
    "ramp_covariance", "read_profile", "read_tracks", "settlement", "shaping_filter", "step",
    "tire_footprint", "utia_road", "write_profile",
]  # fmt: skip
