"""How densely and evenly a road is sampled: what is measured rightly, and what is warned of."""

import copy
import inspect
import json
import pickle

import numpy as np
import pytest
from helpers import rough_road, run_command

import bridgectl as bc
from bridgectl.dampers import passive
from bridgectl.road import (
    RoadProfile,
    add_events,
    bump,
    iso8608_elevations,
    plank,
    ramp,
    read_profile,
    settlement,
    step,
    tire_footprint,
)
from bridgectl.road.limits import evenly_spaced
from bridgectl.road.sampling import COARSE

FOOT = 0.3048
COARSELY = "the road was measured every {:g} m, too coarsely for "


@pytest.fixture(scope="module")
def fine():
    """A road of class A every 50 mm, from 200 m before a bridge to 100 m past its beginning."""
    z = iso8608_elevations(1, "A", 300, 0.05, seed=1, band=(0.01, 10.0))[0]
    return RoadProfile(-200 + 0.05 * np.arange(z.size), z, name="road")


def sampled(road, every, *, to=None, unit=1.0):
    """The road read every so often [m], its stations rounded to decimals of a unit."""
    x = np.arange(road.x[0], road.x[-1] + 1e-9, every)
    stations = x if to is None else unit * np.round(x / unit, to)
    return RoadProfile(stations, np.interp(x, road.x, road.elevation), name=road.name)


ROUNDED = {
    "a foot's thousandth": (0.25, 3, FOOT),
    "a foot's hundredth": (0.2069167 * FOOT, 2, FOOT),
    "a millimetre": (0.2069167 * FOOT, 3, 1.0),
    "a centimetre": (0.5 * FOOT, 2, 1.0),
    "a decimetre": (0.25, 1, 1.0),
    "an inch's tenth": (0.05, 1, 0.0254),
}


@pytest.mark.parametrize(("every", "to", "unit"), ROUNDED.values(), ids=ROUNDED)
def test_rounded_stations_are_even_ones(fine, every, to, unit):
    plain, rounded = sampled(fine, every), sampled(fine, every, to=to, unit=unit)
    assert not np.allclose(np.diff(rounded.x), every, rtol=1e-4, atol=0)
    assert rounded.iri() == pytest.approx(plain.iri(), rel=2e-3)
    assert rounded.iri(50) == pytest.approx(plain.iri(50), rel=2e-3)
    assert rounded.psd().fit().roughness == pytest.approx(plain.psd().fit().roughness, rel=2e-3)


def test_stations_of_single_precision_are_even_ones(fine):
    plain = sampled(fine, 0.1)
    single = (plain.x + 1e4).astype(np.float32)
    assert RoadProfile(single, plain.elevation).iri() == pytest.approx(plain.iri(), rel=2e-3)


@pytest.mark.parametrize("first", [0.025, 0.075])
def test_halves_may_be_rounded_up_here_and_down_there(first):
    """As the binary fractions of the stations have it: 0.03, 0.07, 0.12, 0.17, ..."""
    assert evenly_spaced(np.array([float(f"{first + 0.05 * i:.2f}") for i in range(4000)]))


@pytest.mark.parametrize("missing", [1, 40, 200, 398])
@pytest.mark.parametrize("every", [0.25, 0.2])
def test_a_missing_reading_is_no_rounding(missing, every):
    """Even where the decimals of the stations are as large as half of a step."""
    assert evenly_spaced(x := np.round(every * np.arange(400), 1))
    assert not evenly_spaced(np.delete(x, missing))


def test_stations_that_wander_are_not_even():
    x = np.cumsum(np.random.default_rng(0).uniform(0.24, 0.26, 1000))
    assert not evenly_spaced(x)
    assert not evenly_spaced(np.where(np.arange(1000) < 500, 0.25, 0.2505) * np.arange(1000))
    assert not evenly_spaced(np.array([0, 0.25, 0.5, 0.8, 1.0, 1.25, 1.5]))  # a slip, no decimal
    assert not evenly_spaced(np.append(0.5 * np.arange(100), 49.8))  # the end of a cropped road


def test_stations_that_stray_a_tenth_of_a_step_change_an_iri_by_less_than_a_hundredth():
    for seed in range(5):
        fine = iso8608_elevations(1, "A", 500, 0.05, seed=seed)[0]
        even = np.arange(1, 499, 0.25)
        stray = np.random.default_rng(seed).uniform(-0.045, 0.045, even.size) * 0.25
        assert evenly_spaced(even + stray)
        told, strayed = (
            RoadProfile(x, np.interp(x, 0.05 * np.arange(fine.size), fine)).iri()
            for x in (even, even + stray)
        )
        assert strayed != told
        assert strayed == pytest.approx(told, rel=0.01)


def write(path, road, line):
    rows = [line(x, 1e3 * z) for x, z in zip(road.x, road.elevation, strict=True)]
    path.write_text("\n".join(rows), encoding="utf-8")
    return path


def measured(capsys, path, *options):
    """What `bridgectl profile` measures of a file, and the warnings that it prints."""
    status, out, err = run_command(capsys, "profile", path, "--json", "--units", "m,mm", *options)
    assert status == 0
    return json.loads(out)["tracks"][0], err


@pytest.mark.parametrize(
    ("every", "line"),
    [
        (0.25, lambda x, z: f"{x:.3f},{z:.5f}"),
        (0.5 * FOOT, lambda x, z: f"{x:.2f},{z:.5f}"),
        (0.25, lambda x, z: f"{x:.1f},{z:.5f}"),
        (0.0630682, lambda x, z: f"{x:.3f},{z:.5f}"),
    ],
)
def test_the_command_line_measures_a_rounded_file_as_the_plain_one(
    capsys, tmp_path, fine, every, line
):
    road = sampled(fine, every)
    track, err = measured(capsys, write(tmp_path / "rounded.csv", road, line))
    assert err == ""
    assert track["iri_m_per_km"] == pytest.approx(road.iri(), rel=2e-3)
    assert (track["good"], track["iso_class"]) == (True, "A")


@pytest.mark.parametrize("start", [-200.0, 0.0, 1234.567, 1e5 / 3])
@pytest.mark.parametrize("every", [1e-3, 0.5e-3])
def test_texture_is_read_whatever_the_round_off_of_its_stations(
    capsys, tmp_path, fine, start, every
):
    """The waves of the plain road, of stations every 50 mm, are those of one every millimetre."""
    short = fine.crop(0, 15)
    texture = sampled(short, every)
    moved = RoadProfile(texture.x + start, texture.elevation)
    path = write(tmp_path / "texture.csv", moved, lambda x, z: f"{float(x)!r},{float(z)!r}")
    assert read_profile(path, units="m,mm").x.size == moved.x.size
    track, err = measured(capsys, path)
    assert "too coarse" not in err
    assert (track["good"], track["measured_step_m"]) == (True, pytest.approx(0.05))
    with pytest.warns(UserWarning, match="an IRI over 15 m says little"):
        assert track["iri_m_per_km"] == pytest.approx(short.iri(), rel=2e-3)


def test_texture_without_stations_is_read_with_a_step(tmp_path):
    path = tmp_path / "texture.csv"
    path.write_text("\n".join(str(i % 3 / 10) for i in range(4000)), encoding="utf-8")
    assert read_profile(path, step=0.5e-3, units="mm").x[-1] == pytest.approx(1.9995)


@pytest.mark.parametrize("every", [1.0, 2.0, 5.0])
@pytest.mark.parametrize("filled", [None, 0.1, 0.25])
def test_the_command_line_calls_no_coarse_road_good(capsys, tmp_path, fine, every, filled):
    """Not even one that was filled by interpolation and rounded to the micrometre."""
    road = sampled(fine, every)
    road = road if filled is None else sampled(road, filled)
    path = write(tmp_path / "coarse.csv", road, lambda x, z: f"{x:.2f},{z:.3f}")
    track, err = measured(capsys, path)
    assert err.startswith(f"bridgectl: warning: coarse: {COARSELY.format(every)}an IRI")
    assert len(err.splitlines()) == 1
    assert (track["good"], track["iso_class"], track["roughness_m3"]) == (None, None, None)
    assert track["measured_step_m"] == pytest.approx(every)
    _, out, _ = run_command(capsys, "profile", path, "--units", "m,mm", "--full")
    assert "good" not in out
    row = next(line.split() for line in out.splitlines() if line.split()[:1] == ["coarse"])
    assert row[5:] == ["coarse", "-", "-", "-"]


def test_uneven_levels_far_apart_are_not_called_good(capsys, tmp_path, fine):
    x = np.append(np.cumsum(np.random.default_rng(0).uniform(1.5, 4.0, 90)) - 200, 99.0)
    road = RoadProfile(x, fine.elevation_at(x))
    track, err = measured(capsys, write(tmp_path / "levels.csv", road, "{:.3f},{:.3f}".format))
    assert track["good"] is None
    assert "unevenly spaced" in err
    assert "too coarsely for an IRI" in err


def test_dae_and_score_of_a_coarse_file_are_warned_of(capsys, tmp_path, fine):
    path = write(tmp_path / "coarse.csv", sampled(fine, 2.0), "{:.2f},{:.4f}".format)
    expected = f"bridgectl: warning: coarse: {COARSELY.format(2)}dynamic amplification"
    quick = ["--units", "m,mm", "--approach", "10", "--speeds", "90", "--json"]
    for command in (
        ["dae", path],
        ["score", path, "--random", "0", "--strategies", "passive", "--workers", "1"],
    ):
        status, _, err = run_command(capsys, *command, *quick)
        assert status == 0
        assert err.startswith(expected)
        assert err.count("too coarsely") == 1


@pytest.fixture(scope="module")
def surface():
    return bc.ramp_surface(bc.li2006.beam(), bc.li2006.car(), [25.0], approach=10)


def uses(surface, road):
    """Everything that warns of a coarse road, by name."""
    beam, car = surface.beam, surface.vehicle
    return {
        "iri": lambda: road.iri(),
        "segments": lambda: road.iri(50),
        "running": lambda: road.running_iri(50),
        "line": lambda: road.psd().fit(),
        "ramps": lambda: surface.ramps(road),
        "dae": lambda: surface.dae(road),
        "several": lambda: surface.dae([road]),
        "superposed": lambda: surface.superposed_daf(road),
        "contributions": lambda: surface.contributions(road),
        "trust": lambda: bc.dae_trust(surface, road),
        "daf": lambda: bc.daf(beam, car, 25.0, road, start=-10),
        "response": lambda: bc.crossing_response(beam, car, 25.0, road, start=-10),
        "damped": lambda: bc.daf(beam, car, 25.0, road, start=-10, damper=passive(7e3)),
        "score": lambda: bc.score([passive(7e3)], beam, car, [road], 25.0, approach=10, workers=1),
    }


NAMES = list(uses(*[type("", (), {"beam": None, "vehicle": None})] * 2))


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize(
    "made", [lambda road: road, lambda road: road.crop(-100, 60).detrend().resample(0.1).level()]
)
def test_what_a_coarse_road_is_used_for_is_warned_of_once_at_the_callers_line(
    surface, fine, name, made
):
    use = uses(surface, made(sampled(fine, 2.0)))[name]
    with pytest.warns(UserWarning, match=f"^road: {COARSELY.format(2)}.* 0.305 m or less") as told:
        use()
    assert len(told) == 1
    assert told[0].filename == __file__
    assert told[0].lineno == inspect.getsourcelines(use)[1]


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("every", [0.05, 0.1, 0.25, 0.3, FOOT])
def test_no_use_of_a_fine_road_is_warned_of(surface, fine, name, every):
    road = sampled(fine, every, to=4)
    uses(surface, road)[name]()
    uses(surface, road.crop(-100, 60).resample(0.1))[name]()


def test_the_measured_road_is_fine(surface):
    road = bc.utia_road().place_bridge(678)
    assert road.measured_step == road.resample(0.1).measured_step == 0.25
    for use in uses(surface, road.resample(0.1)).values():
        use()


def test_the_loss_of_coarse_steps_is_what_the_limit_says(fine, bridge, truck):
    """Little up to a foot: 5 % of an IRI, 0.02 of a DAF. Two steps of the limit lose more."""
    speeds = [20.0, 25.0, 30.0]
    daf = bc.daf(bridge, truck, speeds, fine, start=-200)
    for every in (0.1, 0.25, 0.3, COARSE):
        road = sampled(fine, every)
        assert road.iri() == pytest.approx(fine.iri(), rel=0.05)
        assert bc.daf(bridge, truck, speeds, road, start=-200) == pytest.approx(daf, abs=0.02)
    with pytest.warns(UserWarning, match="measured every 2 m"):
        assert sampled(fine, 2.0).iri() < 0.5 * fine.iri()


def test_a_road_made_of_a_coarse_one_is_no_finer(fine):
    coarse = sampled(fine, 5.0)
    made = [
        coarse.resample(0.1), coarse.crop(-7, 20), coarse.detrend(2), coarse.level(0.0),
        coarse.place_bridge(3.0), add_events(coarse, bump(-5.0, 1.0, 0.03)), copy.deepcopy(coarse),
        pickle.loads(pickle.dumps(coarse)), tire_footprint(coarse.resample(0.05)),
    ]  # fmt: skip
    assert [road.measured_step for road in made] == [pytest.approx(5.0)] * len(made)
    assert fine.resample(2.0).measured_step == 2.0
    assert pickle.loads(pickle.dumps(coarse)) == coarse
    assert hash(coarse.resample(5.0)) == hash(coarse)


@pytest.mark.parametrize("every", [0.5, 1.0, 2.13, 5.0])
@pytest.mark.parametrize("fill", [0.05, 0.1, 0.25])
def test_a_road_interpolated_elsewhere_is_known_by_its_straight_pieces(fine, every, fill):
    """On a grade, from anywhere between the stations."""
    x = np.arange(-199.93, 99.0, fill)
    coarse = sampled(fine, every)
    road = RoadProfile(x, np.interp(x, coarse.x, coarse.elevation) + 0.02 * x + 580)
    assert road.measured_step == pytest.approx(every, abs=fill)


def level(*events):
    return add_events(RoadProfile([-200, 25], [0, 0]), *events)


DRAWN = {
    "unit ramp": RoadProfile([-200, 3.0, 3.1, 25], [0, 0, -0.001, -0.001]),
    "grade": RoadProfile([-200, 25], [0, 4.5]),
    "even grade": RoadProfile(-200 + 5.0 * np.arange(46), 0.02 * np.arange(46)),
    "the paper's": bc.li2006.fig7_road(),
    "joints": level(*(step(5.0 * i, 0.005) for i in range(-38, 4))),
    "bumps": level(*(bump(5.0 * i, 1.0, 0.02) for i in range(-38, 4))),
    "plank": level(plank(-5.0, 0.3, 0.03)),
    "pothole": level(bump(-5.0, 0.6, -0.05)),
    "ramp": level(ramp(-20.0, 15.0, 0.04)),
    "settlement": level(settlement(10.0, 0.03)),
    "random ramps": rough_road(1, -20, 25, 1.0),
    "events on a measured road": add_events(bc.utia_road(), bump(600.0, 1.0, 0.03)),
}


@pytest.mark.parametrize("drawn", DRAWN.values(), ids=DRAWN)
def test_shapes_that_are_meant_to_be_straight_are_not_coarse(drawn):
    assert drawn.measured_step <= COARSE
    assert drawn.resample(0.1).measured_step <= COARSE


def test_fine_roads_of_every_kind_are_not_coarse(fine):
    """Potholes, smooth waves, slabs that curl, elevations in whole centimetres."""
    road = bc.utia_road()
    for height in (0.02, 0.05, 0.1):
        holes = [bump(490.0 + 25 * i, 1.0, -height) for i in range(20)]
        holed = add_events(road, *holes).resample(0.25)
        assert RoadProfile(holed.x, holed.elevation).measured_step == pytest.approx(0.25)
    x = 0.05 * np.arange(6000)
    for amplitude, wave in ((1e-3, 10), (1e-2, 20)):
        assert RoadProfile(x, amplitude * np.sin(2 * np.pi * x / wave)).measured_step <= 0.1
    curled = 0.01 * ((x / 4.5) % 1 - 0.5) ** 2
    for z in (curled, curled.round(5), 2e-3 * np.abs(np.sin(np.pi * x / 5))):
        assert RoadProfile(x, z).measured_step <= 0.1
    for digits in (2, 3, 4):
        assert RoadProfile(fine.x, fine.elevation.round(digits)).measured_step < 0.1


def test_random_roads_at_a_coarse_step_are_coarse(surface):
    road = bc.iso8608_profile("A", 40, step=1.0, seed=1, start=-10)
    with pytest.warns(UserWarning, match="measured every 1 m, too coarsely for dynamic ampl"):
        surface.dae(road)


def test_ramps_of_a_surface_are_as_fine_as_it_counts(bridge, truck):
    """A surface of 1.5 m ramps asks for no finer road, and its own road is meant to be so."""
    long_ramps = bc.ramp_surface(bridge, truck, 25.0, approach=75, ramp_length=1.5)
    road = bc.iso8608_profile("A", 102, step=1.5, seed=1, start=-75)
    long_ramps.dae(road)
    bc.daf(bridge, truck, 25.0, long_ramps.road(np.zeros(67)), start=-75)
    with pytest.warns(UserWarning, match="measured every 2 m, .* which needs 1.5 m or less"):
        long_ramps.dae(bc.iso8608_profile("A", 102, step=2.0, seed=1, start=-75))


def test_the_line_of_a_coarse_road_goes_through_what_was_measured(fine):
    """Waves that interpolation made are left out; a band without them draws no warning."""
    coarse = sampled(fine, 1.0)
    band = (0.011, 0.5)
    line, filled = coarse.psd().fit(band=band), coarse.resample(0.1).psd().fit(band=band)
    assert filled.roughness == pytest.approx(line.roughness, rel=0.3)  # straight lines are blunt
    with pytest.warns(UserWarning, match="measured every 1 m, too coarsely for the line of ISO"):
        assert coarse.resample(0.1).psd().fit() == coarse.resample(0.1).psd().fit(band=band)


@pytest.mark.parametrize("segment", [1e-3, 0.9])
def test_a_segment_too_short_to_mean_anything_is_refused(segment):
    with pytest.raises(ValueError, match=rf"segment = {segment} m is too short .*type 20 m or mo"):
        bc.utia_road().iri(segment)
    with pytest.raises(ValueError, match=r"window = 0.5 m is too short for an IRI at steps of 0.2"):
        bc.utia_road().running_iri(0.5)


def test_a_segment_shorter_than_a_step_is_refused(fine):
    with pytest.raises(ValueError, match="segment = 3 m is too short for an IRI at steps of 5 m"):
        sampled(fine, 5.0).iri(3)


def test_a_long_road_lists_some_segments_and_counts_the_rest(capsys, tmp_path):
    path = tmp_path / "long.csv"
    z = iso8608_elevations(1, "A", 6000, 0.25, seed=1)[0]
    write(path, RoadProfile(0.25 * np.arange(z.size), z), "{:.2f},{:.4f}".format)
    status, out, err = run_command(
        capsys, "profile", path, "--units", "m,mm", "--segment", "20", "--full"
    )
    assert (status, err) == (0, "")
    assert "\n... and 100 more; --json has all\n" in out
    assert len(out.splitlines()) < 225
    track, _ = measured(capsys, path, "--segment", "20")
    assert len(track["segment_iri_m_per_km"]) == 300


def test_the_figure_of_a_coarse_road_names_no_class(fine):
    with pytest.warns(UserWarning, match="too coarsely for an IRI"):
        figure = sampled(fine, 2.0).plot_roughness()
    below, spectra = figure.axes[1].get_legend(), figure.axes[2].get_legend()
    assert below.get_texts()[0].get_text().endswith("m/km (coarse)")
    assert [text.get_text() for text in spectra.get_texts()] == ["road: too coarse for a class"]


@pytest.mark.parametrize(
    ("unit", "every"), [("m", "0.001"), ("mm", "0.5"), ("ft", "0.003280839"), ("ft", "16.4042")]
)
def test_profiler_files_of_a_millimetre_and_of_five_metres_are_read(tmp_path, unit, every):
    """Their step in another unit is one or five only to some digits."""
    path = tmp_path / "texture.erd"
    path.write_text(
        f"ERDFILEV2.00\n1,6,-1,1,5,{every},-1,\nUNITSNAMmm\nXUNITS  {unit}\nEND\n" + "0\n1\n" * 3,
        encoding="utf-8",
    )
    road = read_profile(path)
    assert road.x[1] == pytest.approx(float(every) * {"m": 1, "mm": 1e-3, "ft": FOOT}[unit])


@pytest.mark.parametrize("every", [1e-4, 0.25e-3, 5.1, 250])
def test_steps_of_no_road_are_refused_and_readings_too_close_may_be_averaged(tmp_path, every):
    path = tmp_path / "road.csv"
    path.write_text("\n".join(f"{i * every},0" for i in range(6)), encoding="utf-8")
    with pytest.raises(bc.ProfileFileError, match=r"expected 0\.001 m to 5 m") as refused:
        read_profile(path, units="m,mm")
    assert ("average readings that are so close" in str(refused.value)) == (every < 1)
