"""Laws that measure at other legs of a vehicle: what they are told, in every route."""

from __future__ import annotations

import casadi as ca
import control as ct
import numpy as np
import pytest
from test_whole_vehicles import compare_law, five_axles, half_car

import bridgectl as bc
from bridgectl.dampers import SIGNALS, Damper, Sensors, Strategy, measured, passive, simulate_loop

SOFT, STIFF = 1e3, 30e3


def against_pitch(s, g):
    """A damping by the pitch rate, and by how much harder the second tire presses."""
    pitch = s.body_velocity_2 - s.body_velocity_1
    harder = (s.tire_force_2 - s.tire_force) * 1e-5 + s.tire_force_rate_1 * 1e-7
    still = ca.fabs(s.suspension_velocity) < 1e-4
    wanted = 60e3 * pitch * ca.sign(s.suspension_velocity) + 5e3 * harder + s.position_2
    return ca.if_else(still, g.c_min, 8e3 + wanted)


PITCH = Strategy("against pitch", against_pitch, SOFT, STIFF)


@pytest.fixture
def vehicle():
    return half_car(np.random.default_rng(10), 3e4)


@pytest.fixture
def road():
    return bc.iso8608_profile("A", 45, seed=1, start=-20)


@pytest.mark.parametrize(("truck", "seed"), [(half_car, 3), (five_axles, 1)])
@pytest.mark.slow
def test_a_law_of_other_legs_is_its_fine_integration(truck, seed):
    """With lags and force limits, and lift-off of the first: DAF within 2e-5."""
    found, fine, lift_off = compare_law(seed, truck, PITCH)
    assert found.daf[0, 0] == pytest.approx(fine.peak, abs=2e-5)
    assert (found.least_force[0, 0] == 0) == (fine.least == 0) == lift_off


@pytest.mark.quick_cases(1)
@pytest.mark.parametrize("signal", SIGNALS)
def test_a_legs_own_signal_by_its_name_or_number_is_its_own(bridge, vehicle, road, signal):
    """With noise of each sensor, which is the same whoever listens."""
    size = {"position": 5.0, "speed": 25.0, "tire_force": 1e5, "tire_force_rate": 1e6}
    size |= {"body_acceleration": 1.0, "axle_acceleration": 30.0}

    def law(name):
        return Strategy(
            "one", lambda s, g: 8e3 + 5e3 * ca.sin(getattr(s, name) / size.get(signal, 0.1)),
            SOFT, STIFF,
        )  # fmt: skip

    noise = {"velocity_noise": 1e-3, "acceleration_noise": 0.1, "position_deviation": 0.5}
    noise["sample_time"] = 8e-3
    found = [
        bc.daf(bridge, vehicle, 25.0, road, start=-20, damper={"rear": Damper(law(name), **noise)})
        for name in (signal, f"{signal}_rear", f"{signal}_2")
    ]
    assert found[0] == pytest.approx(found[1], abs=1e-9)
    assert np.array_equal(found[1], found[2])
    other = {"rear": Damper(law(f"{signal}_front"), **noise)}
    front = bc.daf(bridge, vehicle, 25.0, road, start=-20, damper=other)
    assert (front == found[1]) == (signal == "speed")


def test_a_law_hears_what_the_sensors_of_the_other_leg_tell(bridge, vehicle, road):
    """The law in front is soft or stiff by the rear's sign: what the rear's own law would see."""

    def switch(name):
        return Strategy(
            "switch", lambda s, g: ca.if_else(getattr(s, name) > 0, g.c_max, g.c_min), SOFT, STIFF
        )

    each = [
        Damper(switch(name), velocity_noise=0.01)
        for name in ("axle_velocity_rear", "axle_velocity")
    ]
    found = simulate_loop(
        bridge, vehicle, each, 25.0, road.x, road.elevation, record=["damping", "axle_velocity"]
    ).histories[0]
    front, rear = found["damping"]
    assert np.array_equal(front, rear)
    assert np.array_equal(rear > 1.5e4, found["axle_velocity"][1] > 0)


@pytest.mark.slow
def test_a_passive_leg_is_measured_too(bridge, vehicle, road):
    """Only the front has a damper of its own: as with the rear's passive one in the loop."""
    own = Damper(passive(vehicle.damper_dampings[1]), max_force=1e9)
    given = {"front": PITCH}, [PITCH, None], [PITCH, own]
    found = [bc.daf(bridge, vehicle, 25.0, road, start=-20, damper=each) for each in given]
    assert np.array_equal(found[0], found[1])
    assert found[0] == pytest.approx(found[2], abs=1e-12)
    mixed = bc.daf(bridge, vehicle, 25.0, road, start=-20, damper=[PITCH, passive(2e4)])
    assert mixed[0] != found[0][0]
    board = bc.score(
        [passive(9e3), {"front": PITCH}], bridge, vehicle, [road], 25.0, approach=20, workers=1,
        progress=False,
    )  # fmt: skip
    assert board.values["daf"][1, 0, 0] == pytest.approx(found[0][0], abs=1e-6)


@pytest.mark.slow
def test_late_signals_of_another_leg_are_late(bridge, vehicle, road):
    """By two samples, as with the state that a law of its own keeps of them."""
    plain = Strategy("plain", lambda s, g: 8e3 + 50e3 * s.body_velocity_2, SOFT, STIFF)
    late = Strategy(
        "late", lambda s, g: 8e3 + 50e3 * s.old, SOFT, STIFF, states={"old": 0.0, "last": 0.0},
        update=lambda s, g: {"old": s.last, "last": s.body_velocity_rear},
    )  # fmt: skip
    assert late.signals == (*SIGNALS, "body_velocity_rear")
    delayed = measured(plain, delays={"body_velocity_2": 2})
    want, found, at_once = (
        bc.daf(bridge, vehicle, 25.0, road, start=-20, damper=law) for law in (late, delayed, plain)
    )
    assert found == pytest.approx(want, abs=1e-12)
    assert found != pytest.approx(at_once, abs=1e-6)
    with pytest.raises(ValueError, match="measures body_velocity_2, of which accelerometers tell"):
        measured(plain, Sensors.accelerometers())


@pytest.mark.slow
def test_blocks_of_laws_of_other_legs_are_the_loop(bridge, vehicle):
    """Interconnected with a crossing; the loop sampled 20 times as often: DAF within 2e-4."""
    law = Strategy(
        "pitch", lambda s, g: 8e3 + 60e3 * (s.body_velocity_1 - s.body_velocity_rear)
        + 0.1 * (s.tire_force_2 - s.tire_force_1) + 100 * s.position_front, SOFT, STIFF,
    )  # fmt: skip
    blocks = [law.system(25.0, vehicle=vehicle, leg=leg) for leg in (1, 2)]
    crossing = bc.crossing_system(bridge, vehicle.undamped, 25.0)
    loop = ct.interconnect(
        [crossing, *blocks], inputs=["road_1", "road_2"], outputs=["moment"], check_unused=False
    )
    times = np.linspace(0, (25 + vehicle.tire_offsets[1]) / 25, 1201)
    road = bc.RoadProfile([0, 5, 5.1, 30], [0, 0, -4e-3, -4e-3])
    drops = np.array([road.drop(25 * times - d, 0.0) for d in vehicle.tire_offsets])
    found = ct.input_output_response(
        loop, times, drops, solve_ivp_kwargs={"rtol": 1e-7, "atol": 1e-10, "max_step": 1e-3}
    )
    want = bc.daf(bridge, vehicle, 25.0, road, damper=Damper(law, sample_time=1e-4))[0]
    assert found.outputs.max() == pytest.approx(want, abs=2e-4)


def test_a_block_reads_every_signal_of_every_leg(vehicle):
    """From the outputs of a crossing with random values, by the rows of legs; a rate by its lag."""
    weights = {
        f"{name}_{leg}": 10.0 ** (-i - leg) for i, name in enumerate(SIGNALS) for leg in (1, 2)
    }
    law = Strategy(
        "all", lambda s, g: 8e3 + s.seen, SOFT, STIFF, states={"seen": 0.0},
        update=lambda s, g: {"seen": sum(w * getattr(s, key) for key, w in weights.items())},
    )  # fmt: skip
    block = law.system(25.0, vehicle=vehicle, leg=2, rate_time=1e-3, sample_time=2e-3)
    assert block.state_labels == ["lagged_tire_force_1", "lagged_tire_force_2", "seen"]
    u = dict(zip(block.input_labels, np.random.default_rng(0).normal(size=99), strict=False))
    x = np.array([1.0, 2.0, 3.0])
    of_time = block.updfcn(0.1, x, np.array([*u.values()]), {})
    rows = {"body": vehicle.damper_map + vehicle.damper_axles, "axle": vehicle.damper_axles}
    told = {"position": 2.5 - vehicle.tire_offsets, "speed": np.full(2, 25.0)}
    for end, matrix in rows.items():
        for dots, name in (("_dot", "velocity"), ("_ddot", "acceleration")):
            values = [u.get(f"{key}{dots}", np.nan) for key in vehicle.coordinates]
            told[f"{end}_{name}"] = matrix @ np.nan_to_num(values)
    for name in ("suspension_travel", "suspension_velocity", "tire_force"):
        told[name] = np.array([u[f"{name}_{leg}"] for leg in (1, 2)])
    told["tire_force_rate"] = (told["tire_force"] - x[:2]) / 1e-3
    seen = sum(w * told[key[:-2]][int(key[-1]) - 1] for key, w in weights.items())
    assert of_time == pytest.approx([*told["tire_force_rate"], (seen - 3.0) / 2e-3], rel=1e-9)


def test_what_a_vehicle_has_not_is_named(bridge, vehicle):
    law = Strategy("pitch", lambda s, g: 8e3 + s.body_velocity_middle, SOFT, STIFF)
    message = (
        "pitch measures 'body_velocity_middle', which the vehicle has not: its dampers are "
        "'front', 'rear'; type for example s.body_velocity_rear, or s.body_velocity"
    )
    with pytest.raises(ValueError, match=message):
        bc.daf(bridge, vehicle, 25.0, damper={"front": law})
    with pytest.raises(ValueError, match=message):
        law.system(25.0, vehicle=vehicle)
    third = Strategy("third", lambda s, g: 8e3 + s.body_velocity_3, SOFT, STIFF)
    with pytest.raises(ValueError, match="'body_velocity_3', which the vehicle has not"):
        bc.daf(bridge, vehicle, 25.0, damper=third)
    with pytest.raises(ValueError, match="its dampers are '1'"):
        bc.daf(bridge, bc.li2006.car(), 25.0, damper=third)
    with pytest.raises(ValueError, match="its dampers are '1'"):
        third.system(25.0)
    with pytest.raises(ValueError, match="of another leg of a vehicle for example"):
        Strategy("typo", lambda s, g: 8e3 + s.body_veloctiy_rear, SOFT, STIFF)
    with pytest.raises(ValueError, match="uses an unknown name"):
        Strategy("typo", lambda s, g: 8e3 + s.body_velocity_, SOFT, STIFF)


def test_a_law_of_other_legs_can_be_tried_and_written_as_c(tmp_path):
    law = Strategy("pitch", lambda s, g: 8e3 + 1e4 * s.body_velocity_2, SOFT, STIFF)
    assert law.command(body_velocity_2=[0.1, -0.1]).tolist() == [9e3, 7e3]
    assert law.used == ["body_velocity_2"]
    assert "damping(" in law.to_c(tmp_path / "pitch.c").read_text()


def test_a_law_that_measures_elsewhere_at_another_speed_is_refused(bridge, vehicle):
    class Turning(Strategy):
        def for_speed(self, speed):
            key = f"body_velocity_{1 + int(speed > 25)}"
            return Strategy("turning", lambda s, g: 8e3 + getattr(s, key), SOFT, STIFF)

    law = Turning("turning", lambda s, g: 8e3 + s.body_velocity_1, SOFT, STIFF)
    with pytest.raises(ValueError, match="measure at the same legs"):
        bc.daf(bridge, vehicle, [20.0, 30.0], damper=law)


@pytest.mark.slow
def test_scores_of_laws_that_differ_in_the_leg_alone_are_kept_apart(
    bridge, vehicle, road, tmp_path
):
    """A file of finished work tells them from each other."""
    found = []
    for leg in ("front", "rear"):
        law = Strategy(
            "leg", lambda s, g, n=leg: 8e3 + 5e4 * getattr(s, f"body_velocity_{n}"), SOFT, STIFF
        )
        board = bc.score(
            [law], bridge, vehicle, [road], 25.0, approach=2, workers=1, progress=False,
            resume=tmp_path / "work.jsonl",
        )  # fmt: skip
        found.append(board.values["daf"][0, 0, 0])
    assert found[0] != found[1]
