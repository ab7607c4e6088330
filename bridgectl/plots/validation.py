"""Figures of the validations: DAF and DAE, Figs. 8, 9 and 11 of the paper, and of dampers."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator, MultipleLocator

from bridgectl._places import SAME_PLACE
from bridgectl._units import to_kmh
from bridgectl.plots import style
from bridgectl.plots.shown import CaseShown, DamperCaseShown, RoadShown, ValidationShown

ROW, COLUMN, ROAD, FOOT = 1.2, 1.3, 2.3, 3.2
"""Height of a road's panels, width of a bridge's, width of the elevations, the last row [in]."""

ROUND_OFF = 1e-6
"""Differences of peaks up to this are drawn as equal."""


@style.styled
def validation_figure(results: ValidationShown) -> Figure:
    """Draw DAF and DAE over speed of every road on every bridge, and the peaks of all.

    As Figs. 8, 9 and 11 of the paper.
    """
    groups, n_roads = results.groups, len(results.roads)
    width = ROAD + COLUMN * max(len(groups), 4)
    heights = (ROW * n_roads + 0.9, FOOT)
    figure = Figure(figsize=(width, sum(heights)), layout="constrained")
    above, below = figure.subfigures(2, 1, squeeze=False, height_ratios=heights)[:, 0]
    widths = (ROAD, *[(width - ROAD) / len(groups)] * len(groups))
    panels = above.subplots(n_roads, 1 + len(groups), sharex="col", squeeze=False,
                            width_ratios=widths)  # fmt: skip
    longest = max(span for span, _ in groups)
    for row, road in zip(panels, results.roads, strict=True):
        _draw_road(row[0], road, max(approach for _, approach in groups), longest)
    for column, ((span, approach), cases) in enumerate(groups.items(), 1):
        for row, case in zip(panels, cases, strict=True):
            _draw_case(row[column], case)
        panels[0, column].set_title(f"{span:g} m bridge,\n{_start(approach)}")
    for row in panels:
        _share_heights(row[1:])
        row[1].set_ylabel("DAF [-]")
    panels[-1, 0].set_xlabel(style.STATION_LABEL)
    for panel in panels[-1, 1:]:
        panel.set_xlabel(style.SPEED_LABEL)
    handles, _ = panels[0, 1].get_legend_handles_labels()  # not the speeds of lift-off
    above.legend(handles=handles, loc="outside upper right", ncols=len(handles))
    peaks, differences = below.subplots(1, 2, width_ratios=(1, 1.4))
    _draw_peaks(peaks, results)
    _draw_differences(differences, results)
    return figure


def _draw_road(ax: Axes, road: RoadShown, approach: float, span: float) -> None:
    """Elevation of a road, with the longest bridge."""
    shown = (road.x >= -approach - SAME_PLACE) & (road.x <= span + SAME_PLACE)
    ax.axvspan(0, span, color=style.BRIDGE_TINT, zorder=0)
    ax.plot(road.x[shown], 1e3 * road.elevation[shown], color=style.BLACK, lw=0.9)
    ax.set_title(road.name, fontsize=9.5, parse_math=False)
    ax.set_ylabel("z [mm]")
    ax.margins(x=0.01)
    ax.yaxis.set_major_locator(MaxNLocator(3))


def _draw_case(ax: Axes, case: CaseShown) -> None:
    order = np.argsort(case.speeds)
    kmh = to_kmh(case.speeds[order])
    marker = "o" if len(kmh) < 15 else ""
    ax.plot(kmh, case.superposed[order], color=style.SKY, lw=4.0, label="superposed DAF")
    ax.plot(kmh, case.simulated[order], color=style.BLACK, lw=1.1, label="simulated DAF",
            marker=marker, ms=2.5)  # fmt: skip
    ax.plot(kmh, case.dae[order], "--", color=style.VERMILLION, lw=1.4, label="DAE",
            marker=marker, ms=2.5)  # fmt: skip
    for speed in to_kmh(case.speeds[case.flying]):
        ax.axvline(speed, color=style.GREY, lw=2.0, alpha=0.3, zorder=0)
    ax.xaxis.set_major_locator(MultipleLocator(50) if np.ptp(kmh) > 60 else MaxNLocator(3))
    ax.yaxis.set_major_locator(MaxNLocator(4))
    ax.margins(x=0.02, y=0.08)


def _start(approach: float) -> str:
    return f"from {0.0 - approach:g} m"


def _share_heights(panels: Sequence[Axes]) -> None:
    """One scale for a road on all bridges, with numbers at the first only."""
    limits = [panel.get_ylim() for panel in panels]
    for panel in panels:
        panel.set_ylim(min(low for low, _ in limits), max(high for _, high in limits))
        panel.tick_params(labelleft=panel is panels[0])


def _look(case: CaseShown, results: ValidationShown) -> dict[str, object]:
    """One colour for each span, open markers for a start at rest."""
    spans = list(dict.fromkeys(span for span, _ in results.groups))
    color = style.TRACKS[spans.index(case.span) % len(style.TRACKS)]
    face = color if case.approach else "white"
    return {"marker": "o", "ms": 5.5, "ls": "", "color": color, "mfc": face, "mew": 1.3}


def _draw_peaks(ax: Axes, results: ValidationShown) -> None:
    """Peak DAE over peak DAF of every case, beside the line of equal ones."""
    peaks = np.array([(case.daf_peak.value, case.dae_peak.value) for case in results.cases])
    low, high = peaks.min(), peaks.max()
    ends = np.array([low, high]) + max(0.04 * (high - low), 0.005) * np.array([-1, 1])
    ax.plot(ends, ends, color=style.GREY, lw=1.0, label="equal")
    for case, (daf, dae) in zip(results.cases, peaks, strict=True):
        ax.plot(daf, dae, **_look(case, results))  # type: ignore[arg-type]
    ax.set(
        xlim=ends, ylim=ends, aspect="equal", xlabel="peak DAF [-]", ylabel="peak DAE [-]",
        title=f"peaks over the speeds\nof {len(peaks)} cases",
    )  # fmt: skip
    worst = results.worst_peak
    if abs(worst.peak_difference) > results.peak_tolerance:
        place = worst.daf_peak.value, worst.dae_peak.value
        side = -9 if worst.daf_peak.value > ends.mean() else 9  # towards the middle
        ax.annotate(
            f"road {worst.road}", place, (side, 0), textcoords="offset points", va="center",
            ha="left" if side > 0 else "right",
        )  # fmt: skip


def _draw_differences(ax: Axes, results: ValidationShown) -> None:
    """Size of the difference of the peaks, road by road."""
    groups = list(results.groups)
    for case in results.cases:
        shift = (groups.index((case.span, case.approach)) - (len(groups) - 1) / 2) * 0.11
        size = max(abs(case.peak_difference), ROUND_OFF)
        ax.plot(case.road + shift, size, clip_on=False, **_look(case, results))  # type: ignore[arg-type]
    bound = results.peak_tolerance
    label = f"bound of the median, {bound:g}"
    handles = [ax.axhline(bound, color=style.GREY, ls="--", lw=1.2, label=label)]
    ax.set(
        yscale="log", ylim=(ROUND_OFF, 1), xlim=(0.5, len(results.roads) + 0.5), xlabel="road",
        ylabel="|peak DAE - peak DAF| [-]",
        title=f"differences of the peaks; at the foot: {ROUND_OFF:.0e} and less",
    )  # fmt: skip
    ax.set_xticks(range(1, len(results.roads) + 1))
    ax.grid(axis="x", visible=False)
    for span, approach in groups:
        look = _look(results.groups[span, approach][0], results)
        handles.append(Line2D([], [], label=f"{span:g} m bridge, {_start(approach)}", **look))  # type: ignore[arg-type]
    ax.legend(handles=handles, loc="upper left", bbox_to_anchor=(1.0, 1.0))


@style.styled
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
        _draw_damper_case(panels[classes.index(case.road_class), spans.index(case.span)], case)
    for panel in panels[-1]:
        panel.set_xlabel("simulated mean DAF [-]")
    for panel in panels[:, 0]:
        panel.set_ylabel("DAE [-]")
    handles, labels = panels[0, 0].get_legend_handles_labels()
    columns = len(spans) if len(spans) < 3 else 4  # of entries, as many as fit
    figure.legend(handles, labels, loc="outside lower center", ncols=columns)
    return figure


def _draw_damper_case(ax: Axes, case: DamperCaseShown) -> None:
    daf, known = case.mean_daf, slice(case.n_known)
    unseen = slice(case.n_known, None)
    ax.plot(daf, case.mean_eq_15, ".", color=style.GREY, ms=5, label="mean of Eq. (15)", zorder=1)
    ax.plot(daf[known], case.class_dae[known], "o", color=style.BLUE, ms=5,
            label="class DAE, dampers of the formula")  # fmt: skip
    ax.plot(daf[unseen], case.class_dae[unseen], "^", color=style.VERMILLION, ms=5.5,
            label="class DAE, unseen dampers")  # fmt: skip
    values = np.concatenate([daf, case.class_dae, case.mean_eq_15])
    ends = values.min(), values.max()
    ax.plot(ends, ends, ":", color=style.BLACK, lw=0.8, label="equal", zorder=0)
    clear = case.clear_pairs
    ax.set_title(
        f"{case.span:g} m, class {case.road_class}: tau {case.tau.tau:.2f}\n"
        f"{clear.right} of {clear.number} clear pairs in order"
    )
    ax.locator_params(nbins=5)
