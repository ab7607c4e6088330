"""A newcomer's slip in any argument of the functions used most is met by a word."""

import inspect
import re
import warnings

import numpy as np
import pytest

import bridgectl as bc
from bridgectl.dampers import passive, skyhook

BEAM, CAR = bc.li2006.beam(), bc.li2006.car()
ROAD = bc.iso8608_profile("A", 35, seed=0, start=-10)
ELSEWHERE = bc.RoadProfile(ROAD.x + 1000, ROAD.elevation)
IN_MM = bc.RoadProfile(ROAD.x[::50], 500 * ROAD.elevation[::50])
MASKED = np.ma.masked_array([20.0, 25.0], [False, True])
PASSIVE = passive(7e3)

GOOD = {
    "Beam": {"length": 25.0, "mass_per_length": 18358.0, "flexural_rigidity": 4.865e10},
    "QuarterCar": {
        "sprung_mass": 9000.0, "unsprung_mass": 1000.0, "suspension_stiffness": 80e3,
        "tire_stiffness": 1.8e6, "damping": 7e3,
    },
    "daf": {"beam": BEAM, "vehicle": CAR, "speeds": [20, 25], "profile": ROAD, "start": -10},
    "peak_effect": {"beam": BEAM, "vehicle": CAR, "speeds": 25, "profile": ROAD, "start": -10},
    "crossing_response": {
        "beam": BEAM, "vehicle": CAR, "speed": 25, "profile": ROAD, "start": -10
    },
    "prediction_matrices": {
        "beam": BEAM, "vehicle": CAR, "speed": 25, "profile": ROAD, "start": -10
    },
    "ramp_surface": {"beam": BEAM, "vehicle": CAR, "speeds": 25},
    "score": {
        "dampers": [PASSIVE], "beam": BEAM, "vehicle": CAR, "roads": [ROAD], "speeds": 25,
        "approach": 10, "workers": 1,
    },
    "read_profile": {},
}  # fmt: skip


def law(s, g):
    return g.c_max


def slips_of_numbers(name, *others, least="above 0"):
    """What goes wrong with every number that must be positive, or 0 or more."""
    return [
        ("25", f"{name} must be one number.*type 25, without quotes"),
        ("2,5", f"{name} must be one number.*type 2.5, without quotes"),
        ([25.0], f"{name} must be one number.*type 25, without brackets"),
        (None, f"{name} must be one number"),
        (True, f"{name} must be one number"),
        (1j, f"{name} must be one number"),
        (np.ma.masked, f"{name} has 1 masked value"),
        (np.nan, f"{name} must be finite"),
        (-25.0, f"{name} must be {least}.*type 25"),
        *others,
    ]


MODEL = {
    "beam": [
        (CAR, r"beam must be a bridgectl.Beam.*type for example bridgectl.Beam\("),
        (None, "beam must be a bridgectl.Beam"),
        (bc.Beam, "beam must be a bridgectl.Beam"),
    ],
    "vehicle": [
        (BEAM, r"vehicle must be a .*QuarterCar.*type for example bridgectl"),
        (9000.0, r"vehicle must be a .*QuarterCar.*type for example bridgectl"),
    ],
    "section": [
        (12.5, "section must lie between 0 and 1.*for 12.5 m of 25 m type 0.5"),
        (50, "section must lie between 0 and 1.*for 50 percent type 0.5"),
        ("0.5", "section must be one number.*type 0.5, without quotes"),
        (0, "section must lie between 0 and 1"),
    ],
    "recovery": [("exakt", "recovery must be one of 'exact'"), (None, "recovery must be one of")],
}
SPEEDS = [
    ([60, 80], r"speeds of 80 m/s \(288 km/h\).*for 80 km/h type 80 / 3.6"),
    (60, r"speeds of 60 m/s \(216 km/h\).*for 60 km/h type 60 / 3.6"),
    ("25", "speeds must be an array of numbers.*type 25, without quotes"),
    (["25"], "speeds must be an array of numbers.*type 25, without quotes"),
    ([], "speeds must hold at least one speed"),
    (0, "speeds must be above 0 m/s"),
    (-25, "speeds must be above 0 m/s"),
    (None, "speeds must be an array of numbers"),
    ([True], "speeds must be an array of numbers"),
    ([[20, 25]], r"speeds must have shape \(n,\).*type numpy.ravel\(speeds\)"),
    (["20", "25"], r"speeds must be an array .*type numpy.array\(speeds, dtype=float\)"),
    (np.array([20, None]), r"speeds must be an array of numbers \[m/s\], got .*dtype=object\)$"),
    ({20, 25}, r"speeds must be an array .*type a list"),
    (iter([20, 25]), r"speeds must be an array .*type a list"),
    (MASKED, r"speeds has 1 masked value.*index \(1,\).*type keep"),
    ([np.nan], "speeds must be finite"),
]
PROFILE = [
    ("road.csv", r"profile must be a bridgectl.RoadProfile, got str: type .*read_profile\(path\)"),
    (ROAD.elevation, "profile must be a bridgectl.RoadProfile, got ndarray: type RoadProfile"),
    ([ROAD], "profile must be a bridgectl.RoadProfile, got list.*one road at a time"),
    (ELSEWHERE, r"the road covers x from 990 m to 1025 m.*place_bridge\(1000"),
    (bc.RoadProfile(ROAD.x / 1000, ROAD.elevation), "covers .* for stations in km type Road"),
    (bc.RoadProfile(ROAD.x, 0.05 * ROAD.x), r"grade of 5.0%.*type road.detrend\(\)"),
    (IN_MM, "road's slope .* mm .*Type RoadProfile"),
]
START = [
    (10, "start must be 0 m .*or negative.*type -10"),
    ("-10", "start must be one number.*type -10, without quotes"),
    (-20, "the road covers x from -10 m .*start=-10"),
]
EFFECT = [
    ("moments", "effect must be one of 'moment'.*: type 'moment'$"),
    ("Moment", "effect must be one of .*: type 'moment'$"),
    ("bending", "effect must be one of .*got 'bending'$"),
    (None, "effect must be one of"),
]
METHOD = [("fast", "method must be one of 'propagator'"), (None, "method must be one of")]
DAMPER = [
    (7e3, r"damper must be .*type bridgectl.dampers.passive\(7e3\)"),
    (skyhook, r"damper must be .*type skyhook\(1e3, 30e3\)"),
    (law, r'damper must be .*Strategy\("law", law, 1e3, 30e3\)'),
    ("skyhook", r"damper must be .*type bridgectl.dampers.skyhook\("),
    ([PASSIVE, PASSIVE], "damper must be .*type None in the list"),
]
PROGRESS = [("no", "progress must be True or False"), (None, "progress must be True or False")]

NAMED = [
    (bc.Moment(5.0), "effects must be effects by their names.*type for example"),
    ([bc.Moment(5.0)], "effects must be effects by their names.*type for example"),
    ({"at 5 m": bc.Moment(5.0)}, "effects must have words for names.*got 'at 5 m'"),
    ({"static_pier": bc.Moment(5.0)}, "not beginning with 'static_'"),
    ({5: bc.Moment(5.0)}, "effects must have words for names.*got 5"),
    ({"moment": bc.Moment(5.0)}, "'moment' is an output already: type 'moment_2'"),
    ({"pier": "momentum"}, "effect must be one of 'moment'"),
    ({"pier": bc.Moment(30.0)}, "at must be a place on the bridge"),
]

SLIPS = {
    "Beam": {
        "length": slips_of_numbers(
            "length", (25000, "length = 25000 m is no span.*for 25000 mm type length=25.*order"),
            (2500, "for 2500 cm type length=25;"), (0, "length must be above 0"),
        ),
        "mass_per_length": slips_of_numbers(
            "mass_per_length",
            (18.358, "mass_per_length = 18.358 .*for 18.358 t/m type mass_per_length=18358"),
            (458950, "mass_per_length = 458950 .*type mass_per_length=18358"),
            (180, "for 180 kN/m type mass_per_length=18349"),
        ),
        "flexural_rigidity": slips_of_numbers(
            "flexural_rigidity",
            (4.865e7, r"for 4.865e\+07 kN m\^2 type flexural_rigidity=4.865e\+10"),
            (48650, r"for 48650 MN m\^2 type flexural_rigidity=4.865e\+10"),
            (48.65, r"for E in GPa type flexural_rigidity=4.865e\+10"),
            (1.39, r"if it is J .* alone type flexural_rigidity=E\*1.39"),
            (1e-6, r"flexural_rigidity is E \[N/m\^2\] times J"),
            (4.865e18, r"for J in cm\^4 type flexural_rigidity=4.865e\+10"),
            (4.865e22, r"for J in mm\^4 type flexural_rigidity=4.865e\+10"),
        ),
        "n_modes": [
            (0, "n_modes must be 1 or more"), ("3", "n_modes must be a whole.*without quotes"),
            (2.5, "n_modes must be a whole number"), (True, "n_modes must be a whole number"),
            (3.0, "n_modes must be a whole number, got 3.0: type 3$"),
        ],
        "damping_ratio": [
            (2, "damping_ratio must be below 1.*for 2 percent type 0.02"),
            (0.5, "damping_ratio = 0.5 is 50 percent.*type damping_ratio=0.005"),
            (-0.02, "damping_ratio must be 0 or more.*type 0.02"),
            ("0.02", "damping_ratio must be one number.*type 0.02, without quotes"),
            ([0.01], "damping_ratio must be one number or 3 numbers"),
        ],
    },
    "QuarterCar": {
        "sprung_mass": slips_of_numbers(
            "sprung_mass", (9, "sprung_mass = 9 kg .*lighter.*for 9 t type sprung_mass=9000"),
            (100, r"sprung_mass = 100 kg .* \(the axle\): exchange the two$"),
        ),
        "unsprung_mass": slips_of_numbers(
            "unsprung_mass", (1, "axle moves at 218 Hz.*for 1 t type unsprung_mass=1000")
        ),
        "suspension_stiffness": slips_of_numbers(
            "suspension_stiffness",
            (80, "body moves at 0.015 Hz.*for 80 kN/m type suspension_stiffness=80000"),
            (80e6, "suspension_stiffness = .*far stiffer than tire_stiffness"),
        ),
        "tire_stiffness": slips_of_numbers(
            "tire_stiffness", (1800, r"N/m: for 1800 kN/m type tire_stiffness=1.8e\+06"),
            (1.8e9, "the axle moves at 214 Hz.*; tires have 1e5 to 1e7 N/m"),
            (13e3, "tire_stiffness = 13000 N/m: exchange the two$"),
            (14e3, r"the axle moves at 1.54 Hz.*; for 14000 kN/m type tire_stiffness=1.4e\+07"),
        ),
        "damping": slips_of_numbers(
            "damping", (7, "damping = 7 N s/m.*for 7 kN s/m type damping=7000"),
            (0.13, r"damping = 0.13 N s/m.*for a ratio of 0.13 type damping=6.98e\+03"),
            (7e6, "damping = .*check that suspension_stiffness"), least="0 or more",
        ),
        "tire_damping": slips_of_numbers("tire_damping", least="0 or more"),
    },
    "daf": MODEL | {
        "speeds": SPEEDS, "profile": PROFILE, "start": START, "effect": EFFECT, "method": METHOD,
        "damper": DAMPER, "progress": PROGRESS,
    },
    "peak_effect": MODEL | {
        "speeds": SPEEDS, "profile": PROFILE, "start": START, "effect": EFFECT, "method": METHOD,
        "damper": DAMPER, "progress": PROGRESS,
    },
    "crossing_response": MODEL | {
        "speed": slips_of_numbers("speed", (80, "speed of 80 m/s .*type 80 / 3.6")),
        "profile": PROFILE, "start": START, "method": METHOD, "damper": DAMPER, "effect": EFFECT,
        "effects": NAMED, "static": [("yes", "static must be True or False")],
        "tail": slips_of_numbers("tail", least="0 or more"),
        "timepts": [
            ([0, 100], "timepts must lie within the crossing"),
            ([0.2, 0.1], "timepts must hold two or more increasing times"),
            (5.0, r"timepts must have shape \(n,\)"),
            (MASKED, "timepts has 1 masked value"),
        ],
    },
    "prediction_matrices": MODEL | {
        "speed": slips_of_numbers("speed", (80, "speed of 80 m/s .*type 80 / 3.6")),
        "profile": PROFILE, "start": START, "effect": EFFECT,
    },
    "ramp_surface": MODEL | {
        "speeds": SPEEDS, "effect": EFFECT, "method": METHOD, "damper": DAMPER,
        "progress": PROGRESS,
        "approach": slips_of_numbers("approach", least="0 or more"),
        "ramp_length": slips_of_numbers(
            "ramp_length", (100, "ramp_length must not exceed .*for 100 mm type 0.1")
        ),
        "ramp_height": slips_of_numbers(
            "ramp_height", (1, "ramp_height must not exceed .*for a ramp of 1 mm type 1e-3"),
            ("Z", "ramp_height, if no height .*, must be one of 'A', 'B'"),
        ),
        "both_ways": [("yes", "both_ways must be True or False"), (1, "both_ways must be True")],
        "every": [(0, "every must be 1 or more"), (1.5, "every must be a whole number")],
    },
    "score": MODEL | {
        "effect": EFFECT,
        "dampers": [
            (PASSIVE, r"dampers must be a list.*type \[damper\]"),
            ([], "dampers must hold a strategy"), (None, "dampers must be a list"),
            ("skyhook", r"dampers must be a list.*type \[bridgectl.dampers"),
            ([7e3], r"damper must be .*type bridgectl.dampers.passive\(7e3\)"),
            ([PASSIVE, PASSIVE], "dampers must have different names.*renamed"),
        ],
        "roads": [
            (ROAD, r"roads must be a list of RoadProfile: type \[road\]"),
            (["a.csv"], "roads must be a list of RoadProfile.*read_profile"),
            (None, "roads must be a list"), ([], "roads must hold a road"),
            ([ELSEWHERE], "of road 1, .*place_bridge"),
            ([ROAD, ROAD], "roads 1 .* and 2 .* are the same.*leave one out"),
            ([IN_MM], "road's slope .* mm .*Type RoadProfile"),
        ],
        "speeds": SPEEDS, "approach": slips_of_numbers("approach", least="0 or more"),
        "departure": slips_of_numbers("departure", least="0 or more"),
        "clairvoyant": [
            (slip, said.replace("progress", "clairvoyant")) for slip, said in PROGRESS
        ],
        "dae": [(slip, said.replace("progress", "dae")) for slip, said in PROGRESS],
        "on_simulated": [("print", "on_simulated must be a function .*type on_simulated=print")],
        "resume": [(3, "resume must name a file.*type resume=")],
        "workers": [
            (0, "workers must be 1 or more"), ("2", "workers must be a whole.*without quotes"),
            (2.5, "workers must be a whole number"),
        ],
        "scheduler": [
            (8786, 'scheduler must be the address.*got int: type scheduler="tcp://HOST:8786"'),
            ("nowhere", "scheduler must be the address of a Dask scheduler, got 'nowhere'"),
        ],
        "progress": PROGRESS,
    },
    "read_profile": {
        "path": [(None, "path must be a string or a Path"), ("no.csv", "no such file")],
        "units": [("mm", "units must name two units"), ("m,furlong", "unknown unit 'furlong'")],
        "columns": [((0, 9), "column 9"), ("0,1", "columns must be two or more")],
        "delimiter": [(3, "delimiter must be one of")],
        "step": [slip for slip in slips_of_numbers("step") if slip[0] is not None],
        "track": [("x", "no track 'x'"), (2.5, "track must be a label or a whole number")],
        "name": [(3, "name must be a string")],
    },
}  # fmt: skip

CASES = [
    pytest.param(function, argument, slip, says, id=f"{function}-{argument}-{i}")
    for function, table in SLIPS.items()
    for argument, slips in table.items()
    for i, (slip, says) in enumerate(slips)
]


@pytest.mark.parametrize("function", SLIPS)
def test_no_argument_is_left_out(function):
    parameters = set(inspect.signature(getattr(bc, function)).parameters)
    known = set(SLIPS[function])
    # Arguments of reading files come and go with the formats, whose tests have their slips.
    assert known <= parameters if function == "read_profile" else known == parameters


@pytest.fixture
def good(function, tmp_path):
    """Arguments of a function that are right."""
    path = tmp_path / "road.csv"
    path.write_text("x [m], z [mm]\n0, 0\n0.1, 1\n0.2, 0\n", encoding="utf-8")
    return {"path": path} if function == "read_profile" else GOOD[function]


@pytest.mark.parametrize(("function", "argument", "slip", "says"), CASES)
def test_a_slip_is_told_once_with_what_to_type(good, function, argument, slip, says):
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        try:
            getattr(bc, function)(**good | {argument: slip})
        except (ValueError, TypeError, NotImplementedError, OSError) as error:
            texts = [str(error), *told]
        else:
            judged = [each for each in told if each.category is bc.PlausibilityWarning]
            texts = [str(each.message) for each in judged]
            assert [each.filename for each in judged] == [__file__]
    assert len(texts) == 1
    assert re.search(says, texts[0]), texts[0]
    assert "\n" not in texts[0]


@pytest.mark.parametrize("function", GOOD)
def test_no_slip_is_no_word(good, function):
    getattr(bc, function)(**good)


ELEVATIONS = np.zeros(9)
SURFACE = bc.ramp_surface(BEAM, CAR, 25, ramp_length=0.5)
OTHERS = {
    "convoy of one": (lambda: bc.convoy(CAR, [0]), r"vehicles must be a list.*type \[front, rear"),
    "convoy of a bridge": (lambda: bc.convoy([CAR, BEAM], [0, 5]), "vehicles must be a list"),
    "convoy ahead": (
        lambda: bc.convoy([CAR, CAR], [0, -5]), r"offsets must be distances.*type \[5.0, 0.0\]",
    ),
    "one mass": (
        lambda: bc.Vehicle([9e3, 1e3], np.eye(2), np.eye(2), [1e6]), "numpy.diag.mass_matrix.",
    ),
    "one tire": (
        lambda: bc.Vehicle(np.eye(2), np.eye(2), np.eye(2), 1.8e6), r"tire_stiff.* \[1.8e\+06\]",
    ),
    "arguments swapped": (
        lambda: bc.dae_trust(ROAD, SURFACE), "surface must be a .*RampSurface, got RoadProfile",
    ),
    "elevations elsewhere": (
        lambda: SURFACE.dae(ELEVATIONS), r"roads must have elevations.*type RoadProfile\(x, elev",
    ),
    "no approach": (lambda: SURFACE.dae(ELSEWHERE), "the crossing needs 0 m to 25 m"),
    "long approach": (
        lambda: bc.score([PASSIVE], BEAM, CAR, [ROAD], 25, approach=20), "or approach=10$",
    ),
    "surface for its file": (
        lambda: bc.load_surface(SURFACE), "path must be a string or a Path, got Ramp.*surface.npz",
    ),
    "road for its file": (lambda: bc.read_profile(ROAD.x), r"path must be .{,90}: type path=.road"),
    "small class": (lambda: bc.iso8608_profile("a", 25), "roughness must be .*: type 'A'$"),
    "seed in words": (lambda: bc.iso8608_profile("A", 25, seed="x"), "seed must be a whole number"),
}  # fmt: skip


@pytest.mark.parametrize("case", OTHERS)
def test_slips_elsewhere_are_told_with_what_to_type(case):
    call, says = OTHERS[case]
    with pytest.raises((TypeError, ValueError), match=says):
        call()
