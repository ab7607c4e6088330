"""What strategies gain, or do harm, when something is wrong: `bridgectl.robustness`."""

import dataclasses
import json
import pickle

import numpy as np
import pytest
from helpers import run_command
from joblib.externals.loky.backend.reduction import dumps

import bridgectl as bc
from bridgectl.dampers import (
    Damper,
    Sensors,
    Strategy,
    bridgehook,
    clipped_lqr,
    measured,
    passive,
    preset,
    rollout_hook,
    simulate_loop,
    skyhook,
)
from bridgectl.scoring import robust
from bridgectl.scoring.agreement import paired
from bridgectl.scoring.changes import Robustness
from bridgectl.scoring.errors import ERRORS, KINDS, Error, applies, errors_of, true_crossing

BEAM, TRUCK = bc.li2006.beam(9, n_modes=1), bc.li2006.car()
ROADS = [
    bc.iso8608_profile(each, 11.0, seed=i, start=-2.0) for each in "AC" for i in range(3)
]  # class C, since class B's short roads may be rough enough, or smooth enough, for another
SPEEDS = np.array([120.0, 100.0]) / 3.6
HOOK = bridgehook(BEAM, TRUCK, 1e3, 30e3)
LQR = clipped_lqr(TRUCK, 1e3, 30e3)
SKY = skyhook(1e3, 30e3)
COARSE = 8e-3  # sample time [s]
OWN = Damper(passive(7e3))
STUDY = [passive(7e3), *(Damper(law, sample_time=COARSE) for law in (HOOK, SKY))]


def study(dampers=STUDY, roads=ROADS, vehicle=TRUCK, beam=BEAM, **options):
    given = {"approach": 2.0, "workers": 1} | options
    return bc.robustness(dampers, beam, vehicle, roads, SPEEDS, **given)


def dafs(damper, beam=BEAM, truck=TRUCK):
    """DAFs of all roads, simulated directly: (roads, speeds)."""
    if not isinstance(damper, Damper):
        damper = Damper(damper, sample_time=COARSE)
    x = np.round(-2 + 0.1 * np.arange(111), 9)
    z = [np.interp(x, road.x, road.elevation) for road in ROADS]
    z = [each - each[0] for each in z]
    return simulate_loop(beam, truck, damper, SPEEDS, x, z).daf.T


@pytest.fixture(scope="module")
def found():
    return study()


def changes(found, strategy, error):
    j = [str(each) for each in found.errors].index(error)
    i = found.strategies.index(strategy)
    return found.daf[i, j] - found.baseline_daf[j]


# What is simulated


def test_with_nothing_wrong_it_is_what_simulation_has(found):
    expected = dafs(HOOK) - dafs(OWN)
    assert changes(found, "bridgehook", "nothing wrong") == pytest.approx(expected, abs=1e-9)


def test_the_bridge_is_another_one_than_the_law_was_made_for_and_so_is_it_for_the_baseline(found):
    """A fifth more frequency, by the rigidity; 3 % more damping."""
    stiff = dataclasses.replace(BEAM, flexural_rigidity=1.2**2 * BEAM.flexural_rigidity)
    assert stiff.frequencies == pytest.approx(1.2 * BEAM.frequencies, abs=1e-9)  # [Hz]
    damped = dataclasses.replace(BEAM, damping_ratio=0.03)
    for beam, error in ((stiff, "bridge frequency +20 %"), (damped, "bridge damping +3 %")):
        expected = dafs(HOOK, beam) - dafs(OWN, beam)
        assert changes(found, "bridgehook", error) == pytest.approx(expected, abs=1e-9)


def test_the_load_is_another_one(found):
    empty = dataclasses.replace(TRUCK, sprung_mass=0.8 * TRUCK.sprung_mass)
    expected = dafs(HOOK, truck=empty) - dafs(OWN, truck=empty)
    assert changes(found, "bridgehook", "load -20 %") == pytest.approx(expected, abs=1e-9)


@pytest.mark.parametrize(
    ("error", "fields"),
    [
        ("speed told -10 %", {"speed_error": -0.1}),
        ("position +1 m", {"position_error": 1.0}),
        ("position drift -3 %", {"position_drift": -0.03}),
        ("lag 20 ms", {"lag": 0.02}),
        ("sample time 10 ms", {"sample_time": 0.01}),
    ],
)
def test_the_damper_has_the_error(found, error, fields):
    expected = dafs(Damper(HOOK, **({"sample_time": COARSE} | fields))) - dafs(OWN)
    assert changes(found, "bridgehook", error) == pytest.approx(expected, abs=1e-6)


def test_noise_is_a_share_of_what_the_roads_of_a_class_make_of_the_suspension(found):
    x = np.round(-2 + 0.1 * np.arange(111), 9)
    own = np.array([class_ == "C" for class_ in found.road_classes])
    z = [np.interp(x, road.x, road.elevation) for road in ROADS]
    ran = simulate_loop(BEAM, TRUCK, passive(7e3), SPEEDS, x, np.array(z)[own],
                        record=["suspension_velocity"])  # fmt: skip
    squares = [np.mean(each["suspension_velocity"] ** 2) for each in ran.histories]
    noise = 0.2 * np.sqrt(np.mean(squares))  # [m/s]
    expected = (dafs(Damper(SKY, COARSE, velocity_noise=noise)) - dafs(OWN))[own]
    assert changes(found, "skyhook", "velocity noise 20 %")[own] == pytest.approx(
        expected, abs=1e-9
    )


def test_all_at_once_has_every_error(found):
    stiff = dataclasses.replace(BEAM, flexural_rigidity=1.1**2 * BEAM.flexural_rigidity)
    x = next(each for each in ERRORS if each.name == "bridge +10 %, -1 m")
    assert (x.frequency, x.noise) == (pytest.approx(1.1), 0.05)
    assert x.damper == {"lag": 0.01, "sample_time": 2e-3, "position_error": -1.0}
    quiet = Damper(HOOK, **x.damper)
    near = dafs(quiet, stiff) - dafs(OWN, stiff)
    noisy = changes(found, "bridgehook", str(x))
    assert 0 < np.abs(noisy - near).max() < 0.05


def test_filters_stand_for_ideal_velocities_where_they_tell_what_a_strategy_needs(found):
    damper = Damper(
        measured(HOOK, Sensors.accelerometers()),
        COARSE,
        acceleration_noise=0.05,
        travel_noise=0.5e-3,
    )
    expected = dafs(damper) - dafs(OWN)
    told = changes(found, "bridgehook", "filter: accelerometers")
    assert told == pytest.approx(expected, abs=1e-9)
    of_lqr = study([passive(7e3), LQR], ROADS[:1], errors=["filter"])
    assert np.isnan(changes(of_lqr, "clipped LQR", "filter: accelerometers")).all()
    assert np.isfinite(changes(of_lqr, "clipped LQR", "filter: Kalman filter")).all()
    assert f"{'-':>10}" in str(of_lqr)
    assert '"mean": null' in of_lqr.to_json()


def test_errors_that_do_not_matter_to_a_strategy_change_nothing(found):
    right = changes(found, "skyhook", "nothing wrong")
    for error in ("position +3 m", "speed told +10 %", "position drift +1 %"):
        assert np.array_equal(changes(found, "skyhook", error), right)
    assert not np.array_equal(changes(found, "skyhook", "lag 50 ms"), right)


def test_what_is_the_same_is_simulated_once(monkeypatch):
    done = []

    def part(case, speeds, stations, elevations):
        done.append(case.devices.name)
        return {"daf": np.ones((len(elevations), len(speeds)))}

    monkeypatch.setattr(robust, "_part", part)
    study([passive(7e3), preset(1e3, 30e3), SKY], errors=["position", "lag", "sample time"])
    assert done.count("passive 7 kN s/m") == done.count("preset") == 1
    assert done.count("skyhook") == 1 + 4 + 3  # 2 ms are the usual sample time


def test_what_is_not_told_of_a_bridge_or_truck_is_not_tried():
    modal = bc.ModalBridge([0, 3, 6, 9], [[0.0], [1.0], [1.0], [0.0]], [9.0], 8e4)
    tried = [
        each.kind for each in ERRORS if applies(each, bc.Crossing(modal, TRUCK, bc.Deflection()))
    ]
    assert {"position", "load"} <= set(tried)
    assert not {"bridge frequency", "bridge damping", "all at once"} & set(tried)
    whole = [each for each in ERRORS if applies(each, bc.Crossing(BEAM, TRUCK.linear))]
    assert [each.name for each in whole if each.kind == "filter"] == [
        "accelerometers", "complementary filter",
    ]  # fmt: skip
    assert "load" not in {each.kind for each in whole}


@pytest.mark.parametrize(
    ("rigidity", "damping"),
    [(4e10, 0.01), ([4e10, 6e10], (0.01, 0.02)), ([(30, 4e10), (20, 6e10)], {1: 0.01, 2: 0.02})],
)
def test_every_way_to_tell_of_a_bridge_is_changed_alike(rigidity, damping):
    bridge = bc.Bridge([25, 25], 18e3, rigidity, n_modes=2, damping_ratio=damping)
    error = Error("bridge", frequency=1.1, bridge_damping=0.02)
    true = true_crossing(bc.Crossing(bridge, TRUCK), error).beam
    assert true.frequencies == pytest.approx(1.1 * bridge.frequencies, abs=1e-9)  # [Hz]
    more = true.damping_ratios - bridge.damping_ratios
    assert more == pytest.approx(0.02, abs=1e-9)


@pytest.mark.slow
def test_a_truck_of_several_legs_has_the_errors_at_each():
    truck = bc.trucks.load("T2")
    law = Strategy("placed", lambda s, g: 1e3 * (s.position + 3), 2e3, 30e3)
    own = float(truck.damper_dampings.mean())
    found = study([passive(own), [law, passive(own)]], ROADS[:2], truck,
                  errors=["position", "sample time"])  # fmt: skip
    name = found.strategies[0]
    lost = changes(found, name, "position +3 m") - changes(found, name, "nothing wrong")
    assert np.abs(lost).max() > 1e-4
    assert np.isfinite(changes(found, name, "sample time 10 ms")).all()


@pytest.mark.parametrize("make", [rollout_hook, bridgehook])
def test_strategies_at_work_go_to_other_processes(make):
    """Also those whose law has expressions of its own, and behind sensors."""
    law = make(BEAM, TRUCK, 1e3, 30e3)
    signals = {"position": [2.0, 4.0], "suspension_velocity": 0.1, "tire_force": 9e4}
    for each in (law, measured(law, Sensors.kalman(TRUCK))):
        expected = each.command(speed=25.0, **{} if each is not law else signals)
        again = pickle.loads(dumps(each))
        found = again.command(speed=25.0, **{} if each is not law else signals)
        assert np.array_equal(found, expected)


# What is told


def test_changes_are_paired_over_roads_and_harm_is_told_as_plainly_as_gain():
    errors = (ERRORS[0], *[each for each in ERRORS if each.kind == "position"][:2])
    own = np.array([[-0.05, -0.06, -0.07], [0.02, 0.03, 0.04], [0.03, -0.02, 0.0]])
    daf = np.stack([own - 0.01, own + 0.01], axis=2)
    told = Robustness(
        "passive", ("hook",), errors, ("a", "b", "c"), ("A",) * 3, SPEEDS, np.ones(daf.shape),
        1 + daf[np.newaxis], BEAM, TRUCK, 2.0,
    )  # fmt: skip
    for error, values in zip(errors, own, strict=True):
        assert told.change("hook", str(error)) == pytest.approx(paired(values), abs=1e-12)
    assert told.change("hook", "position").mean == pytest.approx(own[1:].mean(), abs=1e-12)
    faster = told.change("hook", speed=121 / 3.6)
    assert faster.mean == pytest.approx(own[0].mean() - 0.01, abs=1e-12)
    rows = told.rows()
    assert [row.harmful for row in rows] == [False, True, False]
    assert rows[1].worst.mean == pytest.approx(0.04, abs=1e-12)
    assert rows[1].worst_speed == SPEEDS[1]
    text = str(told)
    assert "-0.060 ±0.025 " in text
    assert "+0.030 ±0.025!" in text
    assert "+0.003 ±0.063?" in text
    assert "1 of 2" in text


def test_everything_is_in_text_json_and_table(found):
    text, content = str(found), json.loads(found.to_json())
    for error in map(str, found.errors):
        assert error.split(",")[0] in text
    first = content["changes"][0]
    assert (first["strategy"], first["error"], first["road_class"]) == (
        "bridgehook", "nothing wrong", found.classes[0],
    )  # fmt: skip
    of_speeds = [each["mean"] for each in first["daf_change_by_speed"]]
    assert np.mean(of_speeds) == pytest.approx(first["daf_change"]["mean"], abs=1e-12)
    table = found.to_pandas()
    assert len(table) == found.daf.size
    assert np.array_equal(table["daf"].to_numpy().reshape(found.daf.shape), found.daf)
    of_sky = table.loc["skyhook"]
    assert of_sky["baseline_daf"].to_numpy() == pytest.approx(found.baseline_daf.ravel(), abs=0)
    assert of_sky.index[-1][0] == str(found.errors[-1])


def test_one_road_has_no_interval_and_one_strategy_is_one():
    told = study([passive(7e3), SKY], ROADS[:1], errors=["lag"])
    assert repr(told) == "Robustness(1 strategy, 5 errors, 1 road, 2 speeds from 100 to 120 km/h)"
    assert np.isnan(told.change("skyhook").low)
    assert "±" not in str(told).split("Change of the mean")[0]


@pytest.mark.slow
def test_the_figure_draws_every_change_above_and_below_a_zero_line(found):
    figure = found.plot()
    panels = [ax for ax in figure.axes if ax.get_visible()]
    assert len(panels) == len(KINDS) * len(found.classes)
    assert {ax.get_title("left") for ax in panels} == set(KINDS)
    lag = panels[KINDS.index("lag")]
    assert lag.get_xlabel() == "lag [ms]"
    drawn = lag.containers[0].lines[0].get_xydata()
    expected = [(0, "nothing wrong"), *((t, f"lag {t} ms") for t in (5, 10, 20, 50))]
    for (x, y), (size, error) in zip(drawn, expected, strict=True):
        assert x == size
        assert y == pytest.approx(found.change("bridgehook", error, found.classes[0]).mean)
    for ax in panels:
        assert any(np.ptp(line.get_ydata()) == 0 for line in ax.lines)  # zero
        shade = ax.patches[0].get_bbox()
        assert shade.y0 == 0
        assert shade.y1 >= max(ax.get_ylim()[1] - 1e-9, 0.005)
    figure.savefig("/dev/null", format="png")


# Work that goes on, and arguments


@pytest.mark.slow
def test_what_a_file_has_is_not_done_again(tmp_path, monkeypatch):
    file = tmp_path / "robust.jsonl"
    part, done = robust._part, []

    def stops(case, *others):
        if len(done) == 3:
            raise KeyboardInterrupt
        done.append(case)
        return part(case, *others)

    asked = {"dampers": [passive(7e3), SKY], "errors": ["lag"]}
    monkeypatch.setattr(robust, "_part", stops)
    with pytest.raises(KeyboardInterrupt):
        study(resume=file, **asked)
    assert len(file.read_text(encoding="utf-8").splitlines()) == 1 + 3
    done.append(None)  # from now on it stops no more
    again = study(resume=file, **asked)
    assert len(done) == 4 + 3
    monkeypatch.undo()
    assert np.array_equal(again.daf, study(**asked).daf)


@pytest.mark.parametrize(
    ("options", "error", "text"),
    [
        ({"dampers": [passive(7e3)]}, ValueError, "dampers must hold a strategy beside the first"),
        ({"errors": ["noise"]}, ValueError, "errors must be one of 'bridge frequency', "),
        ({"errors": "lag"}, TypeError, r"errors must be a list of kinds, got 'lag': type \['lag'"),
        ({"resume": 3}, TypeError, "resume must name a file, got int"),
        ({"workers": 0}, ValueError, "workers must be"),
        ({"progress": 1}, TypeError, "progress must be True or False"),
    ],
)
def test_what_cannot_be_meant_is_an_error(options, error, text):
    with pytest.raises(error, match=text):
        study(**options)


@pytest.mark.parametrize(
    ("asked", "text"),
    [
        ({"strategy": "hook"}, "strategy must be one of"),
        ({"error": "lag 7 ms"}, "error must be one of"),
        ({"road_class": "H"}, "road_class must be one of"),
        ({"speed": -1.0}, "speed must be above 0"),
    ],
)
def test_changes_that_were_not_tried_are_an_error(found, asked, text):
    with pytest.raises(ValueError, match=text):
        found.change(**({"strategy": "skyhook"} | asked))


def test_kinds_are_in_the_order_of_the_study():
    assert [each.kind for each in errors_of(["lag", "load"])] == (
        ["nothing"] + 2 * ["load"] + 4 * ["lag"]
    )


# The command

QUICK = ["--robust", "--approach", "2", "--speeds", "80", "--workers", "1", "--span", "9",
         "--modes", "1", "--random", "2", "--errors", "position,load"]  # fmt: skip


def test_the_command_prints_tables_and_draws(capsys, tmp_path):
    names = "simple bridgehook,skyhook"
    file = tmp_path / "robust.png"
    status, out, err = run_command(
        capsys, "score", *QUICK, "--strategies", names, "--plot", file
    )  # fmt: skip
    assert (status, err) == (0, "")
    assert "simple bridgehook" in out
    assert "position -0.3 m" in out
    assert file.stat().st_size > 10_000


def test_the_command_has_strategies_of_its_own_and_json(capsys, monkeypatch):
    seen = {}

    whole = bc.robustness

    def robustness(dampers, *case, **options):
        seen.update(names=[damper.strategy.name for damper in dampers], roads=case[2], **options)
        small = ROADS[:1], SPEEDS[:1]
        return whole([passive(7e3), SKY], BEAM, TRUCK, *small, errors=["load"], approach=2.0,
                     workers=1)  # fmt: skip

    monkeypatch.setattr(bc, "robustness", robustness)
    status, out, _ = run_command(capsys, "score", "--robust", "--lag", "0.005", "--json")
    assert status == 0
    assert json.loads(out)["effect"]["at_m"] == 12.5
    assert seen["names"] == [
        "passive 7 kN s/m", "skyhook", "continuous skyhook", "groundhook", "hybrid", "clipped LQR",
        "bridgehook", "careful bridgehook", "simple bridgehook",
    ]  # fmt: skip
    assert seen["errors"] is None
    assert len(seen["roads"]) == 1 + 2 * 20


@pytest.mark.parametrize(
    ("options", "text"),
    [
        (["--errors", "lag"], "--errors goes with --robust"),
        (["--robust", "--errors", "lag,noise"], "--errors must be one of"),
        (["--robust", "--departure", "5"], "leave --departure out"),
        (["--strategies", "careful bridgehook"], "there is no 'careful bridgehook'"),
    ],
)
def test_the_command_tells_mistakes_in_one_line(capsys, options, text):
    status, out, err = run_command(capsys, "score", *options)
    assert (status, out) == (2, "")
    assert text in err
    assert err.count("\n") == 1
