"""The figure of the validation of dampers: class DAE over simulated mean DAF, case by case."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bridgectl.plots.shown import DamperCaseShown
from bridgectl.plots.style import BLACK, BLUE, GREY, VERMILLION, styled


@styled
def damper_validation_figure(cases: Sequence[DamperCaseShown]) -> Figure:
    """Draw the class DAE of every damper over its simulated mean DAF, and the mean of Eq. (15).

    A row for each road class, a column for each bridge.
    """
    spans = list(dict.fromkeys(case.span for case in cases))
    classes = list(dict.fromkeys(case.road_class for case in cases))
    size = (1.0 + 3.9 * len(spans), 0.8 + 3.5 * len(classes))
    figure = Figure(figsize=size, layout="constrained")
    panels = figure.subplots(len(classes), len(spans), squeeze=False)
    for case in cases:
        _draw(panels[classes.index(case.road_class), spans.index(case.span)], case)
    for panel in panels[-1]:
        panel.set_xlabel("simulated mean DAF [-]")
    for panel in panels[:, 0]:
        panel.set_ylabel("DAE [-]")
    handles, labels = panels[0, 0].get_legend_handles_labels()
    columns = len(spans) if len(spans) < 3 else 4  # of entries, as many as fit
    figure.legend(handles, labels, loc="outside lower center", ncols=columns)
    return figure


def _draw(ax: Axes, case: DamperCaseShown) -> None:
    daf, known = case.mean_daf, slice(case.n_known)
    unseen = slice(case.n_known, None)
    ax.plot(daf, case.mean_eq_15, ".", color=GREY, ms=5, label="mean of Eq. (15)", zorder=1)
    ax.plot(daf[known], case.class_dae[known], "o", color=BLUE, ms=5,
            label="class DAE, dampers of the formula")  # fmt: skip
    ax.plot(daf[unseen], case.class_dae[unseen], "^", color=VERMILLION, ms=5.5,
            label="class DAE, unseen dampers")  # fmt: skip
    values = np.concatenate([daf, case.class_dae, case.mean_eq_15])
    ends = values.min(), values.max()
    ax.plot(ends, ends, ":", color=BLACK, lw=0.8, label="equal", zorder=0)
    clear = case.clear_pairs
    ax.set_title(
        f"{case.span:g} m, class {case.road_class}: tau {case.tau.tau:.2f}\n"
        f"{clear.right} of {clear.number} clear pairs in order"
    )
    ax.locator_params(nbins=5)
