"""Every figure, in one look.

The functions return axes or figures and leave `matplotlib.pyplot` alone: save with
``figure.savefig(path)``, or ``axes.figure.savefig(path)``. They import nothing of what they draw,
and `bridgectl.plots.shown` says what that must have: any result may draw itself.
"""

from bridgectl.plots.dae import dae_figure
from bridgectl.plots.ramp_heights import ramp_height_figure
from bridgectl.plots.roads import pair_figure, profile_figure, psd_plot
from bridgectl.plots.scores import score_figure
from bridgectl.plots.surface import (
    effects_figure,
    lines_plot,
    paper_figure,
    smooth_daf_plot,
    surface_plot,
)
from bridgectl.plots.validation import damper_validation_figure, validation_figure

__all__ = [
    "dae_figure", "damper_validation_figure", "effects_figure", "lines_plot", "pair_figure",
    "paper_figure", "profile_figure", "psd_plot", "ramp_height_figure", "score_figure",
    "smooth_daf_plot", "surface_plot", "validation_figure",
]  # fmt: skip
