"""The DAE of second order in a score: which class a road is of, and surfaces by class."""

import json

import numpy as np
import pytest

import bridgectl as bc
from bridgectl import dampers
from bridgectl.road import iso8608_elevations
from bridgectl.scoring.classes import EVERY, classes_of, with_surface

SPEEDS = np.array([30.0, 20.0])
LAWS = [dampers.passive(7e3), dampers.skyhook(1e3, 30e3), dampers.preset(1e3, 30e3)]


def made_roads():
    classes = {
        "A": iso8608_elevations(2, "A", 30, seed=1),
        "B": iso8608_elevations(2, "B", 30, seed=2),
    }
    x = -5 + 0.1 * np.arange(301)
    return [
        bc.RoadProfile(x, z, name=f"{c} {i}")
        for c, each in classes.items()
        for i, z in enumerate(each)
    ]


@pytest.fixture(scope="module")
def board():
    return bc.score(
        LAWS, bc.li2006.beam(), bc.li2006.car(), made_roads(), SPEEDS, approach=5, workers=1
    )


def test_random_roads_are_of_the_class_that_they_are_made_of():
    for name in "ABCDEFGH":
        assert set(classes_of(iso8608_elevations(20, name, 60, seed=3))) == {name}


def test_smooth_and_graded_roads_are_of_the_first_class_and_the_roughest_of_the_last():
    x = np.arange(100.0)
    roads = np.array([0 * x, 0.005 * x, (-1.0) ** x * 10])
    assert classes_of(roads) == ("A", "A", "H")


def test_a_class_has_a_surface_if_its_ramp_is_no_higher_than_long():
    """Class A: 13.45 mm for 850 ramps of 100 mm, and twice as high from class to class."""
    assert with_surface("CABBDE", 850) == ("A", "B", "C")
    assert with_surface("D", 700) == ("D",)


@pytest.mark.slow
def test_surfaces_are_those_of_the_strategies_alone(board):
    beam, car = bc.li2006.beam(), bc.li2006.car()
    assert board.road_classes == ("A", "A", "B", "B")
    for name in "AB":
        for law, found in zip(LAWS, board.surfaces[name], strict=True):
            alone = bc.ramp_surface(
                beam, car, SPEEDS, approach=5, ramp_height=name, both_ways=True, every=EVERY,
                damper=law,
            )  # fmt: skip
            assert found.ramp_height == alone.ramp_height
            assert np.array_equal(found.daf_unit, alone.daf_unit)
            assert np.array_equal(found.daf_rise, alone.daf_rise)
            assert found.histories.damper == law.name


def test_a_road_has_the_second_order_of_its_own_class(board):
    elevations = np.array([road.elevation for road in made_roads()])
    for i in range(len(LAWS)):
        for name, roads in (("A", slice(0, 2)), ("B", slice(2, 4))):
            expected = board.surfaces[name][i].dae(elevations[roads], order=2)
            assert board.values["dae_2"][i, roads] == pytest.approx(expected, abs=1e-12)


def test_class_rows_are_the_closed_form_beside_the_simulated_roads(board):
    rows = board.class_rows("B")
    assert [row.strategy for row in rows] == [row.strategy for row in board.rows()]
    for row in rows:
        i = board.strategies.index(row.strategy)
        found = board.surfaces["B"][i].class_dae("B")
        daf = board.values["daf"][i, 2:]
        assert row[1:] == pytest.approx(
            (found.mean.mean(), found.sd.mean(), daf.mean(), daf.std(axis=0, ddof=1).mean())
        )
    with pytest.raises(ValueError, match="road_class must be one of 'A', 'B', got 'C'"):
        board.class_rows("C")


def test_rankings_are_of_all_roads_and_of_each_class(board):
    found = board.rankings()
    assert [(each.roads, each.estimate) for each in found] == [
        ("all", "mean of Eq. (15)"),
        *((f"class {name}", estimate) for name in "AB" for estimate in (
            "mean of Eq. (15)", "class DAE", "its spread, with that of the DAF")),
    ]  # fmt: skip
    assert [i for i, each in enumerate(found) if each.pairs is None] == [3, 6]
    content = json.loads(board.to_json())
    assert content["rankings"][2]["tau"] == pytest.approx(found[2].agreement.tau)
    assert content["class_dae"]["A"]["mean"][1] == pytest.approx(
        board.surfaces["A"][1].class_dae("A").mean
    )
    assert content["road_classes"] == ["A", "A", "B", "B"]


@pytest.mark.slow
def test_more_roads_leave_the_classes_that_a_file_keeps(tmp_path, monkeypatch):
    """A class does not depend on the roads; the roads' own parts are done again."""
    from bridgectl.scoring import run as scoring

    file, whole, done = tmp_path / "score.jsonl", scoring._part, []

    def noted(study, damper, piece):
        done.append(piece)
        return whole(study, damper, piece)

    monkeypatch.setattr(scoring, "_part", noted)
    options = {"approach": 5, "workers": 1, "resume": file}
    for roads in (made_roads()[:1], made_roads()[:2]):
        bc.score(LAWS[:2], bc.li2006.beam(), bc.li2006.car(), roads, SPEEDS, **options)
    of_two = [0, 0, "unit ramps", "A", "unit ramps", "A"]
    assert done == [*of_two, 0, 0, "unit ramps", "unit ramps"]
