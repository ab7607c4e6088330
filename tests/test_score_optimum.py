"""How much of the gap to the clairvoyant optimum strategies close: found, told and drawn."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from helpers import run_command

import bridgectl as bc
from bridgectl.dampers import Damper, bridgehook, clairvoyant, passive, simulate_loop, skyhook
from bridgectl.measures import weighted_rms
from bridgectl.plots.scores import score_figure
from bridgectl.scoring import run as scoring
from bridgectl.scoring.agreement import gap_closed
from bridgectl.scoring.text import score_text

BEAM, TRUCK = bc.li2006.beam(9, n_modes=1), bc.li2006.car()
SPEEDS = np.array([100, 80]) / 3.6
STRATEGIES = [
    passive(7e3), passive(1e3), bridgehook(BEAM, TRUCK, 1e3, 30e3),
    skyhook(1e3, 30e3).renamed("preview 10 m"), skyhook(3e3, 9e3).renamed("preview 5 m"),
    skyhook(2e3, 20e3).renamed("preview 20 m"),
]  # fmt: skip


@pytest.fixture(scope="module")
def roads():
    return [bc.iso8608_profile("A", 11, seed=seed, start=-2) for seed in range(2)]


def scored(roads, strategies, speeds, **options):
    options = {"approach": 2, "workers": 1, **options}
    return bc.score(strategies, BEAM, TRUCK, roads, speeds, **options)


@pytest.fixture(scope="module")
def file(tmp_path_factory):
    return tmp_path_factory.mktemp("score") / "score.jsonl"


@pytest.fixture(scope="module")
def found(roads, file):
    return scored(roads, STRATEGIES[:3], SPEEDS[:1], clairvoyant=True, resume=file)


@pytest.fixture(scope="module")
def board(roads):
    """Six strategies at two speeds, with an optimum that is 0.05 and 0.1 below the first."""
    plain = scored(roads, STRATEGIES, SPEEDS)
    optimum = {name: values[0] + 0.0 for name, values in plain.values.items()}
    return replace(plain, optimum=optimum | {"daf": optimum["daf"] - [0.05, 0.1]})


def test_the_optimum_is_the_clairvoyants_within_the_range_of_all_strategies(found, roads):
    # Where the damping does not matter to the peak, another datum of the road may change it.
    road = bc.RoadProfile(roads[1].x, roads[1].elevation - roads[1].elevation[0])
    alone = clairvoyant(BEAM, TRUCK, SPEEDS[0], road, 1e3, 30e3, start=-2)
    assert found.optimum["daf"].shape == (2, 1)
    assert found.optimum["daf"][1, 0] == pytest.approx(alone.daf, abs=1e-6)
    assert np.all(found.optimum["daf"] < found.values["daf"])
    loop = simulate_loop(
        BEAM, TRUCK, alone.damper, SPEEDS[0], road.x, road.elevation,
        record=["body_acceleration"],
    )  # fmt: skip
    ride = weighted_rms(loop.histories[0]["body_acceleration"][0], 5e-3)
    assert found.optimum["weighted_acceleration"][1, 0] == pytest.approx(ride, rel=1e-6)


def test_gaps_closed_are_ratios_of_mean_gains(found):
    first, soft, hook = found.values["daf"].mean(axis=(1, 2))
    gap = first - found.optimum["daf"].mean()
    assert found.gap_closed("bridgehook").share == pytest.approx((first - hook) / gap, abs=1e-12)
    assert found.gap_closed("passive 1 kN s/m").share == pytest.approx((first - soft) / gap)
    assert found.gap_closed("passive 7 kN s/m") == (0, 0, 0)
    rows = {row.strategy: row for row in found.rows()}
    assert rows["bridgehook"].gap_closed == found.gap_closed("bridgehook")


@pytest.mark.slow
def test_optima_that_a_file_has_are_not_sought_again(found, roads, file, monkeypatch):
    def never(*_):
        raise AssertionError("it is in the file")

    monkeypatch.setattr(scoring, "optimum_part", never)
    again = scored(roads, STRATEGIES[:3], SPEEDS[:1], clairvoyant=True, resume=file)
    assert again.to_json() == found.to_json()
    plain = scored(roads, STRATEGIES[:3], SPEEDS[:1], resume=file)
    assert plain.optimum == {}
    with pytest.raises(AssertionError, match="it is in the file"):  # another range of dampings
        scored(roads, STRATEGIES[:1], SPEEDS[:1], clairvoyant=True, resume=file)


@pytest.mark.slow
def test_at_each_speed_the_gap_is_that_speeds(board):
    daf = board.values["daf"]
    for j, (speed, gap) in enumerate(zip(SPEEDS, (0.05, 0.1), strict=True)):
        share = (daf[0, :, j] - daf[2, :, j]).mean() / gap
        assert board.gap_closed("bridgehook", speed).share == pytest.approx(share)
    with pytest.raises(ValueError, match=r"speed must be one of the board's, .* got 3"):
        board.gap_closed("bridgehook", 3.0)


def test_the_interval_is_near_that_of_the_linearised_ratio():
    """Delta method, 400 roads: ends within a tenth of the interval's width."""
    rng = np.random.default_rng(1)
    first = 1.05 + 0.03 * rng.standard_normal(400)
    own = first - 0.06 + 0.02 * rng.standard_normal(400)
    best = first - 0.1 + 0.03 * rng.standard_normal(400)
    share, low, high = gap_closed(first, own, best)
    spread = np.std((first - own) - share * (first - best)) / np.sqrt(400) / (first - best).mean()
    assert share == pytest.approx(0.6, abs=0.05)
    assert low == pytest.approx(share - 1.96 * spread, abs=0.4 * spread)
    assert high == pytest.approx(share + 1.96 * spread, abs=0.4 * spread)


def test_small_gaps_mean_nothing_and_single_roads_have_no_interval(board):
    daf = np.array([1.01, 1.03])
    assert np.all(np.isnan(gap_closed(daf, daf, daf - 0.0019)))
    assert gap_closed(daf, daf - 0.01, daf - 0.0021).share == pytest.approx(0.01 / 0.0021)
    share, *ends = gap_closed(daf[:1], daf[:1] - 0.01, daf[:1] - 0.02)
    assert share == pytest.approx(0.5)
    assert np.all(np.isnan(ends))
    assert np.all(np.isnan(replace(board, optimum={}).gap_closed("bridgehook")))


@pytest.mark.slow
def test_tables_and_json_have_the_gap_of_each_crossing_and_of_all(board):
    frame = board.to_pandas()
    row = frame.loc[("bridgehook", board.roads[0], SPEEDS[1])].iloc[0]  # roads of one name
    daf = board.values["daf"][:, 0, 1]
    assert row["gap_closed"] == pytest.approx((daf[0] - daf[2]) / 0.1)
    assert row["daf_optimum"] == pytest.approx(daf[0] - 0.1)
    close = replace(board, optimum={"daf": board.values["daf"][0] - 1e-3})
    assert close.to_pandas()["gap_closed"].isna().all()
    content = json.loads(board.to_json())
    summary = {row["strategy"]: row for row in content["summary"]}
    assert summary["bridgehook"]["gap_closed"] == board.gap_closed("bridgehook")._asdict()
    assert content["optimum"]["daf"] == board.optimum["daf"].tolist()
    by_speed = content["gap_closed_by_speed"]["bridgehook"]
    assert by_speed[1]["share"] == board.gap_closed("bridgehook", SPEEDS[1]).share
    without = json.loads(replace(board, optimum={}).to_json())
    assert without["optimum"] == without["gap_closed_by_speed"] == {}
    assert "gap_closed" not in replace(board, optimum={}).to_pandas()


def test_the_text_has_a_table_of_gaps_only_if_the_optimum_is_known(board):
    text = score_text(board)
    table = text[text.index("How near the clairvoyant optimum") : text.index("gap closed: how")]
    rows = {line[:20].strip(): line.split() for line in table.splitlines()}
    assert rows["clairvoyant"][1] == f"{board.optimum['daf'].mean():.4f}"
    share, low, high = board.gap_closed("bridgehook")
    told = [f"{value:.2f}" for value in (share, low, high)]
    assert rows["bridgehook"][2:5] == told
    by_speed = [board.gap_closed("bridgehook", speed).share for speed in SPEEDS]
    assert rows["bridgehook"][5:] == [f"{min(by_speed):.2f}", ["100", "80"][np.argmin(by_speed)]]
    assert rows["passive 7 kN s/m"][-5:] == ["-"] * 5
    close = replace(board, optimum={"daf": board.values["daf"][0]})
    assert "nan" not in score_text(close)
    assert "clairvoyant" not in score_text(replace(board, optimum={}))


@pytest.mark.slow
def test_with_control_from_the_bridges_start_a_bound_is_proven(roads):
    """Strategies that hold their damping as the bound has it are above it, within 0.003."""
    laws = [Damper(law, sample_time=5e-3) for law in STRATEGIES[:3]]
    near = scored(roads, laws, SPEEDS[:1], approach=0, clairvoyant=True)
    proven = near.optimum["daf_bound"]
    assert proven.shape == (2, 1)
    assert np.all(near.values["daf"] > proven - 0.003)
    assert near.optimum["daf"] == pytest.approx(proven, abs=0.01)
    assert f"a mean DAF below\n{proven.mean():.4f};" in score_text(near)
    assert near.to_pandas()["daf_bound"].to_numpy()[0] == proven[0, 0]


@pytest.mark.slow
def test_further_before_the_bridge_and_of_too_many_dampings_no_bound_is_told(found, roads):
    assert np.isnan(found.optimum["daf_bound"]).all()
    assert "No bound is proven" in score_text(found)
    assert json.loads(found.to_json())["optimum"]["daf_bound"] == [[None], [None]]
    slow = scored(roads[:1], STRATEGIES[:1], 2.0, approach=0, clairvoyant=True)
    assert np.isnan(slow.optimum["daf_bound"]).all()


@pytest.mark.slow
def test_the_figure_has_the_optimum_and_previews_in_the_order_of_their_distance(board):
    figure = score_figure(board)
    ax, below = figure.axes[0], figure.axes[2]
    assert ax.get_ylabel() == "body acceleration weighted by W_k, rms [m/s²]"
    lines = {line.get_label(): line.get_xydata() for line in ax.lines}
    means = [board.values[name].mean(axis=(1, 2)) for name in ("daf", "weighted_acceleration")]
    points = np.column_stack(means)
    assert lines["preview distances"] == pytest.approx(points[[4, 3, 5]])  # 5, 10, 20 m
    best = [board.optimum[name].mean() for name in ("daf", "weighted_acceleration")]
    assert lines["clairvoyant"] == pytest.approx(np.array([best]))
    assert "clairvoyant" in {text.get_text() for text in ax.texts}
    curve = next(line for line in below.lines if line.get_label() == "clairvoyant")
    assert curve.get_ydata() == pytest.approx(board.optimum["daf"].mean(axis=0)[::-1])
    plain = score_figure(replace(board, optimum={}))
    assert "clairvoyant" not in {line.get_label() for line in plain.axes[0].lines}


def test_the_command_line_takes_it(capsys):
    """With one constant damper the range is empty: the optimum is that damper."""
    status, out, err = run_command(
        capsys, "score", "--approach", "2", "--speeds", "80", "--workers", "1", "--span", "9",
        "--modes", "1", "--strategies", "passive", "--random", "0", "--clairvoyant", "--json",
    )  # fmt: skip
    assert (status, err) == (0, "")
    content = json.loads(out)
    assert content["optimum"]["daf"][0] == pytest.approx(content["values"]["daf"][0][0], abs=1e-4)
    assert content["summary"][0]["gap_closed"]["share"] is None


def test_clairvoyant_must_be_true_or_false(roads):
    with pytest.raises(TypeError, match="clairvoyant must be True or False"):
        scored(roads, STRATEGIES[:1], SPEEDS, clairvoyant="yes")
