"""Random trucks: the same whoever draws them, from the distributions that were stated."""

import math
import pickle
import subprocess
import sys
import warnings

import numpy as np
import pytest
from scipy import stats

import bridgectl as bc
from bridgectl.fleet.distributions import distribution, key_of, uniforms
from bridgectl.fleet.kinds import Factor
from bridgectl.model.trucks.file import DATA

PINNED = [0.6839569953247681, 0.09922211827782179, 0.6159955134184457]
SPEED = {"mean": 23, "sd": 2, "min": 15, "max": 28}
MIXED = {
    "kinds": {"T2": 300, "T5air": 700}, "speed": SPEED, "load": {"min": 0.4, "max": 1.1},
    "suspension": {"median": 1, "log_sd": 0.2}, "tires": {"mean": 1, "sd": 0.1, "min": 0.7},
    "seed": 1,
}  # fmt: skip

RIGID = """
speed = {speed}
[[kinds]]
name = "two"
share = 1
[kinds.parameters]
body = {{ mean = 10e3, sd = 1e3, min = 8e3, max = 12e3 }}
spring = {{ median = 1e6, log_sd = 0.2, min = 5e5, max = 2e6 }}
place = {place}
[[kinds.bodies]]
mass = "body"
inertia = 5e4
[[kinds.bodies.axles]]
name = "front"
place = -2.5
mass = 700
suspension_stiffness = "spring"
damping = 1e4
tire_stiffness = 1.75e6
[[kinds.bodies.axles]]
place = "place"
mass = 1000
suspension_stiffness = "spring"
tire_stiffness = 3.5e6
"""


@pytest.fixture
def file(tmp_path):
    def write(text=RIGID, speed="20", place="2.5"):
        path = tmp_path / "fleet.toml"
        path.write_text(text.replace("{{", "{").replace("}}", "}")
            .replace("{speed}", speed).replace("{place}", place), encoding="utf-8")  # fmt: skip
        return path

    return write


def mixed(**changed):
    return bc.Fleet(**{**MIXED, **changed})


def told(passing):
    """All numbers of a truck that passes, to the bit."""
    vehicle, speed, kind, _ = passing
    parts = vehicle.mass_matrix, vehicle.stiffness_matrix, vehicle.tire_stiffnesses
    return kind, speed.hex(), b"".join(part.tobytes() for part in parts).hex()


def test_a_truck_is_the_same_in_any_order_and_beside_any_others():
    fleet, again = mixed(), mixed()
    forward = [told(fleet.passing(i)) for i in range(20)]
    backward = [told(again.passing(i)) for i in reversed(range(20))]
    assert forward == backward[::-1]
    assert told(mixed().passing(13)) == forward[13]
    assert len({*forward}) == 20


@pytest.mark.slow
def test_a_truck_is_the_same_in_another_process():
    fleet = mixed()
    program = (
        "import pickle, sys; fleet = pickle.load(sys.stdin.buffer); p = fleet.passing(7); "
        "print(p.kind, p.speed.hex(), p.vehicle.mass_matrix.tobytes().hex())"
    )
    found = subprocess.run(
        [sys.executable, "-c", program], input=pickle.dumps(fleet), capture_output=True, check=True
    )
    truck = fleet.passing(7)
    mine = f"{truck.kind} {truck.speed.hex()} {truck.vehicle.mass_matrix.tobytes().hex()}"
    assert found.stdout.decode().strip() == mine


def test_another_seed_makes_other_trucks():
    assert told(mixed(seed=2).passing(0)) != told(mixed(seed=1).passing(0))


def test_the_numbers_of_a_seed_are_those_that_they_always_were():
    """Studies of years ago can be repeated: Philox and its key are the same in every version."""
    assert uniforms(key_of(1), 5, 3) == PINNED


def test_the_numbers_of_all_trucks_are_uniform_and_independent():
    n = 4000
    drawn = np.array([uniforms(key_of(3), i, 2) for i in range(n)])
    assert 0 < drawn.min() < 0.001
    assert 0.999 < drawn.max() < 1
    for column in drawn.T:
        assert stats.kstest(column, "uniform").pvalue > 0.001
    # Correlations of independent numbers have a standard deviation of 1 / sqrt(n).
    pairs = (drawn[:-1, 0], drawn[1:, 0]), (drawn[:, 0], drawn[:, 1])
    assert all(abs(np.corrcoef(*pair)[0, 1]) < 4 / math.sqrt(n) for pair in pairs)


SHARES = (1e-12, 0.003, 0.3, 0.5, 0.8, 0.9999, 1 - 1e-12)


@pytest.mark.parametrize(
    ("low", "high"),
    [(-np.inf, np.inf), (10, 16), (-np.inf, 12), (16, 19), (25, np.inf), (-5, 2), (12.9, 13.1)],
)
def test_a_normal_distribution_is_cut_off_as_that_of_scipy(low, high):
    stated = {"mean": 13, "sd": 1.5}
    stated |= {"min": low} if np.isfinite(low) else {}
    stated |= {"max": high} if np.isfinite(high) else {}
    mine = distribution("speed", stated)
    theirs = stats.truncnorm((low - 13) / 1.5, (high - 13) / 1.5, 13, 1.5)
    for u in SHARES:
        assert mine.ppf(u) == pytest.approx(theirs.ppf(u), abs=1e-5 * 1.5), u  # tails: 12 digits
        assert low <= mine.ppf(u) <= high


def test_a_lognormal_distribution_is_that_of_scipy():
    whole = distribution("k", {"median": 3e5, "log_sd": 0.2})
    for u in SHARES[1:-1]:
        assert whole.ppf(u) == pytest.approx(stats.lognorm(0.2, scale=3e5).ppf(u), rel=1e-9)
    cut = distribution("k", {"median": 3e5, "log_sd": 0.2, "min": 2.5e5, "max": 4e5})
    below = stats.lognorm(0.2, scale=3e5).cdf
    share = (below(cut.ppf(0.3)) - below(2.5e5)) / (below(4e5) - below(2.5e5))
    assert share == pytest.approx(0.3, abs=1e-9)
    assert cut.ppf(1e-18) == 2.5e5
    assert cut.ppf(1 - 1e-16) == pytest.approx(4e5)


def test_a_uniform_distribution_and_a_number():
    made = distribution("speed", {"min": 10, "max": 16})
    assert [made.ppf(u) for u in (0, 0.25, 1)] == [10, 11.5, 16]
    assert distribution("speed", 22).ppf(0.7) == 22


def within(values, mean, sd, kurtosis=3.0, times=4.0):
    """Mean and standard deviation of a sample within four of their own standard deviations."""
    n = len(values)
    assert abs(np.mean(values) - mean) < times * sd / math.sqrt(n)
    assert abs(np.std(values) - sd) < times * sd * math.sqrt((kurtosis - 1) / (4 * n))


@pytest.mark.slow
def test_what_is_drawn_has_the_moments_that_were_stated():
    """Of 1500 trucks: each interval is four standard deviations, missed once in 16 000 seeds."""
    fleet = mixed(kinds={"T2": 3, "T5": 7})
    trucks = [fleet.passing(i) for i in range(1500)]
    speed = stats.truncnorm((15 - 23) / 2, (28 - 23) / 2, 23, 2)
    within([truck.speed for truck in trucks], speed.mean(), speed.std())
    share = np.mean([truck.kind == "T2" for truck in trucks])
    assert abs(share - 0.3) < 4 * math.sqrt(0.3 * 0.7 / 1500)
    plain = bc.trucks.load("T2")
    two = [truck.vehicle for truck in trucks if truck.kind == "T2"]
    load = [(each.mass - 2 * 900) / 10500 for each in two]
    within(load, 0.75, 0.7 / math.sqrt(12), kurtosis=1.8)
    springs = [math.log(each.stiffness_matrix[0, 0] / plain.stiffness_matrix[0, 0]) for each in two]
    within(springs, 0, 0.2)
    tires = stats.truncnorm(-3, np.inf, 1, 0.1)
    within([each.tire_stiffnesses[0] / 1.75e6 for each in two], tires.mean(), tires.std())
    assert 0.4 <= min(load) <= max(load) <= 1.1
    assert all(15 <= truck.speed <= 28 for truck in trucks)


@pytest.mark.parametrize("name", bc.trucks.catalog())
def test_trucks_without_factors_are_those_of_the_catalog(name):
    fleet = bc.Fleet({name: 1}, speed=20.0)
    assert fleet.passing(5).vehicle == bc.trucks.load(name).linear
    assert fleet.passing(5).speed == 20.0


def test_factors_change_load_springs_tires_and_dampers():
    def one(name, **factors):
        return bc.Fleet({name: 1}, speed=20.0, **factors).passing(0).vehicle

    plain = bc.trucks.load("T5tridem")
    assert one("T5tridem", load=0.5).mass == pytest.approx(plain.mass - 31450 / 2)
    assert one("T5tridem", load=0.5).mass_matrix[2, 2] == pytest.approx(
        plain.mass_matrix[2, 2] / 2  # pitch of the trailer
    )
    stiffer, harder = one("T5tridem", suspension=2.0), one("T5tridem", tires=1.5)
    assert stiffer.stiffness_matrix == pytest.approx(2 * plain.stiffness_matrix)
    assert harder.tire_stiffnesses == pytest.approx(1.5 * plain.tire_stiffnesses)
    assert np.array_equal(harder.tire_damping, plain.tire_damping)
    assert one("T5tridem", damping=3.0).damping_matrix == pytest.approx(3 * plain.damping_matrix)
    car = bc.li2006.car()
    assert one("li2006", load=0.9).mass == pytest.approx(0.9 * car.sprung_mass + car.unsprung_mass)


def test_a_load_of_its_own_in_a_file_is_times_the_factor_too(tmp_path):
    path = tmp_path / "loaded.toml"
    source = (DATA / "T2.toml").read_text(encoding="utf-8")
    path.write_text(source + "\n[[bodies.loads]]\nmass = 4000\nplace = 0.5\n", encoding="utf-8")
    fleet = bc.Fleet({str(path): 1}, speed=20.0, load=0.5)
    assert fleet.passing(0).vehicle.mass == pytest.approx(2 * 900 + (10500 + 4000) / 2)


def test_the_monte_carlo_fleet_has_its_printed_ranges():
    fleet = bc.Fleet.load("monte_carlo", seed=4)
    trucks = [fleet.passing(i) for i in range(600)]
    assert {truck.kind for truck in trucks} == {"two axles", "five axles"}
    five = [truck.vehicle for truck in trucks if truck.kind == "five axles"]
    two = [truck.vehicle for truck in trucks if truck.kind == "two axles"]
    assert all(each.n_tires == 5 for each in five)
    # One number for the axles at a place, the two of the tractor and the three of the trailer.
    stiffness = np.array([each.tire_stiffnesses for each in five])
    assert np.array_equal(stiffness[:, 0], stiffness[:, 1])
    assert np.array_equal(stiffness[:, 2], stiffness[:, 4])
    assert not np.array_equal(stiffness[:, 1], stiffness[:, 2])
    limits = stats.truncnorm(-2.5, 2.5, 1.75e6, 0.2e6)
    within(stiffness[:, 0], limits.mean(), limits.std())
    masses = np.array([each.mass for each in five])  # tractor, trailer, two and three axles
    within(masses, 3300 + 25000 + 2 * 600 + 3 * 1000, math.hypot(100, 4470, 160, 240))
    within([each.mass for each in two], 10500 + 2 * 750, math.hypot(20, 20))
    assert all(10 <= truck.speed <= 16 for truck in trucks)


def test_the_monte_carlo_speeds_can_be_replaced():
    assert bc.Fleet.load("monte_carlo", speed=22.0).passing(0).speed == 22.0


def test_a_file_states_any_number_of_a_truck(file):
    fleet = bc.Fleet.load(file(place="{min = 2.0, max = 3.0}"), seed=3)
    trucks = [fleet.passing(i).vehicle for i in range(50)]
    places = np.array([truck.tire_offsets[1] for truck in trucks])
    assert 4.5 <= places.min() < 4.6 < 5.4 < places.max() <= 5.5
    axles = [
        bc.trucks.Axle(-2.5, 700, 1e6, 1.75e6, damping=1e4, name="front"),
        bc.trucks.Axle(2.5, 1000, 1e6, 3.5e6),
    ]
    usual = fleet._source.kinds[0].usual
    made = bc.trucks.rigid(bc.trucks.Body(1e4, 5e4, axles))
    assert usual.stiffness_matrix == pytest.approx(made.stiffness_matrix, abs=1e-6)
    assert usual.static_loads == pytest.approx(made.static_loads, rel=1e-12)
    assert usual.damper_names == made.damper_names


def test_a_kind_has_its_own_speed_or_that_of_the_fleet(file):
    fleet = bc.Fleet.load(file(RIGID.replace("share = 1", "share = 1\nspeed = 25.0"), speed="20"))
    assert fleet.passing(0).speed == 25.0


def test_a_file_may_take_trucks_of_the_catalog(file):
    text = 'speed = 20\n[[kinds]]\nname = "air"\nshare = 1\ntruck = "T5air"\ndamping = 2.0\n'
    truck = bc.Fleet.load(file(text)).passing(3).vehicle
    assert truck.damping_matrix == pytest.approx(2 * bc.trucks.load("T5air").damping_matrix)


def test_distributions_of_scipy_do_as_well():
    gamma, again = (stats.gamma(50, scale=0.4) for _ in range(2))
    fleet = bc.Fleet({"T2": 1}, speed=gamma, seed=5)
    assert fleet.passing(2).speed == pytest.approx(gamma.ppf(uniforms(key_of(5), 2, 2)[1]))
    assert fleet == bc.Fleet({"T2": 1}, speed=again, seed=5)
    assert fleet != bc.Fleet({"T2": 1}, speed=stats.gamma(50, scale=0.5), seed=5)
    assert fleet != bc.Fleet({"T2": 1}, speed=20.0, seed=5)
    assert hash(fleet) == hash(bc.Fleet({"T2": 1}, speed=again, seed=5))
    assert hash(fleet._source.kinds[0].speed) == hash(distribution("speed", again))
    assert repr(fleet) == "Fleet(100 % T2, 0 to inf m/s, seed=5)"


def test_fleets_that_draw_the_same_are_equal():
    assert mixed() == mixed()
    assert hash(mixed()) == hash(mixed())
    assert mixed() != mixed(seed=2)
    assert mixed() != mixed(load=1.0)
    assert mixed() != mixed(kinds={"T5air": 700, "T2": 300})
    assert mixed() != mixed().part([0, 1])
    assert mixed().part([0, 1]) == mixed().part([0, 1])
    assert (mixed() == "fleet") is False
    assert distribution("speed", stats.norm(20, 1)).__eq__(3) is NotImplemented


def test_a_fleet_tells_what_it_is_in_one_line():
    assert repr(mixed()) == "Fleet(30 % T2, 70 % T5air, 15 to 28 m/s, seed=1)"
    assert repr(mixed().part(range(9))).startswith("Fleet(9 of 30 % T2")
    every = bc.Fleet(dict.fromkeys(bc.trucks.catalog(), 1), speed=20.0)
    assert ", 1 more, 20 to 20 m/s" in repr(every)


def test_a_part_has_the_trucks_of_the_whole():
    fleet = mixed()
    part = fleet.part([7, 3, 11])
    assert len(part) == 3
    assert [told(part.passing(j)) for j in range(3)] == [told(fleet.passing(i)) for i in (7, 3, 11)]
    assert told(part.part([1]).passing(0)) == told(fleet.passing(3))
    assert pickle.loads(pickle.dumps(part)) == part
    with pytest.raises(IndexError, match="i must be below 3, the number of trucks, got 3"):
        part.passing(3)


def test_a_fleet_is_small_when_it_is_sent():
    """Its kinds and no trucks: it is sent to every worker."""
    fleet = mixed()
    before = len(pickle.dumps(fleet))
    _ = [fleet.passing(i) for i in range(10)]
    assert len(pickle.dumps(fleet)) < before + 1000 < 10_000


def test_a_drawn_fleet_has_no_end_and_knows_no_times():
    fleet = mixed()
    assert fleet
    assert fleet.passing(10**12).speed > 0
    assert math.isnan(fleet.passing(0).time)
    assert math.isnan(fleet.per_day)
    assert math.isnan(fleet.duration)
    assert fleet.left_out == ()
    with pytest.raises(TypeError, match=r"no end: type fleet.part\(range\(1000\)\)"):
        len(fleet)


def test_what_no_truck_is_like_is_told_once_and_not_of_each_truck():
    with pytest.warns(bc.PlausibilityWarning, match=r"speed of 80 m/s .*type 80 / 3.6") as told:
        fleet = bc.Fleet({"T2": 1}, speed={"min": 70, "max": 90})
    assert [warning.filename for warning in told] == [__file__]
    with pytest.warns(bc.PlausibilityWarning, match="lowest frequency") as told:
        soft = bc.Fleet({"T2": 1}, speed=20.0, suspension=1e-5)
    assert len(told) == 1
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        fleet.passing(0)
        soft.passing(0)


def test_a_file_of_what_no_truck_is_like_is_told(file):
    with pytest.warns(bc.PlausibilityWarning, match=r"speed of 80 m/s .*type 80 / 3.6"):
        bc.Fleet.load(file(speed="80"))


@pytest.mark.parametrize(
    ("changed", "says"),
    [
        ({"kinds": ["T2"]}, r'kinds must be trucks with their shares.*type \{"T2": 0.3'),
        ({"kinds": {}}, "kinds must be trucks with their shares"),
        ({"kinds": {"T3": 1}}, "there is no truck 'T3': type one of T2,"),
        ({"kinds": {"T2": 0}}, r"kinds\['T2'\] must be above 0, got 0"),
        ({"kinds": {"T2": "a half"}}, r"kinds\['T2'\] must be one number"),
        ({"speed": "fast"}, r"speed must be a number or a distribution \[m/s\].*type 22.0, \{'min"),
        ({"speed": True}, "speed must be a number or a distribution"),
        ({"speed": {"mean": 22, "sd": 2}}, r"speed must be above 0 \[m/s\].*-inf .*type a min"),
        ({"speed": -20}, r"speed must be above 0 \[m/s\] whatever is drawn, got -20"),
        ({"speed": {"mean": 22}}, "speed must have mean and sd, or .*, got mean: type 22.0"),
        ({"speed": {}}, "speed must have mean and sd, or .*, got nothing"),
        ({"speed": {"min": 22}}, "speed must have mean and sd, or"),
        ({"speed": {"mean": 22, "std": 2}}, "speed has the key 'std': type some of mean, sd"),
        ({"speed": {"min": 25, "max": 20}}, "speed.min must be below speed.max, got 25 and 20"),
        ({"speed": {"mean": 22, "sd": 0, "min": 1}}, "speed.sd must be above 0"),
        ({"speed": {"mean": 9, "sd": 0.1, "min": 20}}, "speed.min and speed.max are too far"),
        ({"load": {"median": 1, "log_sd": 0.01, "min": 5}}, "load.min and load.max are too far"),
        ({"load": {"median": -1, "log_sd": 0.01}}, "load.median must be above 0"),
        ({"load": 0}, "load must be above 0 whatever is drawn, got 0"),
        ({"suspension": float("nan")}, "suspension must be finite"),
        ({"tires": stats.norm(1, 0.1)}, "tires must be above 0 whatever is drawn, got -inf"),
        ({"damping": None}, "damping must be a number or a distribution"),
        ({"seed": -1}, "seed must be 0 or more"),
        ({"seed": 1.5}, "seed must be a whole number"),
    ],
)
def test_a_wrong_argument_is_told_with_what_to_type(changed, says):
    with pytest.raises((TypeError, ValueError), match=says):
        mixed(**changed)


@pytest.mark.parametrize("changed", [{"speed": -5}, {"speed": "fast"}, {"seed": -1}])
def test_an_argument_beside_a_file_is_told_without_the_file(changed):
    with pytest.raises((TypeError, ValueError), match=rf"^{next(iter(changed))} must be "):
        bc.Fleet.load("monte_carlo", **changed)


TWICE = '[[kinds]]\nname = "two"\nshare = 1\ntruck = "T2"\n'


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("[[kinds]]", "[[kind]]", "has the key 'kind', which is none: type one of"),
        ('name = "two"\n', "", r"kinds\[0\] lacks name: type name ="),
        ("share = 1", "share = 0", r"kinds\[0\].share must be above 0"),
        ("share = 1", "shares = 1", r"kinds\[0\] has 'shares'"),
        ('mass = "body"', 'mass = "bodi"', r"kinds\[0\].bodies\[0\].mass = 'bodi' is no parameter"),
        ('mass = "body"', "mass = 1e4", r"kinds\[0\].body is used nowhere: type mass = \"body\""),
        ('mass = "body"', 'mass = "body"\nlength = 3', r"kinds\[0\]: .*bodies\[0\] has 'length'"),
        ('mass = "body"\n', "", r"kinds\[0\].body is used nowhere"),
        ("sd = 1e3", "sd = -1", r"kinds\[0\].body.sd must be above 0"),
        ("share = 1", 'share = 1\ntruck = "T2"', "has a truck, and 'bodies' too: leave out one"),
        ("share = 1", "share = 1\nload = 2", 'has \'load\', which needs truck: type truck = "T5"'),
        ("speed = 20", "", r"kinds\[0\] lacks speed \[m/s\], and so does the fleet"),
        ("speed = 20", "speed = 20\n" + TWICE, "different names, got 'two' twice: rename one"),
        ("speed = 20", "speed = [20]", "speed must be a number or a distribution"),
        ("[kinds.parameters]", "[[kinds.parameters]]", "parameters must be a table: type"),
        ("share = 1", "share = ", "is no TOML"),
        (RIGID, "kinds = 3", "kinds must be tables"),
        (RIGID, "speed = 20", r"lacks kinds: type \[\[kinds\]\]"),
        (RIGID, 'speed = 20\n[[kinds]]\nname = "a"\nshare = 1\ntruck = "no.toml"', "no.toml: no "),
        (RIGID, f"speed = 20\n{TWICE}hinge = [1, -1]", "and 'hinge' too: leave out one"),
    ],
)  # fmt: skip
def test_a_wrong_file_is_told_with_its_name_and_key(file, old, new, says):
    text = RIGID.replace("speed = {speed}", "speed = 20").replace("{place}", "2.5")
    old = text if old is RIGID else old
    assert old in text
    path = file(text.replace(old, new, 1))
    with pytest.raises(ValueError, match=says) as error:
        bc.Fleet.load(path)
    assert str(error.value).startswith(f"{path}: ")


def test_an_unknown_fleet_is_told_with_those_that_ship():
    with pytest.raises(
        ValueError, match="there is no fleet 'carlo': type air_sprung or monte_carlo, or"
    ):
        bc.Fleet.load("carlo")


def test_a_name_without_parameters_must_be_a_number(file):
    text = RIGID.replace("[kinds.parameters]", "[kinds.bodie]")
    with pytest.raises(ValueError, match="has 'bodie'"):
        bc.Fleet.load(file(text))
    text = 'speed = 20\n[[kinds]]\nname = "a"\nshare = 1\nsprung_mass = "m"\n'
    with pytest.raises(ValueError, match=r"sprung_mass = 'm' is no parameter .*: type a number"):
        bc.Fleet.load(file(text))


def test_a_quarter_car_may_be_a_kind(file):
    text = (
        'speed = 20\n[[kinds]]\nname = "car"\nshare = 1\nsprung_mass = "body"\n'
        "unsprung_mass = 1000\nsuspension_stiffness = 80e3\ntire_stiffness = 1.8e6\n"
        "damping = 7e3\n[kinds.parameters]\nbody = { min = 8e3, max = 9e3 }\n"
    )
    truck = bc.Fleet.load(file(text)).passing(0).vehicle
    assert truck.n_tires == 1
    assert 9e3 < truck.mass < 10e3


def test_a_truck_that_would_have_to_be_held_down_is_told_by_its_number(file):
    fleet = bc.Fleet.load(file(place="{min = -1.0, max = 4.0}"), seed=1)
    with pytest.raises(ValueError, match=r"truck \d+ of the fleet, of kind 'two': axle 'front'"):
        _ = [fleet.passing(i) for i in range(100)]


@pytest.mark.parametrize(
    ("i", "says"),
    [(-1, "i must be 0 or more"), (2.5, "i must be a whole number"), ("1", "i must be a whole")],
)
def test_a_wrong_number_of_a_truck_is_told(i, says):
    with pytest.raises((TypeError, ValueError), match=says):
        mixed().passing(i)


@pytest.mark.parametrize(
    ("indices", "says"),
    [
        ([], r"indices must be whole numbers.*type range\(100\)"), (3, "indices must be whole"),
        ([0.5], "indices must be whole"), ([-1, 2], "indices must be 0 or more, got -1 to 2"),
    ],
)  # fmt: skip
def test_wrong_numbers_of_a_part_are_told(indices, says):
    with pytest.raises((TypeError, IndexError), match=says):
        mixed().part(indices)


def test_numbers_of_a_truck_that_are_drawn_are_marked():
    kind = mixed()._source.kinds[0]
    assert kind.content["bodies"][0]["mass"] == Factor("load", 10500)
