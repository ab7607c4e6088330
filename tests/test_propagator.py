import dataclasses

import numpy as np
import pytest
from helpers import random_case, rough_road

import bridgectl as bc
from bridgectl._places import merge_places
from bridgectl.linear.cells import SAMPLES, sample_positions
from bridgectl.linear.nodes import MAX_WIDTH, cell_nodes, kink_positions
from bridgectl.linear.runs import effect_samples, prepare, propagate


def moments(case, refine):
    crossing = bc.Crossing(case["beam"], case["vehicle"])
    run = prepare(crossing, case["profile"], case["start"])
    nodes = run.nodes(case["speed"], refine)
    bridge = propagate(run, np.array([case["speed"]]), nodes)[-1]
    return effect_samples(crossing, bridge)[0, :: len(SAMPLES) * refine]


@pytest.mark.quick_cases(6)
@pytest.mark.parametrize("seed", range(30, 50))
def test_moments_are_converged_to_1e_7_at_the_cells_that_are_used(seed):
    case = random_case(seed)
    assert moments(case, 1) == pytest.approx(moments(case, 4), abs=1e-7)


def test_the_cells_are_of_fourth_order_or_better(bridge, truck):
    """Halving the cells of a rough crossing divides the error by at least 2^4."""
    case = {
        "beam": bridge,
        "vehicle": truck,
        "speed": 12.0,
        "profile": rough_road(0, 0, 25),
        "start": 0.0,
    }
    exact = moments(case, 8)
    errors = [np.abs(moments(case, refine) - exact).max() for refine in (1, 2)]
    assert errors[1] < errors[0] / 16


def test_nodes_stand_at_every_kink(bridge, truck):
    convoy = bc.convoy([truck, truck], [0, 3.3])
    crossing = bc.Crossing(bridge, convoy, bc.Moment(10.0))
    places = kink_positions(crossing, -20.0, 28.3, np.array([-7.77, 4.21]))
    nodes = cell_nodes(crossing, 30.0, places)
    kinks = [-20, -7.77, -4.47, 0, 3.3, 4.21, 7.51, 10, 13.3, 25, 28.3]
    assert np.abs(np.subtract.outer(kinks, nodes)).min(axis=1) == pytest.approx(0, abs=1e-12)
    assert np.all(np.diff(nodes) > 0)
    assert np.diff(nodes).max() <= MAX_WIDTH + 1e-12


def test_slow_or_stiff_crossings_get_short_cells(bridge, truck):
    kinks = np.array([0.0, 25.0])
    usual = len(cell_nodes(bc.Crossing(bridge, truck), 30.0, kinks))
    slow = len(cell_nodes(bc.Crossing(bridge, truck), 3.0, kinks))
    many = bc.li2006.beam(n_modes=12)
    fine = len(cell_nodes(bc.Crossing(many, truck), 30.0, kinks))
    assert usual < slow
    assert usual < fine


def test_samples_include_the_nodes(bridge, truck):
    nodes = cell_nodes(bc.Crossing(bridge, truck), 30.0, np.array([0.0, 25.0]))
    positions = sample_positions(nodes)
    assert positions[:: len(SAMPLES)] == pytest.approx(nodes)
    assert np.all(np.diff(positions) > 0)


def test_places_that_differ_by_round_off_are_one():
    assert merge_places(np.array([0.3, 0.1 + 0.2, 0.1])) == pytest.approx([0.1, 0.3])


def test_smooth_roads_and_no_road_are_the_same(bridge, truck):
    flat = bc.RoadProfile([-10, 30], [3.0, 3.0])
    assert bc.daf(bridge, truck, 30.0, flat, start=-10) == pytest.approx(
        bc.daf(bridge, truck, 30.0), abs=1e-9
    )


@pytest.mark.filterwarnings("ignore:the axle moves at 5.03e")
def test_a_crossing_that_would_take_cells_without_end_is_an_error(bridge, truck):
    rigid = dataclasses.replace(truck, tire_stiffness=1e14)
    run = prepare(bc.Crossing(bridge, rigid), None, 0.0)
    with pytest.raises(ValueError, match=r"needs .* cells .*check stiffnesses.*n_modes"):
        run.nodes(0.5)
    with pytest.raises(ValueError, match=r"the vehicle's fastest motion .* stiffnesses.* would do"):
        bc.daf(bridge, rigid, 0.5)
