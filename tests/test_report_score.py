"""What a scoreboard says of itself."""

import dataclasses

import numpy as np
import pytest

import bridgectl as bc
from bridgectl.dampers import groundhook, passive, skyhook
from bridgectl.scoring.text import dae_sentences, score_text


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


def test_text_is_narrow_and_has_every_strategy_in_each_table(board):
    text = score_text(board)
    assert str(board) == text
    assert max(len(line.rstrip()) for line in text.splitlines()) <= 100
    for name in ("passive 7 kN s/m", "skyhook", "groundhook", "passive 1 kN s/m"):
        assert sum(line.startswith(f"  {name} ") for line in text.splitlines()) == 4


def test_the_heading_tells_what_was_simulated(board):
    text = score_text(board)
    assert "\n\n4 strategies on 3 roads (ISO 8608 class A; " in text
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
    assert dae[5:] == [f"{row.dae_2:.4f}", f"{row.dae_2_error:.4f}"]


def test_clear_differences_are_marked(board):
    text = score_text(changed(board, [-0.05, 0.02, 0.0], [0.0, 0.0, 0.0]))
    bridge = table(text, "The bridge")
    assert "lower" in bridge["skyhook"]
    assert "higher" in bridge["groundhook"]
    assert not {"lower", "higher"} & set(bridge["passive 1 kN s/m"])
    assert "Lowest mean DAF: skyhook" in text
    assert "0.050 below passive 7 kN s/m (95 % confidence: 0.050 to 0.050); the" in text


def test_five_sentences_tell_what_dae_ranks_and_what_not(board):
    rows = board.rows()
    lines = dae_sentences(board, board.rankings())
    assert len(lines) == 5
    assert lines[0].startswith("The mean of Eq. (15) tells roads apart, not dampers")
    ranking = next(each for each in board.rankings() if each.estimate == "class DAE")
    tau, low, high = ranking.agreement
    assert lines[1] == (
        "The class DAE, of ramps down and up, orders the strategies on class A with tau "
        f"{tau:.2f} [{low:.2f}, {high:.2f}], {ranking.pairs.right} of {ranking.pairs.number} clear "
        "pairs."
    )
    first = min(board.class_rows("A"), key=lambda row: row.dae).strategy
    assert rows[0].strategy in lines[2]
    assert first in lines[2]
    error = np.sqrt(np.mean((board.values["dae_2"] - board.values["daf"]) ** 2))
    assert f"On single roads its rms error is {error:.3f} " in lines[3]
    assert lines[4].endswith("the judge is the simulated DAF.")
    assert " ".join(lines) in " ".join(score_text(board).split())


@pytest.mark.slow
def test_whether_both_have_the_same_best_is_told(board):
    best = min(board.class_rows("A"), key=lambda row: row.dae).strategy
    moves = [-0.3 if name == best else 0.0 for name in board.strategies]
    same = dict(board.values)
    same["daf"] = board.values["daf"] + np.array(moves)[:, np.newaxis, np.newaxis]
    lines = dae_sentences(*(lambda b: (b, b.rankings()))(dataclasses.replace(board, values=same)))
    assert lines[2] == f"Both the class DAE and the simulated DAF put {best} first."
    same["daf"] = board.values["daf"] - np.array(moves)[:, np.newaxis, np.newaxis]
    other = dataclasses.replace(board, values=same)
    lines = dae_sentences(other, other.rankings())
    assert lines[2] == (
        f"Simulation puts {other.rows()[0].strategy} first, the class DAE {best} on class A."
    )


def test_the_class_table_has_the_closed_form_beside_the_simulation(board):
    rows = {row.strategy: row for row in board.class_rows("A")}
    found = table(score_text(board), "The DAE over the road class")
    assert found["skyhook"][1:] == [f"{value:.4f}" for value in rows["skyhook"][1:]]


def test_the_order_table_has_tau_and_clear_pairs(board):
    text = score_text(board)
    first, *_ = board.rankings()
    line = next(each for each in text.splitlines() if each.startswith("  all "))
    tau, low, high = first.agreement
    assert line.split()[5:] == [
        f"{tau:.2f}", f"{low:.2f}", f"{high:.2f}", str(first.pairs.right), "of",
        str(first.pairs.number),
    ]  # fmt: skip


def test_three_classes_make_two_tables(board):
    three = dataclasses.replace(board, surfaces=dict.fromkeys("ABC", board.surfaces["A"]),
                                road_classes=("A", "B", "C"))  # fmt: skip
    assert score_text(three).count("The DAE over the road class") == 2


def test_roads_too_rough_for_a_surface_are_told():
    """The unit ramp of class F is 240 mm here, of 100 mm length."""
    roads = [bc.iso8608_profile("F", 11, seed=seed, start=-2) for seed in range(2)]
    board = bc.score(
        [passive(7e3), passive(1e3)], bc.li2006.beam(9, n_modes=1), bc.li2006.car(), roads, 25.0,
        approach=2, workers=1,
    )  # fmt: skip
    assert not board.surfaces
    assert np.isnan(board.values["dae_2"]).all()
    text = " ".join(score_text(board).split())
    assert "no DAE of second order: the roads are of class F, whose unit ramp" in text
    assert "nan" not in text
    assert board.to_json()


def test_a_road_of_a_class_without_a_surface_has_no_second_order(board):
    values = dict(board.values)
    values["dae_2"] = values["dae_2"].copy()
    values["dae_2"][:, 0] = np.nan
    text = score_text(dataclasses.replace(board, values=values))
    assert "Some roads are of a class without a surface" in " ".join(text.split())


def test_the_first_strategy_may_be_the_best(board):
    text = score_text(changed(board, [0.1, 0.1, 0.1], [0.1, 0.1, 0.1]))
    assert "No strategy has a lower mean DAF than passive 7 kN s/m, " in text


def test_a_difference_that_is_not_clear_is_told_as_such(board):
    values = dict(board.values)
    values["daf"] = values["daf"].copy()
    values["daf"][1] = values["daf"][0] - np.array([0.3, -0.1, -0.1])[:, np.newaxis]
    text = score_text(dataclasses.replace(board, values=values))
    text = " ".join(text.split())
    assert text.startswith("No strategy is clearly better than passive 7 kN s/m: skyhook has the ")
    assert "but other roads may turn it round" in text


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
    assert score_text(one).startswith("passive 7 kN s/m has a mean DAF of ")
    assert "\n1 strategy on 1 road" in score_text(one)
