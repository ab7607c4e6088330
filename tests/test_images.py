"""The figures look as they did: reduced to small grey images, and compared with stored ones.

``python tests/test_images.py`` draws the stored images anew, after a change that is meant: look at
what ``git diff`` says of ``tests/data/images`` before it is kept. What is drawn is made by hand or
simulated in short, so that the images change with the drawing alone.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib import style
from matplotlib.animation import AbstractMovieWriter
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import Collection
from matplotlib.figure import Figure
from matplotlib.legend import Legend
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, FancyBboxPatch, StepPatch
from matplotlib.text import Text
from PIL import Image

import bridgectl as bc
from bridgectl import crossing_animation
from bridgectl.dampers import passive, skyhook
from bridgectl.extremes.pairs import EqualRoughnessPair
from bridgectl.paper.damper_validation import DamperCase
from bridgectl.paper.printed import PaperResults
from bridgectl.paper.validation import Case, ValidationResults, WarningLight
from bridgectl.plots import dae_figure, response_figure, vehicle_plot
from bridgectl.plots.ramp_heights import ramp_height_figure
from bridgectl.plots.roads import pair_figure, profile_figure, psd_plot
from bridgectl.plots.scores import score_figure
from bridgectl.plots.surface import paper_figure
from bridgectl.plots.validation import damper_validation_figure, validation_figure
from bridgectl.scoring.board import Scoreboard
from bridgectl.scoring.rows import MEASURES
from bridgectl.surface.histories import FeedbackHistories
from bridgectl.surface.surface import RampSurface

IMAGES = Path(__file__).with_name("data") / "images"

WIDTH, REDUCED, TILE = 96, 8, 12
"""Width of an image [px], what it is drawn larger by, and side of the tiles that are compared."""

PALE = "0.92"
"""Colour of text."""

LOOK = {"xtick.labelcolor": PALE, "ytick.labelcolor": PALE, "text.hinting": "no_hinting"}

TOLERANCE = 4.5
"""Largest RMS difference of a tile, of 255 grey levels.

Between matplotlib 3.8.4 and 3.11.2, with the FreeType of each, it is 3.9 at most.
"""


def beam_and_truck() -> tuple[bc.Beam, bc.QuarterCar]:
    return bc.li2006.beam(), bc.li2006.car()


def wavy_road(start: float, phase: float = 0.0) -> bc.RoadProfile:
    """A road of three waves, up to 9 mm high."""
    x = np.linspace(start, 25, round((25 - start) / 0.1) + 1)
    waves = [(4e-3, 17.0, 0.0), (3e-3, 6.3, phase), (2e-3, 2.9, 2 * phase)]
    z = sum(height * np.sin(2 * np.pi * x / length + turn) for height, length, turn in waves)
    return bc.RoadProfile(x, z, name="three waves")


def surface(speeds: np.ndarray, approach: float = 0.0, height: float = 1e-3) -> bc.RampSurface:
    return bc.ramp_surface(
        *beam_and_truck(), speeds / 3.6, approach=approach, ramp_length=1.0, ramp_height=height
    )


def dae() -> Figure:
    made, road = surface(np.arange(50, 151, 5.0), 25.0), wavy_road(-25.0)
    return dae_figure(made, road, simulated=made.superposed_daf(road) + 0.03)


def paper() -> Figure:
    speeds = np.arange(50, 151, 5.0)
    return paper_figure(PaperResults((), surface(speeds), surface(speeds, height=1e-2)))


def pair() -> Figure:
    roads = wavy_road(0.0), wavy_road(0.0, 2.0)
    speeds = np.arange(50, 151, 5.0) / 3.6
    smooth = 1.05 + 0.05 * np.sin(speeds / 4)
    made = EqualRoughnessPair(*roads, 25.0, np.array([1.0, 1.2]), np.array([2.78, 2.78]), 0.0)
    return pair_figure(made, speeds, [smooth - 0.06, smooth + 0.08], smooth=smooth)


def psd() -> Figure:
    return psd_plot(bc.utia_road().psd()).figure


def profile() -> Figure:
    return profile_figure([bc.utia_road()])


def scores() -> Figure:
    names = ("passive 7 kN s/m", "passive 1 kN s/m", "passive 30 kN s/m", "skyhook", "bridgehook")
    speeds = np.arange(60, 121, 5.0) / 3.6
    levels = np.array([1.06, 1.12, 1.03, 1.09, 0.97])
    daf = levels[:, np.newaxis, np.newaxis] + 0.01 * np.sin(
        speeds + levels[:, np.newaxis, np.newaxis]
    )
    ride = np.array([0.1, 0.15, 0.2, 0.06, 0.25])[:, np.newaxis, np.newaxis] + 0 * daf
    values = dict.fromkeys(MEASURES, daf) | {
        "body_acceleration": ride, "dynamic_load_coefficient": 0.3 * ride, "dae": 2.1 - daf,
    }  # fmt: skip
    surfaces = {name: tuple(hand_made(each, speeds, level) for each in daf[:, 0])
                for name, level in (("A", 0.03), ("B", 0.06))}  # fmt: skip
    two = {name: np.concatenate([each, 1.02 * each], axis=1) for name, each in values.items()}
    return score_figure(
        Scoreboard(
            names, (7e3, 1e3, 30e3, np.nan, np.nan), ("one", "two"), speeds, two, daf[:, 0],
            two["daf"][:, :, 0], *beam_and_truck(), 0.0, ("A", "B"), surfaces,
        )
    )  # fmt: skip


def hand_made(smooth: np.ndarray, speeds: np.ndarray, level: float) -> RampSurface:
    """A surface both ways whose even effects go with the smooth DAF beyond 1.05."""
    x = 0.1 * np.arange(250)
    even = 100 * level * (smooth[:, np.newaxis] - 1.05) * np.sin(np.pi * x / 25) ** 2
    odd = 0.01 * np.sin(x)
    daf_smooth = np.full(len(speeds), 1.05)
    drop, rise = (daf_smooth[:, np.newaxis] + even + sign * odd for sign in (1, -1))
    return RampSurface(
        *beam_and_truck(), bc.Moment(12.5), 0.0, 0.1, level / 4, speeds, x, daf_smooth,
        drop, FeedbackHistories("by hand"), rise, 10,
    )  # fmt: skip


def dampers() -> Figure:
    level = np.linspace(0.97, 1.1, 9)[:, np.newaxis, np.newaxis, np.newaxis]
    daf = level + np.zeros((9, 2, 3, 1))
    cases = [
        DamperCase(span, "A", tuple("abcdefghi"), 6, daf, 0 * daf + 1.03, daf, mean)
        for span, mean in ((15, 1 + 0.5 * (level.ravel() - 1)), (25, level.ravel() ** 3))
    ]
    return damper_validation_figure(cases)


def heights() -> Figure:
    beam, truck = beam_and_truck()
    laws = [passive(7e3), skyhook(1e3, 30e3)]
    found = [bc.ramp_heights(beam, truck, law, 25.0, 5.0, approach=2) for law in laws]
    return ramp_height_figure(found)


def validation() -> Figure:
    speeds = np.arange(50, 151, 5.0) / 3.6
    smooth = 1.05 + 0.05 * np.sin(speeds / 4)
    flying = np.arange(len(speeds)) == 6
    cases = tuple(
        Case(
            span,
            0.0,
            road,
            speeds,
            smooth,
            smooth + 0.03 * road,
            smooth - 0.04,
            smooth,
            flying,
            3.0,
        )
        for span in (15.0, 25.0)
        for road in (1, 2)
    )
    light = WarningLight(0.02, 100, 10, 8, 7)
    roads = wavy_road(0.0), wavy_road(0.0, 2.0)
    return validation_figure(ValidationResults(roads, speeds, cases, light))


class Frame(AbstractMovieWriter):
    """Stops an animation at one frame."""

    def __init__(self, number: int) -> None:
        super().__init__(fps=10)
        self.left = number

    def setup(self, fig: Figure, outfile: str, dpi: float | None = None) -> None:
        super().setup(fig, outfile, dpi=dpi)

    def grab_frame(self, **_: Any) -> None:
        self.left -= 1
        if self.left < 0:
            raise StopAsyncIteration

    def finish(self) -> None:
        pass


def crossing() -> Figure:
    road = wavy_road(0.0)
    frame = Frame(2)
    with suppress(StopAsyncIteration):
        crossing_animation(*beam_and_truck(), 25.0, road, frames=4).save("nothing", writer=frame)
    return frame.fig


def vehicle() -> Figure:
    return vehicle_plot(bc.trucks.load("T5tridem")).figure


def response() -> Figure:
    beam, truck = bc.li2006.beam(), bc.trucks.load("T5air")
    return response_figure(bc.crossing_response(beam, truck, 25.0, static=True)).figure


def bode() -> Figure:
    crossing = bc.Crossing(*beam_and_truck())
    names = ["tire_force", "moment"]
    return crossing.plot_bode([3.0, 8.0, 12.5], outputs=names, limits=(0.2, 40)).figure


def semitrailer() -> Figure:
    beam, truck, frame = bc.li2006.beam(), bc.trucks.load("T5air"), Frame(2)
    with suppress(StopAsyncIteration):
        crossing_animation(beam, truck, 25.0, wavy_road(0.0), frames=5).save("n", writer=frame)
    return frame.fig


FIGURES: dict[str, Callable[[], Figure]] = {
    make.__name__: make
    for make in (
        dae,
        paper,
        pair,
        psd,
        profile,
        scores,
        dampers,
        heights,
        validation,
        crossing,
        vehicle,
        response,
        bode,
        semitrailer,
    )
}


def drawn(name: str) -> Figure:
    """The figure in matplotlib's own style, with axes wherever their grid puts them and pale text.

    Letters differ between versions of matplotlib and FreeType, and a layout made for them too.
    """
    with style.context(["default", LOOK]):
        figure = FIGURES[name]()
        figure.set_layout_engine("none")
        figure.set_dpi(WIDTH * REDUCED / figure.get_figwidth())
        for text in figure.findobj(Text):
            text.set_color(PALE)
        for legend in figure.findobj(Legend):
            legend.set_loc((0.02, 0.75))  # "best" is not the same place everywhere
            for text in legend.get_texts():
                text.set_text("entry")
    return figure


def small(figure: Figure) -> np.ndarray:
    """A figure in 256 levels of grey, by the mean of each little square."""
    canvas = FigureCanvasAgg(figure)
    with style.context(["default", LOOK]):
        canvas.draw()
    grey = np.asarray(canvas.buffer_rgba(), dtype=float)[..., :3].mean(axis=-1)
    rows, columns = grey.shape[0] // REDUCED, WIDTH
    squares = grey[: rows * REDUCED, : columns * REDUCED].reshape(rows, REDUCED, columns, REDUCED)
    return squares.mean(axis=(1, 3))


def difference(first: np.ndarray, second: np.ndarray) -> float:
    """Largest RMS difference of any tile."""
    assert first.shape == second.shape
    squares = (first - second) ** 2
    rows, columns = (-(-size // TILE) * TILE for size in squares.shape)
    padded = np.zeros((rows, columns))
    padded[: squares.shape[0], : squares.shape[1]] = squares
    tiles = padded.reshape(rows // TILE, TILE, columns // TILE, TILE).mean(axis=(1, 3))
    return float(np.sqrt(tiles.max()))


def parts(figure: Figure) -> list[Artist]:
    """Panels, curves, bars and legends."""
    found: list[Artist] = [*figure.axes]
    for axes in figure.axes:
        found += [*axes.lines, *axes.patches, *axes.collections]
    return found + figure.findobj(Legend)


REMOVED: dict[str, list[tuple[type[Artist], str, int]]] = {
    "dae": [(Line2D, "DAE", -1), (Collection, "raises it", -1), (Legend, "", -1), (Axes, "", -1)],
    "paper": [
        (Line2D, "_child0", 0),
        (Axes, "5(b)", -1),
        (Legend, "", -1),
        (Axes, "<colorbar>", -1),
    ],
    "pair": [(Line2D, "case 2: ", -1), (Legend, "", -1)],
    "psd": [(Line2D, "UTIA road", -1), (Legend, "", -1)],
    "profile": [(StepPatch, "UTIA road", -1), (Line2D, "UTIA road", 0), (Legend, "", 0)],
    "scores": [(Line2D, "constant dampers", -1), (Line2D, "skyhook", -1), (Legend, "", -1)],
    "dampers": [
        (Line2D, "class DAE, unseen", -1),
        (Line2D, "class DAE, dampers", -1),
        (Legend, "", -1),
    ],
    "heights": [(Line2D, "simulated DAF", -1), (Line2D, "DAE of order 2", -1), (Legend, "", -1)],
    "validation": [(Line2D, "DAE", -1), (Legend, "", -1)],
    "crossing": [(Line2D, "moment", -1), (Line2D, "road", -1), (Legend, "", -1)],
    "vehicle": [(FancyBboxPatch, "", 0), (FancyBboxPatch, "", 1), (Circle, "", -1)],
    "response": [(Line2D, "moment", 0), (Line2D, "tire_force_2", 0), (Line2D, "thB2", 0)],
    "bode": [(Line2D, "0.12 l", 0), (Line2D, "0.32 l", 1), (Line2D, "0.5 l", 1), (Legend, "", -1)],
    "semitrailer": [(FancyBboxPatch, "body", 0), (FancyBboxPatch, "body 2", 0), (Circle, "", 0)],
}
"""Kind and label of what must not be missing: of those that fit, the one at the index goes.

What is below the tolerance: a legend of two thin lines, the dotted line of a smooth road.
"""


@pytest.mark.quick_cases(4)
@pytest.mark.parametrize("name", FIGURES)
def test_a_figure_looks_as_it_did_and_would_not_with_a_part_less(name):
    figure = drawn(name)
    whole = small(figure)
    stored = np.asarray(Image.open(IMAGES / f"{name}.png"), dtype=float)
    assert difference(whole, stored) < TOLERANCE
    for kind, label, index in REMOVED[name]:
        fitting = [part for part in parts(figure) if isinstance(part, kind)]
        part = [part for part in fitting if str(part.get_label()).startswith(label)][index]
        part.set_visible(False)
        assert difference(small(figure), stored) > TOLERANCE, f"{kind.__name__} {label}"
        part.set_visible(True)


def test_the_stored_images_are_those_of_the_figures_and_small():
    files = {path.stem: path.stat().st_size for path in IMAGES.iterdir()}
    assert set(files) == set(FIGURES) == set(REMOVED)
    assert max(files.values()) < 10_000


if __name__ == "__main__":
    mpl.use("Agg")
    IMAGES.mkdir(exist_ok=True)
    for name in FIGURES:
        Image.fromarray(small(drawn(name)).round().astype(np.uint8)).save(IMAGES / f"{name}.png")
