"""Every figure, in one look.

The functions return axes or figures and leave `matplotlib.pyplot` alone: save with
``figure.savefig(path)``, or ``axes.figure.savefig(path)``.
"""

from bridgectl.plots.animation import crossing_animation
from bridgectl.plots.bridge import (
    dae_figure,
    lines_plot,
    paper_figure,
    smooth_daf_plot,
    surface_plot,
)
from bridgectl.plots.damper_validation import damper_validation_figure
from bridgectl.plots.effects import effects_figure
from bridgectl.plots.ramp_heights import ramp_height_figure
from bridgectl.plots.roads import pair_figure, profile_figure, psd_plot
from bridgectl.plots.scores import score_figure
from bridgectl.plots.validation import validation_figure

__all__ = [
    "crossing_animation",
    "dae_figure",
    "damper_validation_figure",
    "effects_figure",
    "lines_plot",
    "pair_figure",
    "paper_figure",
    "profile_figure",
    "psd_plot",
    "ramp_height_figure",
    "score_figure",
    "smooth_daf_plot",
    "surface_plot",
    "validation_figure",
]
