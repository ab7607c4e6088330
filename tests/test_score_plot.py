"""The figure of a scoreboard."""

import dataclasses
import itertools

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.text import Text

import bridgectl as bc
from bridgectl.dampers import groundhook, passive, pdd, skyhook
from bridgectl.plots.scores import score_figure

STRATEGIES = [
    passive(7e3), passive(30e3), skyhook(1e3, 30e3), passive(1e3), groundhook(1e3, 30e3),
    pdd(1e3, 30e3, stiffness=80e3), skyhook(2e3, 9e3).renamed("cost $x$"),
]  # fmt: skip


def make_board(strategies, speeds):
    roads = [bc.iso8608_profile("A", 11, seed=seed, start=-2) for seed in range(2)]
    return bc.score(
        strategies, bc.li2006.beam(9, n_modes=1), bc.li2006.car(), roads, np.array(speeds) / 3.6,
        approach=2, workers=1,
    )  # fmt: skip


@pytest.fixture(scope="module")
def board():
    return make_board(STRATEGIES, [100, 80])


@pytest.fixture(scope="module")
def figure(board):
    return score_figure(board)


def test_every_axis_has_its_unit(figure):
    assert [axes.get_xlabel() for axes in figure.axes] == [
        "mean DAF [-]", "mean DAF [-]", "speed [km/h]", "mean DAF [-]",
        "x from the start of the bridge [m]",
    ]  # fmt: skip
    assert [axes.get_ylabel() for axes in figure.axes] == [
        "body acceleration, rms [m/s²]", "dynamic load coefficient [-]", "mean DAF [-]",
        "mean DAE [-]", "added to the DAF by a metre of road [0.001/m]",
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("panel", "measure"), [(0, "body_acceleration"), (1, "dynamic_load_coefficient")]
)
def test_every_strategy_is_a_point_and_the_constant_dampers_a_line(figure, board, panel, measure):
    lines = figure.axes[panel].lines
    drawn = {tuple(point) for line in lines for point in line.get_xydata()}
    means = [board.values[name].mean(axis=(1, 2)) for name in ("daf", measure)]
    points = np.column_stack(means)
    assert drawn == {tuple(point) for point in points}
    locus = next(line for line in lines if line.get_label() == "constant dampers")
    assert locus.get_xydata() == pytest.approx(points[[3, 0, 1]])  # 1, 7, 30 kN s/m


def test_labels_are_the_names_and_the_ends_of_the_constant_dampers(figure):
    for axes in figure.axes[:2]:
        assert sorted(text.get_text() for text in axes.texts) == [
            "1 kN s/m", "30 kN s/m", "PDD", "cost $x$", "groundhook", "passive 7 kN s/m", "skyhook",
        ]  # fmt: skip


def test_labels_cover_neither_each_other_nor_leave_the_axes(figure):
    renderer = FigureCanvasAgg(figure).get_renderer()
    figure.draw(renderer)
    for axes in figure.axes[:2]:
        # Of the words alone: an annotation extends to its point.
        boxes = [Text.get_window_extent(text, renderer) for text in axes.texts]
        for text, box in zip(axes.texts, boxes, strict=True):
            assert axes.bbox.padded(2).contains(*box.min), text.get_text()
            assert axes.bbox.padded(2).contains(*box.max), text.get_text()
        for first, second in itertools.combinations(boxes, 2):
            assert not first.overlaps(second)


@pytest.mark.parametrize(
    ("surfaces", "panel", "measure"), [(1, 2, "daf"), (0, 2, "daf"), (0, 3, "dae")]
)
def test_speeds_are_in_order_and_values_are_means_over_roads(board, surfaces, panel, measure):
    """Without surfaces Eq. (15) is drawn over the speeds, too."""
    figure = score_figure(board if surfaces else dataclasses.replace(board, surfaces={}))
    lines = {line.get_label(): line for line in figure.axes[panel].lines}
    assert list(lines) == list(board.strategies)
    for i, line in enumerate(lines.values()):
        assert line.get_xdata() == pytest.approx([80, 100])
        assert line.get_ydata() == pytest.approx(board.values[measure][i].mean(axis=0)[::-1])


def test_the_legend_tells_the_first_strategy_and_the_best(figure, board):
    entries = [text.get_text() for text in figure.legends[0].get_texts()]
    assert entries[0].startswith("passive 7 kN s/m: the baseline")
    best = board.rows()[0].strategy
    assert any(entry.startswith(f"{best}: ") and "least DAF" in entry for entry in entries)
    assert "constant dampers" in entries


@pytest.mark.slow
@pytest.mark.parametrize("strategies", [STRATEGIES[:1], STRATEGIES[2:3], STRATEGIES[:2]])
def test_few_strategies_at_one_speed_can_be_drawn(strategies, tmp_path):
    figure = make_board(strategies, [80]).plot()
    figure.savefig(tmp_path / "score.png")
    assert len(figure.axes) == 5


def test_every_strategy_has_its_class_dae_and_its_mean_of_eq_15(figure, board):
    """Full and hollow, over the simulated mean DAF."""
    drawn = [
        line for line in figure.axes[3].lines if line.get_marker() == "o" and len(line.get_xdata())
    ]
    points = {(line.get_mfc() != "white", *line.get_xydata()[0]) for line in drawn}
    rows = board.class_rows("A")
    first = {row.strategy: row.dae for row in board.rows()}
    expected = {(True, row.daf, row.dae) for row in rows}
    expected |= {(False, row.daf, first[row.strategy]) for row in rows}
    assert np.array(sorted(points)) == pytest.approx(np.array(sorted(expected)), abs=1e-12)


def test_the_area_of_a_strategy_is_what_the_class_adds_to_its_smooth_daf(figure, board):
    """The sum over the drawn places, a metre apart, is near that over all."""
    best = board.rows()[0].strategy
    line = next(line for line in figure.axes[4].lines if line.get_label() == best)
    i = board.strategies.index(best)
    added = board.class_rows("A")[0].dae - board.daf_smooth[i].mean()
    assert np.trapezoid(1e-3 * line.get_ydata(), line.get_xdata()) == pytest.approx(added, abs=2e-4)
    assert {line.get_label() for line in figure.axes[4].lines[:-1]} == {
        best, board.strategies[0], board.rows()[-1].strategy,
    }  # fmt: skip
