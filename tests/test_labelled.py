"""Results go to pandas and xarray alike: names and numbers of attributes, with their units."""

import sys

import numpy as np
import pytest
from helpers import rough_road

import bridgectl as bc
from bridgectl.dampers import hybrid
from bridgectl.dampers.optimum.result import Clairvoyant
from bridgectl.scoring.changes import Robustness
from bridgectl.scoring.errors import Error
from bridgectl.scoring.ramp_heights import RampHeights
from bridgectl.scoring.rows import MEASURES

BEAM, CAR = bc.li2006.beam(), bc.li2006.car()
SPEEDS = np.array([20.0, 30.0, 25.0])
NUMBERS = np.random.default_rng(1)


def units(frame):
    return frame.attrs["units"]


def is_the_same(dataset, frame):
    """Whether a dataset has the numbers and units of a table."""
    pytest.importorskip("xarray")
    made = dataset.to_dataframe()
    made = made.reorder_levels(frame.index.names) if len(frame.index.names) > 1 else made
    made = made.loc[frame.index, list(frame.columns)]
    assert made.to_numpy() == pytest.approx(frame.to_numpy(), nan_ok=True, abs=0)
    told = {name: array.attrs["units"] for name, array in dataset.variables.items() if array.attrs}
    assert told == units(frame)
    return True


@pytest.fixture(scope="module")
def board():
    daf = NUMBERS.normal(1.1, 0.1, (2, 2, 3))
    optimum = {"daf": daf[1] - 0.05, "daf_bound": daf[1] - 0.1}
    return bc.Scoreboard(
        ("passive", "skyhook"), (7e3, np.nan), ("smooth", "rough"), SPEEDS,
        {name: daf + k for k, name in enumerate(MEASURES)}, daf[:, 0], daf[:, :, 0], BEAM, CAR,
        0.0, optimum=optimum,
    )  # fmt: skip


def test_a_scoreboard_has_every_measure_of_each_strategy_road_and_speed(board):
    table = board.to_pandas()
    assert table.index.names == ["strategy", "road", "speed"]
    assert list(table) == [*MEASURES, "daf_optimum", "gap_closed", "daf_bound"]
    row = table.loc[("skyhook", "rough", 30.0)]
    assert row["dae"] == board.values["dae"][1, 1, 1]
    assert row["daf_optimum"] == board.optimum["daf"][1, 1]
    daf, best = board.values["daf"][:, 1, 1], board.optimum["daf"][1, 1]
    assert row["gap_closed"] == pytest.approx((daf[0] - daf[1]) / (daf[0] - best), rel=1e-12)
    assert units(table)["speed"] == "m/s"
    assert units(table)["switching_rate"] == "1/s"
    assert units(table)["body_acceleration"] == "m/s^2"
    assert {units(table)[name] for name in ("daf", "least_force", "gap_closed")} == {"1"}
    assert is_the_same(board.to_xarray(), table)


def test_without_the_optimum_a_scoreboard_has_its_measures_alone():
    one = np.ones((1, 1, 3))
    board = bc.Scoreboard(
        ("passive",), (7e3,), ("road",), SPEEDS, {"daf": one}, one[0], one[0], BEAM, CAR, 0.0
    )
    assert list(board.to_pandas()) == ["daf"]


def test_robustness_has_its_dafs_beside_those_of_the_baseline():
    baseline, daf = NUMBERS.normal(1, 0.1, (2, 2, 3)), NUMBERS.normal(1, 0.1, (1, 2, 2, 3))
    errors = Error("nothing wrong"), Error("position", 1.0, "m")
    found = Robustness(
        "passive", ("skyhook",), errors, ("one", "two"), ("A", "B"), SPEEDS, baseline, daf, BEAM,
        CAR, 0.0,
    )  # fmt: skip
    table = found.to_pandas()
    row = table.loc[("skyhook", "position +1 m", "two", 25.0)]
    assert (row["daf"], row["baseline_daf"]) == (daf[0, 1, 1, 2], baseline[1, 1, 2])
    assert units(table) == {"speed": "m/s", "daf": "1", "baseline_daf": "1"}
    assert is_the_same(found.to_xarray(), table)
    assert found.to_xarray().baseline_daf.dims == ("error", "road", "speed")


@pytest.mark.parametrize("n_roads", [1, 3])
def test_trust_tells_what_speaks_against_each_road_and_speed(n_roads):
    surface = bc.ramp_surface(BEAM, CAR, SPEEDS, approach=5)
    roads = [rough_road(seed, -5, 25) for seed in range(n_roads)]
    trust = bc.dae_trust(
        surface, roads[0] if n_roads == 1 else np.array([r.elevation for r in roads])
    )
    table = trust.to_pandas()
    assert table.index.names == ["road", "speed"][-table.index.nlevels :]
    assert len(table) == 3 * n_roads
    for name in ("trusted", "peak_rise", "peak_moves", "lift_off"):
        assert table[name].to_numpy() == pytest.approx(getattr(trust, name).ravel())
    assert table["iri"].to_numpy() == pytest.approx(np.repeat(trust.iri, 3))
    assert units(table) == {
        "speed": "m/s", "peak_rise": "1", "tallest_ramp": "m", "iri": "m/km",
    }  # fmt: skip
    assert trust.speeds == pytest.approx(SPEEDS)
    assert is_the_same(trust.to_xarray(), table)


@pytest.mark.parametrize(("quantity", "unit"), [("moment", "N m"), ("deflection", "m")])
def test_an_envelope_is_a_table_over_the_places(quantity, unit):
    envelope = bc.envelope(BEAM, CAR, 25.0, quantity=quantity, at=[5.0, 12.5])
    table = envelope.to_pandas()
    assert table.index.name == "place"
    assert list(table.index) == [5.0, 12.5]
    for name in table:
        assert table[name].to_numpy() == pytest.approx(getattr(envelope, name), abs=0)
    assert units(table)["static_largest"] == units(table)["smallest"] == unit
    assert units(table)["largest_at"] == units(table)["place"] == "m"


def test_heights_of_a_ramp_are_a_table():
    h = np.array([-0.01, 0.0, 0.01])
    found = RampHeights("skyhook", 25.0, 5.0, 0.01, h, 1 + h, 1 + 2 * h, 1 + 3 * h, h > 0)
    table = found.to_pandas()
    assert list(table.index) == h.tolist()
    for name in ("daf", "first_order", "second_order", "lift_off"):
        assert table[name].tolist() == getattr(found, name).tolist()
    assert units(table) == {"height": "m", "daf": "1", "first_order": "1", "second_order": "1"}


def test_roads_and_their_spectra_are_tables():
    road = bc.utia_road()
    table = road.to_pandas()
    assert table.index.to_numpy() == pytest.approx(road.x, abs=0)
    assert table["elevation"].to_numpy() == pytest.approx(road.elevation, abs=0)
    assert units(table) == {"station": "m", "elevation": "m"}
    again = bc.RoadProfile(table.index.to_numpy(), table["elevation"].to_numpy(), name=road.name)
    assert again == road
    psd = road.psd()
    spectrum = psd.to_pandas()
    assert spectrum["density"].to_numpy() == pytest.approx(psd.density, abs=0)
    assert spectrum.index.to_numpy() == pytest.approx(psd.wavenumber, abs=0)
    assert units(spectrum) == {"wavenumber": "cycles/m", "density": "m^3"}


def test_tuned_gains_are_a_table():
    daf = np.ones((2, 3, 2))
    tuned = bc.Tuning(
        hybrid(1e3, 30e3), ("share", "gain"), np.array([0.5, 7.0]), np.array([0.4, 6.0]),
        np.array([[0.0, 1.0], [5.0, 9.0]]), "daf", "generations", np.inf, np.ones(3), SPEEDS, daf,
        daf, {}, 1.0, False, BEAM, CAR, 0.0,
    )  # fmt: skip
    table = tuned.to_pandas()
    assert table.loc["gain"].to_dict() == {"before": 7, "after": 6, "least": 5, "largest": 9}


def test_the_best_damping_is_a_table_of_one_damper_or_of_several():
    x = np.array([0.0, 1.0, 2.0])
    one = Clairvoyant(1.0, 1.1, x, 1e3 * (1 + x), 0.02, 1e3, 3e3, "found")
    assert one.to_pandas()["damping"].tolist() == [1e3, 2e3, 3e3]
    assert units(one.to_pandas()) == {"position": "m", "damping": "N s/m"}
    two = Clairvoyant(1.0, 1.1, x, np.array([1 + x, 2 + x]), 0.02, 1, 4, "found", np.zeros(2))
    assert list(two.to_pandas()) == ["damping_1", "damping_2"]
    assert two.to_pandas()["damping_2"].tolist() == [2, 3, 4]


def test_trucks_of_a_fleet_are_a_table():
    fleet = bc.Fleet({"T2": 1, "T5": 1}, speed=25.0, load={"min": 0.5, "max": 1}, seed=1)
    part = fleet.part(range(4))
    table = part.to_pandas()
    for i, row in table.iterrows():
        truck, speed, kind, _ = part.passing(i)
        assert (row["speed"], row["kind"], row["n_axles"]) == (speed, kind, truck.n_tires)
        assert row["gross_weight"] == pytest.approx(9.81 * truck.mass, rel=1e-9)
    assert units(table) == {"time": "s", "speed": "m/s", "gross_weight": "N"}
    with pytest.raises(TypeError, match=r"type fleet.part\(range\(1000\)\) for a part"):
        fleet.to_pandas()


def test_an_assessment_has_the_units_of_its_columns(one_assessment):
    assert units(one_assessment.to_pandas()) == {
        "speed": "m/s", "gross_weight": "N", "static moment": "N m", "total moment": "N m",
        "place moment": "m", "time moment": "s",
    }  # fmt: skip


@pytest.fixture
def one_assessment():
    columns = {
        name: np.ones(2)
        for name in ("crossing", "truck", "speed", "gross_weight", "n_axles", "least_tire_force")
    }
    columns |= {name: np.array(["a", "b"]) for name in ("kind", "road", "quality")}
    columns |= {name: np.zeros(2, dtype=bool) for name in ("damped", "meeting")}
    of = ("static", "total", "daf", "place", "time")
    return bc.Assessment(columns | {f"{each} moment": np.ones(2) for each in of}, {"moment": "N m"})


def test_without_xarray_the_error_says_what_to_type(board, monkeypatch):
    monkeypatch.setitem(sys.modules, "xarray", None)
    with pytest.raises(ImportError, match=r'type pip install "bridgectl\[xarray\]"'):
        board.to_xarray()
