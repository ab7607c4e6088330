"""Many modes in cells that do not follow them: exact responses, and amplifications within 2e-6."""

import numpy as np
import pytest
from helpers import rough_road

import bridgectl as bc
from bridgectl.linear import runs
from bridgectl.linear.cells import (
    FORCE_POINTS,
    sample_positions,
)
from bridgectl.linear.modes import (
    SLOW,
    hold_responses,
    mode_matrices,
    mode_responses,
    rates,
    ringing,
)
from bridgectl.linear.peaks import Ringing, find_peaks
from bridgectl.linear.response import linear_dafs

POINTS = np.array([0.3, 1.0])


@pytest.mark.parametrize("phase", [0.0, 0.1, 0.99 * SLOW, 1.01 * SLOW, 6.0])
@pytest.mark.parametrize("damping", [0.0, 0.3])
@pytest.mark.filterwarnings("ignore::bridgectl.PlausibilityWarning")
def test_responses_in_closed_form_are_those_of_matrix_exponentials(phase, damping):
    """To states and forces, within 1e-11 of the largest response of its kind."""
    beam = bc.li2006.beam(n_modes=2, damping_ratio=(damping, damping))
    durations = np.array([[phase / beam.omega[0], phase / beam.omega[1]]])
    crossing = bc.Crossing(beam, bc.li2006.car())
    found = mode_responses(beam, durations, FORCE_POINTS, POINTS)
    free, held = hold_responses(*mode_matrices(crossing, 2), durations, FORCE_POINTS, POINTS)
    for given, expected in zip(found, (free, held[..., 0]), strict=True):
        scale = np.abs(expected).max(axis=(0, 1, 2, 3, -1), keepdims=True) + 1e-12
        assert given / scale == pytest.approx(expected / scale, abs=1e-11)


def test_what_rings_under_no_force_is_the_free_motion():
    beam = bc.li2006.beam(n_modes=4, damping_ratio=0.02)
    durations, start = np.array([[0.01]]), np.array([2e-4, -0.03])
    from_states, from_forces = ringing(beam, durations, FORCE_POINTS)
    amplitude = (from_states[0, 0] * start).sum(axis=1)
    free, held = mode_responses(beam, durations, FORCE_POINTS, POINTS)
    expected = free[0, 0, :, :, 0] @ start
    assert np.real(
        amplitude[:, np.newaxis] * np.exp(np.outer(rates(beam), 0.01 * POINTS))
    ) == pytest.approx(expected, abs=1e-15)
    # Under a constant force what rings is about the static deflection: at rest, all of it.
    static = 1 / (beam.modal_masses * beam.omega**2)
    rest = from_forces[0, 0].sum(axis=1)
    assert rest.real == pytest.approx(-static, rel=1e-9)
    assert held.shape == (1, 1, 4, 2, 2, len(FORCE_POINTS))


@pytest.mark.parametrize("shared", [False, True])
def test_a_peak_of_what_rings_between_samples_is_found(shared):
    nodes = np.linspace(0, 1, 11)
    x = sample_positions(nodes)
    history = np.cos(x - 0.5) + 0.01 * np.cos(300 * (x - 0.52))
    phases = np.exp(300j * (nodes[:-1] - 0.52))[:, np.newaxis, np.newaxis]
    rings = Ringing(0.01 * phases, np.full_like(phases, 30j))
    histories = np.column_stack([history, history - 1])
    if not shared:
        rings = Ringing(*(np.repeat(of, 2, axis=2) for of in rings))
    fine = np.linspace(0, 1, 10**6)
    top = np.max(np.cos(fine - 0.5) + 0.01 * np.cos(300 * (fine - 0.52)))
    assert find_peaks(histories, rings).values == pytest.approx([top, top - 1], abs=3e-5)
    assert abs(find_peaks(histories).values[0] - top) > 1e-4


def converged(monkeypatch, crossing, speed, profile, start):
    """The same with cells in which the highest mode turns by 1.7 rad at most."""
    run = runs.prepare(crossing, profile, start)
    usual = runs.cell_nodes
    longest = np.diff(run.nodes(speed)).max() / speed
    pieces = int(np.ceil(crossing.beam.omega.max() * longest / 1.7))
    with monkeypatch.context() as patch:
        patch.setattr(runs, "cell_nodes", lambda c, v, kinks, refine=1: usual(c, v, kinks, pieces))
        return linear_dafs(run, np.array([speed]))[0]


@pytest.mark.parametrize("n_modes", [14, 20])
@pytest.mark.parametrize("speed", [50, 62, 108])
@pytest.mark.parametrize("road", ["smooth", "rough"])
@pytest.mark.parametrize("recovery", ["exact", "li2006"])
def test_amplifications_of_many_modes_are_converged_to_2e_6(
    monkeypatch, truck, n_modes, speed, road, recovery
):
    beam, c = bc.li2006.beam(n_modes=n_modes), speed / 3.6
    given = {"smooth": (None, 0.0), "rough": (rough_road(3, -20, 25), -20.0)}[road]
    crossing = bc.Crossing(beam, truck, bc.Moment(recovery=recovery))
    expected = converged(monkeypatch, crossing, c, *given)
    found = bc.daf(beam, truck, c, given[0], start=given[1], recovery=recovery)
    assert found == pytest.approx(expected, abs=2e-6)


@pytest.mark.parametrize("n_modes", [5, 14])
def test_a_truck_of_two_axles_and_hogging_over_a_pier_are_converged_to_2e_6(
    monkeypatch, truck, n_modes
):
    twins = bc.convoy([truck, truck], [0.0, 4.0])
    bridge = bc.Bridge([20.0, 20.0], 18358.0, 4.865e10, n_modes=n_modes)
    road = rough_road(5, -20, 44)
    for effect in (bc.Moment(8.0), bc.Moment(20.0, sense="smallest"), bc.Deflection(9.0)):
        crossing = bc.Crossing(bridge, twins, effect)
        expected = crossing.orientation * abs(converged(monkeypatch, crossing, 20.0, road, -20.0))
        found = bc.daf(bridge, twins, 20.0, road, start=-20, effect=effect)
        assert abs(found[0]) == pytest.approx(abs(expected), abs=2e-6)


def test_a_flight_of_many_modes_has_the_peak_of_short_cells(monkeypatch, truck):
    road = bc.RoadProfile([-20, -6, -5, -4.9, 25], [0, 0, 0.09, 0, 0])
    beam = bc.li2006.beam(n_modes=14)
    with pytest.warns(bc.LiftOffWarning):
        expected = converged(monkeypatch, bc.Crossing(beam, truck), 10.0, road, -20.0)
    with pytest.warns(bc.LiftOffWarning):
        found = bc.daf(beam, truck, 10.0, road, start=-20)
    assert found == pytest.approx(expected, abs=3e-6)


def test_a_surface_of_many_modes_has_the_smooth_daf_and_ramps_to_1e_5(truck):
    beam, speeds = bc.li2006.beam(n_modes=14), np.array([60, 108]) / 3.6
    surface = bc.ramp_surface(beam, truck, speeds)
    assert surface.daf_smooth == pytest.approx(bc.daf(beam, truck, speeds), abs=2e-6)
    for ramp in (30, 110):
        edges = surface.stations[ramp : ramp + 2]
        road = bc.RoadProfile([0.0, *edges, 25.0], [0.0, 0.0, -1e-3, -1e-3])
        alone = bc.daf(beam, truck, speeds, road)
        assert surface.daf_unit[:, ramp] == pytest.approx(alone, abs=1e-5)
    level = bc.RoadProfile([0.0, 25.0], [0.0, 0.0])
    assert surface.superposed_daf(level) == pytest.approx(surface.daf_smooth, abs=1e-9)


def test_modes_that_an_effect_does_not_read_ring_in_nothing(truck):
    crossing = bc.Crossing(bc.li2006.beam(n_modes=14), truck, bc.TireForce())
    assert runs.fast_modes(crossing, np.linspace(0, 25, 251), 14.0).size == 0


def test_cells_follow_the_modes_that_yield_to_tires_and_no_others(truck):
    def cells(n_modes, speed=10.0):
        return len(
            runs.prepare(bc.Crossing(bc.li2006.beam(n_modes=n_modes), truck), None, 0.0).nodes(
                speed
            )
        )

    assert cells(3) < cells(4)
    assert cells(3) < cells(9)
    assert cells(10) == cells(20) == cells(3)
