"""DAF against the paper, closed forms and other codes: the numbers are in data/cases.json."""

import dataclasses

import numpy as np
import pytest

import bridgectl as bc

PAPER_SPEEDS = np.arange(50, 151, 10) / 3.6


def test_smooth_daf_at_the_eleven_speeds_is_the_independently_computed_column(bridge, truck, cases):
    computed = cases["li2006"]["computed_li2006"]
    values = bc.daf(bridge, truck, PAPER_SPEEDS, recovery="li2006")
    assert values == pytest.approx(computed["daf_smooth"], abs=3e-5)


def test_smooth_daf_at_110_kmh_is_the_printed_1_1302(bridge, truck):
    value = bc.daf(bridge, truck, 110 / 3.6, recovery="li2006")[0]
    assert round(value, 4) == bc.li2006.PRINTED["daf_smooth_110"] == 1.1302


def test_exact_recovery_with_3_modes(bridge, truck, cases):
    computed = cases["li2006"]["computed_exact_3_modes"]["daf_smooth"]
    assert bc.daf(bridge, truck, PAPER_SPEEDS) == pytest.approx(computed, abs=5e-5)


def test_exact_recovery_with_20_modes(truck, cases):
    """Within 5e-5 of the reference column but at 50 and 100 km/h, where the column is off.

    There a tight integration written from the equations alone (scipy's DOP853, rtol 1e-10,
    200 000 samples) gives 1.0540699 and 1.1089450; at rtol 1e-9 `control` gives the same.
    """
    values = bc.daf(bc.li2006.beam(n_modes=20), truck, PAPER_SPEEDS)
    column = np.array(cases["li2006"]["computed_exact_20_modes"]["daf_smooth"])
    column[[0, 5]] = 1.0540699, 1.1089450
    assert values == pytest.approx(column, abs=5e-5)
    assert values[[0, 5]] == pytest.approx([1.0540699, 1.1089450], abs=1e-6)


def test_critical_speeds_are_the_twin_peak_around_105_kmh(bridge, truck):
    kmh = np.arange(95, 116)
    values = bc.daf(bridge, truck, kmh / 3.6, recovery="li2006")
    peaks = [i for i in range(1, 20) if values[i - 1] < values[i] > values[i + 1]]
    assert kmh[peaks].tolist() == [103, 108]
    assert values[peaks] == pytest.approx([1.1320, 1.1385], abs=1e-4)


@pytest.mark.parametrize("n_modes", range(1, 7))
def test_creeping_gives_a_daf_of_1_for_every_number_of_modes(truck, n_modes):
    """Within 1e-3 at 0.5 m/s with a little damping, as on any real bridge."""
    beam = bc.li2006.beam(n_modes=n_modes, damping_ratio=0.01)
    assert bc.daf(beam, truck, 0.5) == pytest.approx(1.0, abs=1e-3)


@pytest.mark.quick_cases(1)
@pytest.mark.parametrize("n_modes", [1, 3, 6])
def test_an_undamped_bridge_still_rings_from_the_entry_of_a_creeping_truck(truck, n_modes):
    """The ringing of mode 1 is 8 alpha / pi^2 of the static moment: 2.0e-3 at 0.5 m/s.

    At 0.5 m/s a tight integration from the equations alone gives 0.998938 with one mode and
    0.998886 with three: the ringing takes 1.1e-3 off. It falls in proportion to speed.
    """
    beam = bc.li2006.beam(n_modes=n_modes)
    for speed in (0.5, 0.25):
        alpha = np.pi * speed / beam.length / beam.omega[0]
        assert bc.daf(beam, truck, speed) == pytest.approx(1.0, abs=8 / np.pi**2 * alpha)
    expected = {1: 0.998938, 3: 0.998886, 6: 0.998886}[n_modes]
    assert bc.daf(beam, truck, 0.5) == pytest.approx(expected, abs=2e-6)


def force_on_wheels(load):
    """A vehicle so softly sprung that its tire force stays constant."""
    return bc.Vehicle([[load / 9.81]], [[0.0]], [[0.0]], [1e-3])


def deflection_daf(beam, vehicle, speed):
    response = bc.crossing_response(beam, vehicle, speed)
    peak = np.abs(response.outputs["deflection"]).max()
    weight = vehicle.linear.static_loads.sum()
    return peak / (weight * beam.length**3 / 48 / beam.flexural_rigidity), peak


def constant_force_history(alpha, n_modes, x):
    """Fryba 1972, ch. 1: mid-span moment of a unit force over l / 4, exact and modal recovery.

    q_n / q_n,static = [sin n W t - (alpha / n) sin w_n t] / (1 - (alpha / n)^2), x = c t / l.
    """
    exact, modal = 2 * np.minimum(x, 1 - x), np.zeros_like(x)
    for n in range(1, n_modes + 1, 2):
        # 1 / (1 - r^2) has a removable pole at r = 1: a hair beside it is 1e-9 off.
        ratio = alpha / n * (1 + 1e-9)
        shape = (-1) ** ((n - 1) // 2) * 8 / (np.pi * n) ** 2
        motion = np.sin(n * np.pi * x) - ratio * np.sin(n * np.pi * x / ratio)
        dynamic = motion / (1 - ratio**2)
        modal += shape * dynamic
        exact += shape * (dynamic - np.sin(n * np.pi * x))
    return exact, modal


@pytest.mark.quick_cases(3)
@pytest.mark.parametrize("i", range(8))
def test_a_constant_force_gives_frybas_closed_form(cases, i):
    """Moments within 1e-6 of the closed form with the same modes, 2e-4 of the table.

    The table sums 1000 modes without static correction, which leaves 8 / (2000 pi^2) = 4.1e-4
    of the static moment out where the force is at mid-span: at alpha = 0.2 it has 0.8700 where
    the corrected sum converges to 0.8704.
    """
    case = cases["moving_constant_force"]
    beam, alpha = bc.li2006.beam(n_modes=20), case["alpha"][i]
    speed = alpha * beam.omega[0] * beam.length / np.pi
    moment = bc.daf(beam, force_on_wheels(1e4), speed)[0]
    x = np.linspace(0, 1, 100_001)
    exact, _ = constant_force_history(alpha, 20, x)
    assert moment == pytest.approx(exact.max(), abs=1e-6)
    table = case["daf_moment"][i]
    converged, modal = constant_force_history(alpha, 1000, x[::10])
    assert modal.max() == pytest.approx(table, abs=1e-4)
    missing = 8 / (2000 * np.pi**2) if alpha == 0.2 else 0.0
    assert moment == pytest.approx(table + missing, abs=case["tolerance"])
    assert moment == pytest.approx(converged.max(), abs=case["tolerance"])
    few = bc.li2006.beam(n_modes=10)
    deflection, _ = deflection_daf(few, force_on_wheels(1e4), speed)
    assert deflection == pytest.approx(case["daf_deflection"][i], abs=case["tolerance"])


@pytest.mark.parametrize("n_modes", [1, 3, 10, 20])
def test_a_sprung_mass_deflects_the_beam_of_yang_and_yau(cases, n_modes):
    case = cases["sprung_mass"]
    beam = bc.Beam(**case["beam"], n_modes=n_modes)
    vehicle = bc.Vehicle([[case["mass"]]], [[0.0]], [[0.0]], [case["stiffness"]])
    _, peak = deflection_daf(beam, vehicle, case["speed"])
    expected = case["max_midspan_deflection_m"][str(n_modes)]
    assert peak == pytest.approx(expected, rel=case["relative_tolerance"])


@pytest.mark.parametrize("road", ["smooth", "ramp"])
def test_vbi_2d_finds_the_same_deflection_with_60_finite_elements(cases, road):
    case, length = cases["vbi2d"], 25.0
    beam = bc.li2006.beam(n_modes=20)
    vehicle = bc.Vehicle([[5750.0]], [[0.0]], [[0.0]], [1.595e6])
    profile, expected = None, case["smooth_peak_midspan_deflection_m"]
    if road == "ramp":
        profile = bc.RoadProfile([0, length / 3, length / 2, length], [0, 0, 0.01, 0.01])
        expected = case["ramp_10mm_l3_to_l2_peak_midspan_deflection_m"]
    response = bc.crossing_response(beam, vehicle, 25.0, profile)
    peak = response.outputs["deflection"].max()
    assert peak == pytest.approx(expected, rel=case["relative_tolerance"])


@pytest.mark.parametrize("n_modes", [1, 3, 10])
def test_another_codes_quarter_car(cases, n_modes):
    case = cases["quarter_car_other_code"]
    given = case["beam"]
    rigidity = given["youngs_modulus"] * given["second_moment"]
    beam = bc.Beam(given["length"], given["mass_per_length"], rigidity, n_modes=n_modes)
    car = bc.QuarterCar(**case["vehicle"])
    moment = bc.daf(beam, car, case["speed"])[0]
    expected = case["daf_moment_exact"][str(n_modes)]
    assert moment == pytest.approx(expected, abs=case["tolerance"])
    if n_modes == 10:
        deflection, peak = deflection_daf(beam, car, case["speed"])
        assert deflection == pytest.approx(case["daf_deflection"], abs=case["tolerance"])
        assert peak == pytest.approx(case["peak_deflection_m"], rel=case["tolerance"])
        force = bc.crossing_response(beam, car, case["speed"]).outputs["tire_force"]
        assert [force.min(), force.max()] == pytest.approx(case["contact_force_range_N"], abs=2)


def test_modal_recovery_converges_to_the_exact_one_as_1_over_n(truck):
    errors = []
    for n_modes in (5, 15):
        beam = bc.li2006.beam(n_modes=n_modes)
        exact = bc.daf(beam, truck, 30.0)
        errors.append(abs(bc.daf(beam, truck, 30.0, recovery="modal") - exact)[0])
    assert errors[1] < 0.4 * errors[0]


def test_daf_takes_the_peak_between_the_samples(bridge, truck):
    """The coarse cells' DAF is that of cells a tenth as long, within 1e-6."""
    speeds = np.array([60, 90, 110, 140]) / 3.6
    coarse = bc.daf(bridge, truck, speeds)
    fine = [
        float(bc.crossing_response(bridge, truck, c, timepts=fine_time(c)).outputs["moment"].max())
        for c in speeds
    ]
    assert coarse == pytest.approx(fine, abs=1e-6)


def fine_time(speed):
    return np.linspace(0, 25 / speed, 5001)


def test_a_damper_hardly_matters_on_a_smooth_road(bridge, truck):
    speeds = np.arange(50, 151) / 3.6
    passive = bc.daf(bridge, truck, speeds)
    for damping in (1e3, 30e3):
        other = bc.daf(bridge, dataclasses.replace(truck, damping=damping), speeds)
        assert np.abs(other - passive).max() < 0.0025
        assert abs(other.max() - passive.max()) < 0.001
