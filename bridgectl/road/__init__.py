"""Roads: elevation profiles, the ramps a tire meets on them, and the files they come in."""

from .profile import RoadProfile
from .read import ProfileFileError, read_profile, utia_road

__all__ = ["ProfileFileError", "RoadProfile", "read_profile", "utia_road"]
