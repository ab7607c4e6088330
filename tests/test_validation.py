"""`bridgectl validate`: Section 4 of the paper again."""

import json
import re

import numpy as np
import pytest
from helpers import rough_road, run_command

import bridgectl as bc
from bridgectl.cli.validate import print_validation
from bridgectl.paper.good_roads import EXTREME_RAMP, good_roads
from bridgectl.paper.validation import (
    PEAK_TOLERANCE,
    SPANS,
    STARTS,
    SUPERPOSED_TOLERANCE,
    validate,
)
from bridgectl.plots.validation import validation_figure
from bridgectl.road.iri import GOOD

FEW = np.array([66.0, 100.0, 108.0]) / 3.6


@pytest.fixture(scope="module")
def few():
    """Three speeds on the 25 m bridge."""
    return validate(FEW, spans=[25], n_random=20)


@pytest.mark.slow
def test_the_eight_roads_are_good_and_cover_the_longest_case():
    roads = good_roads()
    assert len(roads) == 8
    for number, road in enumerate(roads, 1):
        assert road.name.startswith(f"{number} ")
        assert road.iri() < GOOD
        assert road.x == pytest.approx(-200 + 0.1 * np.arange(2351), abs=1e-9)
        assert road.elevation_at(0.0) == pytest.approx(0.0, abs=1e-12)


def test_the_measured_roads_are_the_utia_road_without_its_grade():
    whole = bc.utia_road()
    for road, station in zip(good_roads(), (678, 940), strict=False):
        height = whole.elevation_at(road.x + station) - road.elevation
        assert height == pytest.approx(np.polyval(np.polyfit(road.x, height, 1), road.x), abs=1e-9)


def test_the_extreme_roads_are_extreme_among_roads_of_their_ramps(few):
    large, small = good_roads()[6:]
    for road in (large, small):
        assert np.abs(np.diff(road.elevation)).max() <= EXTREME_RAMP * (1 + 1e-6)
    peaks = [case.daf_peak.value for case in few.groups[25, 200]]
    assert np.argmax(peaks) == 6
    assert np.argmin(peaks) == 7


def test_a_case_holds_what_the_library_says_of_its_road(few, bridge, truck):
    case = next(c for c in few.cases if (c.road, c.approach) == (5, 200))
    road = few.roads[4]
    surface = bc.ramp_surface(bridge, truck, FEW, approach=200)
    assert case.smooth == pytest.approx(surface.daf_smooth, abs=1e-12)
    assert case.dae == pytest.approx(surface.dae(road), abs=1e-12)
    assert case.superposed == pytest.approx(surface.superposed_daf(road), abs=1e-12)
    assert case.simulated == pytest.approx(bc.daf(bridge, truck, FEW, road, start=-200), abs=1e-12)
    assert not case.flying.any()
    assert case.lift_off is None


def test_the_measures_of_a_case_are_read_from_its_curves(few):
    for case in few.cases:
        error = case.dae - case.simulated
        assert case.daf_peak == (case.simulated.max(), FEW[case.simulated.argmax()])
        assert case.peak_difference == case.dae.max() - case.simulated.max()
        assert case.rms_error == pytest.approx(np.linalg.norm(error) / np.sqrt(len(FEW)))
        assert case.largest_error.value == np.abs(error).max()
        assert case.superposed_error == np.abs(case.superposed - case.simulated).max()
    sizes = sorted(abs(case.peak_difference) for case in few.cases)
    assert few.median_difference == pytest.approx((sizes[7] + sizes[8]) / 2)
    assert abs(few.worst_peak.peak_difference) == sizes[-1]


def test_without_an_approach_the_road_before_the_bridge_does_not_count():
    road = rough_road(1, -50, 25)
    alone = validate(FEW, [25], [0.0], [road.crop(0, 25)], n_random=2).cases[0]
    behind = validate(FEW, [25], [0.0], [road], n_random=2).cases[0]
    assert behind.simulated == pytest.approx(alone.simulated, abs=1e-9)
    assert behind.dae == pytest.approx(alone.dae, abs=1e-9)


def test_where_a_tire_leaves_the_road_is_told_and_does_not_count_as_an_error(bridge, truck, capsys):
    step = bc.RoadProfile([0, 4.9, 5, 25], [0, 0, -0.09, -0.09], name="drop").resample(0.1)
    results = validate(FEW, [25], [0.0], [step], n_random=2)
    case = results.cases[0]
    assert case.flying.all()
    assert 4.9 < case.lift_off < 5.1
    assert case.superposed_error == 0.0
    with pytest.warns(bc.LiftOffWarning):
        simulated = bc.daf(bridge, truck, FEW, step)
    assert case.superposed == pytest.approx(simulated, abs=1e-9)
    print_validation(results)
    place = f"x = {case.lift_off:.1f} m: road 1, 25 m bridge, at rest at its start."
    assert f"A tire leaves the road, first at {place}" in capsys.readouterr().out


@pytest.mark.slow
def test_the_whole_validation_meets_what_it_is_required_to():
    """One test, so that it runs once: 48 cases at 101 speeds, and the light on 1000 roads."""
    whole = validate()
    # As the paper finds: 'an excellent match in the maximum values of DAF/DAE'.
    assert len(whole.cases) == len(SPANS) * len(STARTS) * 8
    assert len(whole.speeds) == 101
    assert whole.median_difference < PEAK_TOLERANCE
    for case in whole.cases:
        assert not case.flying.any()
        assert case.superposed_error < SUPERPOSED_TOLERANCE
        # Not so on 15 m, and not for road 8 after an approach: its DAF is so flat that the peak
        # leaves mid-span.
        if case.span > 15 and (case.span, case.approach, case.road) != (25, 200, 8):
            assert abs(case.peak_difference) < PEAK_TOLERANCE
    # An error of 0.02 of the DAF is large.
    assert whole.light.crossings == 101_000
    assert 0.1 < whole.light.large / whole.light.crossings < 0.6
    assert whole.light.precision > 0.9
    assert whole.light.recall > 0.9


def test_every_case_is_printed_with_the_summary(capsys):
    status, out, err = run_command(capsys, "validate", "--spans", "25,35", "--speeds", "66,108")
    assert (status, err) == (0, "")
    for span in (25, 35):
        for start in ("at rest at its start", "200 m of approach"):
            assert f"{span} m bridge, {start}" in out
    rows = re.findall(r"^ +[1-8] +\d\.\d{4} +(?:66|108) +\d\.\d{4} ", out, re.MULTILINE)
    assert len(rows) == 32
    assert "32 cases, 2 speeds: median difference" in out
    assert "required below 0.002: met" in out
    assert "required below 1e-06: met" in out
    tables = out[: out.index("Peak DAE and")]
    assert max(len(line.rstrip()) for line in tables.splitlines()) <= 100


@pytest.mark.slow
def test_json_holds_every_case_at_every_speed(capsys):
    status, out, err = run_command(
        capsys, "validate", "--spans", "25", "--speeds", "66,100,108", "--json"
    )
    assert (status, err) == (0, "")
    result = json.loads(out)
    assert result["speed_km_per_h"] == pytest.approx([66, 100, 108])
    assert [road["road"] for road in result["roads"]] == list(range(1, 9))
    assert max(road["iri_m_per_km"] for road in result["roads"]) < GOOD
    assert len(result["cases"]) == 16
    for case in result["cases"]:
        assert len(case["dae"]) == len(case["daf_smooth"]) == 3
        assert case["daf_superposed"] == pytest.approx(case["daf_simulated"], abs=1e-6)
        assert case["peak_difference"] == case["peak_dae"] - case["peak_daf"]
        assert (case["lift_off_speeds_km_per_h"], case["lift_off_x_m"]) == ([], None)
    differences = [abs(case["peak_difference"]) for case in result["cases"]]
    assert result["median_peak_difference"] == pytest.approx(np.median(differences))
    assert abs(result["largest_peak_difference"]) == max(differences)


@pytest.mark.slow
def test_the_figure_has_the_papers_panels_with_units(few, tmp_path):
    figure = validation_figure(few)
    assert len(figure.axes) == 8 * 3 + 2
    told = {axes.get_xlabel() for axes in figure.axes} | {a.get_ylabel() for a in figure.axes}
    assert told - {""} == {
        "x from the start of the bridge [m]", "z [mm]", "speed [km/h]", "DAF [-]",
        "peak DAF [-]", "peak DAE [-]", "road", "|peak DAE - peak DAF| [-]",
    }  # fmt: skip
    elevations, first = figure.axes[:2]
    assert elevations.get_title(loc="left") == few.roads[0].name
    curves = {line.get_label(): line.get_ydata() for line in first.lines}
    assert curves["DAE"] == pytest.approx(few.cases[0].dae)
    assert curves["simulated DAF"] == pytest.approx(few.cases[0].simulated)
    assert curves["superposed DAF"] == pytest.approx(few.cases[0].superposed)
    figure.savefig(tmp_path / "figure.png")
    assert (tmp_path / "figure.png").stat().st_size > 50_000


@pytest.mark.slow
def test_the_command_draws(capsys, tmp_path):
    picture = tmp_path / "validation.svg"
    status, out, _ = run_command(capsys, "validate", "--spans", "25", "--speeds", "66,108",
                         "--plot", picture)  # fmt: skip
    assert status == 0
    assert f"Drawn: {picture}" in out
    assert picture.stat().st_size > 50_000


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--spans", "24"], "span must be one of 9, 11"),
        (["--spans", "25,37"], "--spans must be 35 m at most, as the roads, got 25,37"),
        (["--spans", "long"], "--spans must be numbers separated by commas"),
        (["--speeds", "150:50:1"], "--speeds must rise"),
        (["--plot", "validation.gif"], "--plot must end in .png, .pdf or .svg"),
    ],
)
def test_a_mistake_is_told_in_one_line_before_the_work(capsys, options, message):
    status, out, err = run_command(capsys, "validate", *options)
    assert (status, out) == (2, "")
    assert len(err.splitlines()) == 1
    assert message in err


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"spans": []}, "must hold one value each at least"),
        ({"roads": []}, "must hold one value each at least"),
        ({"starts": [-200]}, "starts must be 0 or more"),
        ({"starts": [300.0]}, "road"),
        ({"spans": [43]}, "road"),
    ],
)
def test_what_cannot_be_validated_is_refused(arguments, message):
    with pytest.raises(ValueError, match=message):
        validate(FEW, **arguments)
