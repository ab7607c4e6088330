"""Every figure, in one look.

What can be drawn has a method ``plot``; figures that need more are here.
They return figures or axes and leave `matplotlib.pyplot` alone: save with
``figure.savefig(path)``. But what python-control would draw, responses and Bode plots, comes as
its own `control.ControlPlot`, in a figure of pyplot: save with ``plot.figure.savefig(path)``. The
modules import nothing of what they draw, and `bridgectl.plots.shown` says what that must have.
"""

from bridgectl._gone import no_attribute
from bridgectl.plots.bridge import bridge_plot
from bridgectl.plots.dae import dae_figure
from bridgectl.plots.responses import response_figure
from bridgectl.plots.surface import effects_figure
from bridgectl.plots.vehicles import vehicle_plot

__all__ = ["bridge_plot", "dae_figure", "effects_figure", "response_figure", "vehicle_plot"]


def __getattr__(name: str) -> object:
    raise no_attribute(__name__, name)
