"""Roads: read, measured and made; the ramps a tire meets on them; bumps and joints."""

from .events import RoadEvent, add_events
from .footprint import tire_footprint
from .iso8608 import iso8608_elevations, iso8608_profile, ramp_covariance, shaping_filter
from .lines import ProfileFileError
from .profile import RoadProfile
from .psd import PsdFit, RoadPsd, class_roughness
from .read import read_profile, read_tracks, utia_road
from .shapes import bump, plank, pothole, ramp, settlement, step
from .write import write_profile

__all__ = [
    "ProfileFileError",
    "PsdFit",
    "RoadEvent",
    "RoadProfile",
    "RoadPsd",
    "add_events",
    "bump",
    "class_roughness",
    "iso8608_elevations",
    "iso8608_profile",
    "plank",
    "pothole",
    "ramp",
    "ramp_covariance",
    "read_profile",
    "read_tracks",
    "settlement",
    "shaping_filter",
    "step",
    "tire_footprint",
    "utia_road",
    "write_profile",
]
