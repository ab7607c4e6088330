"""What a scoreboard says of itself."""

import dataclasses

import numpy as np
import pytest

import bridgectl as bc
from bridgectl.dampers import groundhook, passive, skyhook
from bridgectl.report_score import dae_sentences, dae_verdicts, score_text


@pytest.fixture(scope="module")
def board():
    roads = [bc.iso8608_profile("A", 11, seed=seed, start=-2) for seed in range(3)]
    return bc.score(
        [passive(7e3), skyhook(1e3, 30e3), groundhook(1e3, 30e3), passive(1e3)],
        bc.li2006.beam(9, n_modes=1), bc.li2006.car(), roads, np.array([80, 100]) / 3.6,
        approach=2, workers=1,
    )  # fmt: skip


def changed(board, daf, dae):
    """The board with each strategy's DAF and DAE moved from the first's by so much."""
    base, wobble = board.values["daf"][:1], 1e-4 * np.arange(3)[:, np.newaxis]
    values = dict(board.values)
    for name, moves in (("daf", daf), ("dae", dae)):
        values[name] = np.concatenate(
            [base, *(base + move + wobble * (move != 0) for move in moves)]
        )
    return dataclasses.replace(board, values=values)


def table(text, title):
    """Rows of one table by strategy, as lists of words."""
    lines = [line.rstrip() for line in text[text.index(title) :].splitlines()]
    first = next(i for i, line in enumerate(lines) if line.endswith("─")) + 1
    rows = [line.split() for line in lines[first : lines.index("", first)]]
    return {" ".join(row[: next(i for i, w in enumerate(row) if "." in w)]): row for row in rows}


def test_text_is_narrow_and_has_every_strategy_three_times(board):
    text = score_text(board)
    assert str(board) == text
    assert max(len(line.rstrip()) for line in text.splitlines()) <= 100
    for name in ("passive 7 kN s/m", "skyhook", "groundhook", "passive 1 kN s/m"):
        assert sum(line.startswith(f"  {name} ") for line in text.splitlines()) == 3


def test_the_heading_tells_what_was_simulated(board):
    text = score_text(board)
    assert text.startswith("4 strategies on 3 roads (ISO 8608 class A; ")
    assert "2 speeds from 80 to 100 km/h, 2 m of approach" in text
    assert "Bridge: Beam(length=9 m" in text


def test_the_numbers_are_those_of_the_board(board):
    text, rows = score_text(board), {row.strategy: row for row in board.rows()}
    bridge = table(text, "The bridge")
    assert list(bridge) == [row.strategy for row in board.rows()]
    row = rows["skyhook"]
    assert bridge["skyhook"][1] == f"{row.daf:.4f}"
    assert bridge["skyhook"][2:5] == [f"{value:+.4f}" for value in row.daf_difference]
    assert bridge["skyhook"][-2:] == [f"{row.worst_daf:.3f}", f"{row.worst_speed * 3.6:g}"]
    road = table(text, "Road, ride and suspension")["skyhook"]
    assert road[1] == f"{row.dynamic_load_coefficient:.4f}"
    assert road[6] == f"{row.suspension_travel * 1e3:.1f}"
    dae = table(text, "The dynamic amplification estimate")["skyhook"]
    assert dae[2:4] == [f"{row.dae:.4f}", f"{row.dae_error:.4f}"]


def test_clear_differences_are_marked(board):
    text = score_text(changed(board, [-0.05, 0.02, 0.0], [0.0, 0.0, 0.0]))
    bridge = table(text, "The bridge")
    assert "lower" in bridge["skyhook"]
    assert "higher" in bridge["groundhook"]
    assert not {"lower", "higher"} & set(bridge["passive 1 kN s/m"])
    assert "Lowest mean DAF: skyhook" in text
    assert "0.050 below passive 7 kN s/m (95 % confidence: 0.050 to 0.050)." in text


def test_the_sentences_tell_where_dae_ranks_right_and_where_not(board):
    made = changed(board, [-0.05, 0.02, 0.0], [-0.01, -0.03, 0.5])
    assert [(each.strategy, each.right) for each in dae_verdicts(made)] == [
        ("skyhook", True), ("groundhook", False),
    ]  # fmt: skip
    lines = dae_sentences(made)
    assert lines[0] == (
        "DAE puts 1 of the 2 strategies with a clear difference in DAF on the right side of "
        "passive 7 kN s/m: skyhook."
    )
    assert lines[1] == "It puts on the wrong side: groundhook (DAF +0.020, DAE -0.030)."
    assert "furthest from the DAF for passive 1 kN s/m: rms error 0.5" in lines[2]
    assert lines[3].startswith("Rank correlation of mean DAE and mean DAF over the 4 strategies: ")
    signs = table(score_text(made), "The dynamic amplification estimate")
    assert (signs["skyhook"][-1], signs["groundhook"][-1]) == ("right", "wrong")


def test_without_a_clear_difference_dae_has_nothing_to_rank(board):
    lines = dae_sentences(changed(board, [0.0, 0.0, 0.0], [0.1, 0.2, 0.3]))
    assert lines == [
        "DAE has nothing to rank: no strategy's mean DAF differs clearly from passive 7 kN s/m's."
    ]


def test_the_first_strategy_may_be_the_best(board):
    text = score_text(changed(board, [0.1, 0.1, 0.1], [0.1, 0.1, 0.1]))
    assert "No strategy has a lower mean DAF than passive 7 kN s/m." in text
    assert "DAE puts 3 of the 3" in text


def test_a_difference_that_is_not_clear_is_told_as_such(board):
    values = dict(board.values)
    values["daf"] = values["daf"].copy()
    values["daf"][1] = values["daf"][0] - np.array([0.3, -0.1, -0.1])[:, np.newaxis]
    text = score_text(dataclasses.replace(board, values=values))
    assert "(not clearly: other roads may turn it round)" in " ".join(text.split())


def test_a_tire_that_leaves_the_road_is_told(board):
    values = changed(board, [-0.1, 0.1, 0.1], [0.1, 0.1, 0.1]).values
    least = values["least_force"].copy()
    least[2] = 0.0
    text = score_text(dataclasses.replace(board, values={**values, "least_force": least}))
    assert "A tire leaves the road with groundhook." in text


def test_one_road_one_speed_one_strategy():
    road = bc.iso8608_profile("A", 11, seed=0, start=-2)
    beam, car = bc.li2006.beam(9, n_modes=1), bc.li2006.car()
    two = bc.score([passive(7e3), passive(1e3)], beam, car, [road], 25.0, approach=2, workers=1)
    text = score_text(two)
    assert "2 strategies on 1 road (ISO 8608 class A),\n90 km/h, 2 m of approach" in text
    assert "A single road gives no confidence intervals" in text
    assert "nan" not in text
    one = bc.score([passive(7e3)], beam, car, [road], 25.0, approach=2, workers=1)
    assert score_text(one).startswith("1 strategy on 1 road")
