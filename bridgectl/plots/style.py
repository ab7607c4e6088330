"""One look for every figure: colours that colour-blind readers tell apart, and units."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import Any, ParamSpec, TypeVar

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure

# Okabe and Ito's palette, and what the bridge is made of.
SKY, BLUE, VERMILLION = "#56B4E9", "#0072B2", "#D55E00"
TRACKS = (BLUE, VERMILLION, "#009E73", "#CC79A7", "#E69F00")
BLACK, GREY = "#222222", "#8a8a8a"
GROUND, PAVEMENT, DECK, BRIDGE_TINT = "#ddd8cc", "#aeb8bf", "#3f4a52", "#edf4f9"

STYLE: Any = {
    "font.size": 10.0, "axes.titlesize": 10.5, "axes.titlelocation": "left", "axes.edgecolor": GREY,
    "axes.spines.top": False, "axes.spines.right": False, "axes.axisbelow": True, "axes.grid": True,
    "grid.color": "#e4e4e4",
    "grid.linewidth": 0.7, "legend.frameon": False, "savefig.dpi": 160.0,
}  # fmt: skip

SPEED_LABEL = "speed [km/h]"
PLACE_LABEL = "start of the ramp, x/l [-]"
STATION_LABEL = "x from the start of the bridge [m]"

P = ParamSpec("P")
T = TypeVar("T")


def styled(draw: Callable[P, T]) -> Callable[P, T]:
    """Draw in this look, whatever the reader's own."""

    @wraps(draw)
    def styled(*args: P.args, **kwargs: P.kwargs) -> T:
        with mpl.rc_context(STYLE):
            return draw(*args, **kwargs)

    return styled


def new_axes(ax: Axes | None) -> Axes:
    """Return the axes given, or those of a new figure."""
    return Figure(layout="constrained").subplots() if ax is None else ax
