"""Assessments of tables by crossing whose answers are known."""

import builtins
import csv
import dataclasses
import tracemalloc

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg

import bridgectl as bc
from bridgectl.fleet import levels, tails
from bridgectl.fleet.comparison import traffic
from bridgectl.fleet.words import Words

ASKED = {"trucks_a_day": 1000.0}


def columns(static, daf, quality="", damped=False, truck=None):
    """Columns by crossing of one moment; nothing of the others matters."""
    n = len(static)
    number = np.arange(n) if truck is None else truck
    ones = np.ones(n)
    return {
        "crossing": np.arange(n), "truck": number, "kind": np.resize(["van", "artic"], n),
        "road": np.full(n, "smooth"), "quality": np.full(n, quality), "speed": 20 * ones,
        "gross_weight": 4e5 * ones, "n_axles": np.full(n, 5), "damped": np.full(n, damped),
        "meeting": np.zeros(n, dtype=bool), "least_tire_force": 0.7 * ones,
        "static moment": static, "total moment": static * daf, "daf moment": daf,
        "place moment": 12 * ones, "time moment": 0.6 * ones,
    }  # fmt: skip


def table_of(*parts, **told):
    joined = {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
    return bc.Assessment(joined, {"moment": "N m"}, "a bridge", **(ASKED | told))


@pytest.fixture
def few_draws(monkeypatch):
    """Intervals and p-values by few samples drawn again, where no one looks at their numbers."""
    monkeypatch.setattr(levels, "N_PAIRS", 50)
    monkeypatch.setattr(tails, "N_DRAWS", 20)


@pytest.fixture(scope="module")
def traffic_of_trucks():
    """Static moments of 20 000 trucks, and DAFs that fall as the moment rises."""
    rng = np.random.default_rng(1)
    static = 1e6 * rng.beta(2, 4, 20_000) + 1e5
    daf = 1 + 0.1 * np.abs(rng.normal(size=20_000)) * (3e5 / static)
    return static, daf


@pytest.fixture(scope="module")
def two_roads(traffic_of_trucks):
    """The same trucks on two qualities, with and without dampers."""
    static, daf = traffic_of_trucks
    return table_of(
        columns(static, daf, "A"), columns(static, daf + 0.05, "C"),
        columns(static, daf - 0.02, "A", True), columns(static, daf + 0.05 - 0.04, "C", True),
    )  # fmt: skip


@pytest.fixture(scope="module")
def one_road(traffic_of_trucks):
    return table_of(columns(*traffic_of_trucks))


@pytest.mark.parametrize("method", ["block maxima", "peaks over threshold"])
@pytest.mark.parametrize("n", [1, 25, 1000])
def test_the_ratio_of_identical_trucks_on_a_level_road_is_their_daf(n, method):
    """To the bit, however few."""
    static, total = 613.1e3, 613.1e3 * 1.0437
    one = columns(np.full(n, static), np.ones(n)) | {"total moment": np.full(n, total)}
    found = table_of(one).adr(method=method)
    assert found == (total / static,) * 3


@pytest.mark.quick_cases(1)
@pytest.mark.parametrize("method", ["block maxima", "peaks over threshold"])
def test_identical_trucks_on_a_rough_road_have_a_ratio_with_an_interval(method):
    """Their static effect is known; the ratio is the characteristic DAF."""
    rng = np.random.default_rng(2)
    daf = 1.1 + 0.05 * rng.normal(size=5000)
    assessment = table_of(columns(np.full(5000, 6e5), daf))
    found, both = assessment.adr(method=method), assessment.characteristic(method=method)
    assert both.static == (6e5, 6e5, 6e5)
    assert found.value == pytest.approx(both.total.value / 6e5)
    assert found.low < found.value < found.high


@pytest.mark.usefixtures("few_draws")
@pytest.mark.parametrize("method", ["block maxima", "peaks over threshold"])
def test_the_ratio_of_a_daf_that_is_the_same_for_all_is_that_daf(traffic_of_trucks, method):
    static, _ = traffic_of_trucks
    found = table_of(columns(static, np.full(static.size, 1.2))).adr(75, method=method)
    assert np.array(found) == pytest.approx(1.2, abs=1e-3)


@pytest.mark.slow
def test_the_ratio_is_far_below_the_daf_that_light_trucks_have(one_road):
    """Their DAF is 1.4 in one crossing of a hundred; heavy trucks are amplified by less."""
    ratio = one_road.adr()
    assert ratio.low < ratio.value < ratio.high < 1.2
    assert one_road.quantiles("daf", [0.99])[0].low > 1.3


@pytest.mark.slow
def test_the_ratio_of_known_distributions_is_within_its_interval():
    """Exponential static effects with amplifications of their own: 100 years, 40 samples."""
    # Of static E and DAF 1.2 for a share of 0.3, else 1.1: z from 0.3 e^(-z/1.2) + ... = 1 / N.
    n = 100 * 250 * 1000
    z = np.linspace(15, 25, 100_001)
    exceeded = 0.3 * np.exp(-z / 1.2) + 0.7 * np.exp(-z / 1.1)
    known = np.interp(-np.log(1 / n), -np.log(exceeded), z) / np.log(n)
    hits = 0
    for seed in range(40):
        rng = np.random.default_rng(seed)
        static = rng.exponential(1.0, 10_000)
        daf = np.where(rng.random(10_000) < 0.3, 1.2, 1.1)
        found = table_of(columns(static, daf)).adr(100)
        hits += found.low <= known <= found.high
    assert hits >= 0.95 * 40


def test_the_daf_falls_as_the_static_effect_rises(one_road, traffic_of_trucks):
    static, daf = traffic_of_trucks
    bins = one_road.daf_bins(5)
    assert bins.crossings.sum() == static.size
    assert np.all(np.diff(bins.mean) < 0)
    own = (static >= bins.low[1]) & (static < bins.high[1])
    assert bins.crossings[1] == own.sum()
    assert bins.mean[1] == pytest.approx(daf[own].mean())
    assert bins.quantiles[:, 1] == pytest.approx(np.quantile(daf[own], [0.05, 0.5, 0.95]))


def test_bins_without_crossings_are_left_out():
    assessment = table_of(columns(np.array([1.0, 1.1, 9.0]), np.array([1.0, 1.2, 1.3])))
    bins = assessment.daf_bins(4)
    assert list(bins.crossings) == [2, 1]
    assert (bins.low[1], bins.high[1]) == (7.0, 9.0)


def test_quantiles_are_those_of_the_column_asked_for(two_roads, traffic_of_trucks):
    static, daf = traffic_of_trucks
    found = two_roads.quantiles(quality="A", damper_share=1)
    assert [each.value for each in found] == pytest.approx(
        np.quantile(daf - 0.02, [0.05, 0.5, 0.95, 0.99])
    )
    heavy = two_roads.quantiles("static", [0.9], quality="C")[0]
    assert heavy.value == pytest.approx(np.quantile(static, 0.9))
    assert heavy.low < heavy.value < heavy.high


def test_differences_are_between_the_same_trucks(two_roads):
    """Of DAFs that are 0.05 higher for each truck: to 1e-12, and so is the interval."""
    worse = two_roads.quality_influence()
    assert list(worse) == ["C"]
    assert np.array(worse["C"]) == pytest.approx(0.05, abs=1e-12)
    damped = two_roads.damper_influence(1.0)
    assert np.array(damped["A"]) == pytest.approx(-0.02, abs=1e-12)
    half = two_roads.damper_influence(0.5)
    assert half["C"].value == pytest.approx(-0.02, abs=1e-12)
    assert half["C"].low < half["C"].value < half["C"].high < 0


@pytest.mark.slow
def test_dampers_lower_the_characteristic_total_effect_and_leave_the_static_one(two_roads):
    plain, damped = (two_roads.characteristic(quality="C", damper_share=share) for share in (0, 1))
    assert damped.total.value < plain.total.value
    assert damped.static == plain.static
    assert two_roads.characteristic(quality="C").total == plain.total


def test_trucks_of_a_small_share_with_dampers_are_among_those_of_a_large_one():
    truck, damped = np.tile(np.arange(1000), 2), np.repeat([False, True], 1000)
    having = []
    for share in (0.1, 0.25):
        rows = traffic(truck, damped, share)
        assert sorted(truck[rows]) == list(range(1000))
        having.append(set(truck[rows & damped]))
    assert [len(each) for each in having] == [100, 250]
    assert having[0] < having[1]


def test_trucks_that_were_only_simulated_with_dampers_have_them():
    truck, damped = np.arange(10), np.arange(10) < 3
    assert traffic(truck, damped, None).all()
    assert traffic(truck, damped, 0.3).all()
    with pytest.raises(ValueError, match=r"damper_share must lie between 0.3 and 0.3, .*got 0.5"):
        traffic(truck, damped, 0.5)


def test_a_truck_that_crosses_some_roads_of_a_quality_counts_once():
    """Means of its crossings are compared."""
    truck = np.array([0, 0, 1, 1])
    first = columns(np.ones(4), np.array([1.0, 1.2, 1.0, 1.2]), "A", truck=truck)
    other = columns(np.ones(2), np.array([1.3, 1.3]), "B", truck=np.array([1, 0]))
    found = table_of(first, other).quality_influence()["B"]
    assert np.array(found) == pytest.approx(0.2, abs=1e-12)


def test_what_no_truck_or_one_has_in_common_has_no_interval():
    first, other = columns(np.ones(2), np.ones(2), "A"), columns(np.ones(2), np.ones(2), "B")
    apart = table_of(first, other | {"truck": np.array([7, 8])}).quality_influence()["B"]
    assert np.isnan(apart).all()
    one = table_of(first, other | {"truck": np.array([1, 8])}).quality_influence()["B"]
    assert one.value == 0
    assert np.isnan(one[1:]).all()


@pytest.mark.slow
def test_hogging_moments_are_extreme_where_they_are_smallest(traffic_of_trucks, one_road):
    static, daf = traffic_of_trucks
    hogging = table_of(columns(-static, daf))
    one, other = (each.characteristic(threshold=sign * 8e5)
                  for each, sign in ((one_road, 1), (hogging, -1)))  # fmt: skip
    assert other.total == (-one.total.value, -one.total.high, -one.total.low)
    assert hogging.adr() == one_road.adr()
    with pytest.raises(ValueError, match=r"and -1e\+09 is by 0 of 20000: type threshold=-\d+"):
        hogging.adr(threshold=-1e9)


def test_a_return_period_shorter_than_the_data_has_the_value_of_the_crossings(
    one_road, traffic_of_trucks
):
    """20 000 crossings are 0.08 years; in 0.02 years one in 5000 exceeds the value."""
    static, _ = traffic_of_trucks
    says = r"return_period has 5000 crossings, .* than the 20000 .* more than 0\.08 years"
    with pytest.warns(bc.PlausibilityWarning, match=says) as told:
        found = one_road.characteristic(0.02)
    assert [each.filename for each in told] == [__file__]
    assert found.static.value == pytest.approx(np.quantile(static, 1 - 1 / 5000))
    assert found.static.low < found.static.value < found.static.high
    assert found.total_fit is None
    with pytest.warns(bc.PlausibilityWarning):
        ratio = one_road.adr(0.02)
    assert ratio.value == pytest.approx(found.total.value / found.static.value)
    assert ratio.low <= ratio.value <= ratio.high


def test_more_crossings_a_day_are_a_larger_effect(one_road):
    few, many = (one_road.characteristic(trucks_a_day=each).total.value for each in (500, 5000))
    assert few < many
    assert one_road.characteristic(2000, days_a_year=125).total.value == pytest.approx(
        one_road.characteristic(1000, days_a_year=250).total.value
    )


SLIPS = {
    "no such effect": (lambda a: a.adr(effect="shear"), "effect must be one of 'moment', got 'sh"),
    "which road": (lambda a: a.adr(), "quality must be one of 'A', 'C', got None"),
    "method": (lambda a: a.adr(quality="A", method="GEV"), "method must be one of 'block maxima'"),
    "no years": (lambda a: a.adr(0, quality="A"), "return_period must be above 0"),
    "an hour": (lambda a: a.adr(1e-6, quality="A"), "have 0.25: type return_period=8e-06 or more"),
    "long year": (lambda a: a.adr(quality="A", days_a_year=400), "days_a_year .* 366, got 400"),
    "few blocks": (
        lambda a: a.adr(quality="A", method="block maxima", block=1000), "20 of 1000: type .*=666$"
    ),
    "small block": (lambda a: a.adr(quality="A", block=1), "block must be 2 or more"),
    "high threshold": (
        lambda a: a.adr(quality="A", threshold=1e9), "is by 0 of 20000: type threshold="
    ),
    "quantity": (lambda a: a.quantiles("DAF"), "quantity must be .*: type 'daf'"),
    "percent": (lambda a: a.quantiles(shares=[95], quality="A"), "for 95 percent type 0.95"),
    "bins": (lambda a: a.daf_bins(0, quality="A"), "n_bins must be 1 or more"),
    "dampers": (lambda a: a.damper_influence(1.5), "damper_share must lie between 0 and 1, "),
}  # fmt: skip


@pytest.mark.parametrize("slip", SLIPS)
def test_a_slip_is_told_with_what_to_type(two_roads, slip):
    call, says = SLIPS[slip]
    with pytest.raises(ValueError, match=says):
        call(two_roads)


def test_trucks_a_day_must_be_known_for_a_return_period(one_road):
    with pytest.raises(ValueError, match=r"trucks_a_day must be said .* type trucks_a_day=1000"):
        dataclasses.replace(one_road, trucks_a_day=None).adr()


def test_an_effect_that_static_loads_do_not_have_has_no_ratio(traffic_of_trucks):
    static, daf = traffic_of_trucks
    none = columns(static, daf) | {"static moment": 0 * static, "daf moment": np.nan * static}
    assessment = table_of(none)
    with pytest.raises(ValueError, match="effect must have a static value for a ratio"):
        assessment.adr()
    assert assessment.characteristic().total.value > 1e6
    assert "Characteristic" not in str(assessment)


def test_numbers_that_are_none_are_told(traffic_of_trucks):
    static, daf = traffic_of_trucks
    broken = static.copy()
    broken[5] = np.nan
    with pytest.raises(ValueError, match=r"total moment must be finite, got nan at index \(5,\)"):
        table_of(columns(broken, daf)).adr()


def test_columns_must_be_there_and_of_one_length():
    good = columns(np.ones(3), np.ones(3))
    with pytest.raises(ValueError, match="there is no 'static shear'"):
        bc.Assessment(good, {"shear": "N"})
    with pytest.raises(ValueError, match=r"columns must be of one length above 0, got \[2, 3\]"):
        bc.Assessment(good | {"speed": np.ones(2)}, {"moment": "N m"})
    with pytest.raises(ValueError, match=r"trucks_a_day must be above 0"):
        bc.Assessment(good, {"moment": "N m"}, trucks_a_day=-1)


def test_words_are_codes_whichever_way_they_come():
    one, other = Words.of(["b", "a", "b"]), Words.of((np.array([0, 1, 0]), ("b", "a", "c")))
    assert [one.names[code] for code in one.codes] == ["b", "a", "b"]
    assert list(other.is_word("b")) == [True, False, True]
    assert not other.is_word("d").any()


@pytest.mark.slow
def test_the_table_goes_to_pandas_parquet_and_csv_and_back(two_roads, tmp_path):
    import pandas as pd

    table = two_roads.to_pandas()
    assert list(table) == list(two_roads.columns)
    assert str(table["kind"].dtype) == "category"
    assert len(table) == len(two_roads) == 80_000
    two_roads.to_parquet(tmp_path / "crossings.parquet")
    pd.testing.assert_frame_equal(pd.read_parquet(tmp_path / "crossings.parquet"), table)
    two_roads.to_csv(tmp_path / "crossings.csv")
    with open(tmp_path / "crossings.csv", encoding="utf-8") as file:
        read = list(csv.DictReader(file))
    assert {"speed [m/s]", "static moment [N m]", "daf moment", "time moment [s]"} <= set(read[0])
    assert [float(row["total moment [N m]"]) for row in read] == table["total moment"].tolist()
    assert [row["quality"] for row in read] == list(table["quality"])


def test_without_pyarrow_is_said_what_to_install(one_road, tmp_path, monkeypatch):
    real = builtins.__import__

    def without(name, *args):
        if name.startswith("pyarrow"):
            raise ImportError(name)
        return real(name, *args)

    monkeypatch.setattr(builtins, "__import__", without)
    with pytest.raises(ImportError, match=r"pip install 'bridgectl\[parquet\]', or write CSV"):
        one_road.to_parquet(tmp_path / "crossings.parquet")


@pytest.mark.slow
def test_a_million_crossings_are_assessed_in_little_memory(tmp_path):
    """Less than 1 GB beside the table, whose kinds are codes of a byte."""
    rng = np.random.default_rng(0)
    static = 1e6 * rng.beta(2, 4, 1_000_000)
    large = columns(static, 1 + 0.1 * rng.random(static.size))
    large |= {"kind": (np.zeros(static.size, dtype=np.uint8), ("van",))}
    tracemalloc.start()
    assessment = bc.Assessment(large, {"moment": "N m"}, **ASKED)
    assessment.characteristic()
    assessment.daf_bins()
    assessment.quantiles()
    assessment.to_parquet(tmp_path / "large.parquet")
    assessment.to_csv(tmp_path / "large.csv")
    assert tracemalloc.get_traced_memory()[1] < 1e9
    tracemalloc.stop()
    assert assessment.columns["kind"].codes.itemsize == 1


@pytest.mark.usefixtures("few_draws")
def test_it_shows_itself_and_its_tables(two_roads):
    assert repr(two_roads) == (
        "Assessment(80000 crossings of trucks up to 400 kN, effects=['moment'], "
        "qualities=['A', 'C'])"
    )
    text = str(two_roads)
    assert all(len(line.rstrip()) <= 100 for line in text.splitlines())
    assert "80000 crossings of 20000 trucks" in text
    assert "50 % artic, 50 % van" in text
    assert "Effects of 1000 years" in text
    assert "+0.050 [+0.050, +0.050]" in text
    assert "dampers in 100 %" in text
    assert repr(two_roads.quality_influence()["C"]).startswith("Estimate(0.05, 95% between 0.05")
    assert repr(two_roads.characteristic(quality="A")).startswith("Characteristic(total=Estimate(")


def test_tables_say_why_there_are_no_characteristic_effects(traffic_of_trucks):
    static, daf = (each[:20] for each in traffic_of_trucks)
    text = table_of(columns(static, daf)).summary(75, method="block maxima")
    assert "No effects of 75 years: block must leave at least 30 blocks" in text
    assert "ADR" not in text


def test_tables_of_identical_trucks_have_no_p_value():
    text = str(table_of(columns(np.full(9, 0.02), np.full(9, 1.25))))
    assert "1.250 [1.250, 1.250]" in text


FIGURES = {
    "exceedances": {"quality": "C"},
    "blocks": {"quality": "A", "method": "block maxima", "damper_share": 0.5},
}


@pytest.mark.slow
@pytest.mark.usefixtures("few_draws")
@pytest.mark.parametrize("options", FIGURES.values(), ids=FIGURES)
def test_the_figure_has_units_and_draws_what_the_methods_tell(two_roads, options):
    figure = two_roads.plot(**options)
    labels = [(axes.get_xlabel(), axes.get_ylabel()) for axes in figure.axes]
    assert labels == [
        ("static moment [kN m]", "DAF [-]"),
        ("moment [kN m]", "share of the crossings below [-]"),
        ("DAF [-]", "share of the crossings below [-]"),
        ("return period [years]", "moment [kN m]"),
        ("quantiles of the fit [kN m]", "peaks [kN m]"),
        ("threshold [kN m]", "mean excess [kN m]"),
    ]
    total = two_roads.characteristic(**options).total
    entries = [text.get_text() for text in figure.axes[3].get_legend().get_texts()]
    assert entries[0].startswith(f"total: {total.value / 1e3:.4g} ({total.low / 1e3:.4g} to")
    FigureCanvasAgg(figure).draw()


@pytest.mark.slow
@pytest.mark.usefixtures("few_draws")
def test_what_has_no_fit_can_be_drawn(traffic_of_trucks):
    """Identical trucks, hogging effects of a short return period, small lengths, other units."""
    static, daf = traffic_of_trucks
    same = columns(np.full(50, 4e5), np.full(50, 1.1))
    figures = [
        table_of(same).plot(),
        table_of(columns(-static, daf)).plot(0.02),
        dataclasses.replace(table_of(columns(1e-8 * static, daf)), effects={"moment": "m"}).plot(),
        dataclasses.replace(table_of(columns(static, daf)), effects={"moment": "m/s^2"}).plot(),
    ]
    labels = [figure.axes[1].get_xlabel() for figure in figures]
    assert labels == ["moment [kN m]", "negative moment [kN m]", "moment [mm]", "moment [m/s^2]"]
    for figure in figures:
        FigureCanvasAgg(figure).draw()
