"""Figs. 2, 5 and 6 of Li, OBrien and Gonzalez (2006) as computed."""

from __future__ import annotations

from matplotlib.figure import Figure

from bridgectl.plots.shown import PaperShown
from bridgectl.plots.style import VERMILLION, styled
from bridgectl.plots.surface import smooth_daf_plot, surface_plot


@styled
def paper_figure(results: PaperShown) -> Figure:
    """Draw Figs. 2, 5(a), 5(b), 6(a) and 6(b) of the paper as computed."""
    figure = Figure(figsize=(10.0, 10.5), layout="constrained")
    panels = figure.subplot_mosaic([["2", "2"], ["5(a)", "5(b)"], ["6(a)", "6(b)"]])
    top = smooth_daf_plot(results.unit, panels["2"])
    top.set_title("DAF of a smooth road")
    kmh, printed = results.printed_smooth
    top.plot(kmh, printed, "o", color=VERMILLION, label=f"printed: {printed:g}")
    top.margins(x=0)
    top.legend()
    for name, surface in (("5", results.unit), ("6", results.tall)):
        surface_plot(surface, ax=panels[f"{name}(a)"])
        surface_plot(surface, difference=True, ax=panels[f"{name}(b)"])
    for name, panel in panels.items():
        panel.set_title(f"Fig. {name}: {panel.get_title(loc='left')}")
    return figure
