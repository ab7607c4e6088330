"""Whether the class DAE orders dampers: what is compared, counted and told."""

import json
from itertools import combinations

import numpy as np
import pytest
from helpers import run_command
from matplotlib.backends.backend_agg import FigureCanvasAgg
from scipy.stats import kendalltau

import bridgectl as bc
from bridgectl.cli.dampers import print_damper_validation
from bridgectl.dampers import simulate_loop
from bridgectl.paper import damper_validation
from bridgectl.paper.damper_sets import known_dampers, unseen_dampers
from bridgectl.paper.damper_validation import DamperCase, validate_dampers
from bridgectl.plots.validation import damper_validation_figure
from bridgectl.road import iso8608_elevations
from bridgectl.scoring.agreement import paired

SMALL = ("validate", "--dampers", "--spans", "9", "--speeds", "110", "--pairs", "2")


def late_dampers(beam, car):
    return [d for d in unseen_dampers(beam, car) if d.strategy.name.endswith("0 ms late")]


@pytest.fixture(scope="module")
def cases():
    """Of three dampers that are known, and two that are not."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(damper_validation, "known_dampers", lambda *of: known_dampers(*of)[:3])
        patch.setattr(damper_validation, "unseen_dampers", late_dampers)
        return validate_dampers(110 / 3.6, [9], 2, approach=5, workers=1)


def made_case(n=5, n_pairs=6, seed=1):
    """A case of random numbers, with levels that differ."""
    rng = np.random.default_rng(seed)
    level = np.linspace(1, 1.1, n)[:, np.newaxis, np.newaxis, np.newaxis]
    daf = level + 0.01 * rng.normal(size=(n, 2, n_pairs, 3))
    dae, dae_2 = daf + 0.02 * rng.normal(size=(2, *daf.shape))
    mean = level.ravel() + 0.03 * rng.normal(size=n)
    return DamperCase(25.0, "A", tuple("abcdefg"[:n]), n - 2, daf, dae, dae_2, mean)


def test_there_are_23_known_dampers_and_more_than_six_unseen_ones_of_other_names(bridge, truck):
    known, unseen = known_dampers(bridge, truck), unseen_dampers(bridge, truck)
    assert (len(known), len(unseen)) == (23, 11)
    assert known[0].strategy.name == "passive 7 kN s/m"
    assert len({damper.strategy.name for damper in (*known, *unseen)}) == 34


def test_roads_are_those_of_a_class_and_their_mirror_images(cases):
    """Simulated again for one damper, within 1e-6; and its class DAE from its own surface."""
    beam, car, x = bc.li2006.beam(9), bc.li2006.car(), -5 + 0.1 * np.arange(141)
    for case, name, seed in zip(cases, "AB", (1306, 1307), strict=True):
        assert (case.span, case.road_class, case.n_known) == (9, name, 3)
        i = case.dampers.index("bridgehook, 20 ms late")
        law = late_dampers(beam, car)[i - 3]
        z = iso8608_elevations(2, name, 14, seed=seed)
        loop = simulate_loop(beam, car, law, 110 / 3.6, x, np.vstack([z, -z]))
        assert case.daf[i].ravel() == pytest.approx(loop.daf.ravel(), abs=1e-6)
        surface = bc.ramp_surface(
            beam, car, 110 / 3.6, approach=5, ramp_height=name, both_ways=True, every=10,
            damper=law,
        )  # fmt: skip
        assert case.class_dae[i] == pytest.approx(surface.class_dae(name).mean.mean())
        both = surface.dae(np.vstack([z, -z]), order=2)
        assert case.dae_2[i].ravel() == pytest.approx(both.ravel(), abs=1e-9)


def test_the_mean_of_eq_15_over_mirror_images_is_the_smooth_daf(cases):
    beam, car = bc.li2006.beam(9), bc.li2006.car()
    own = bc.daf(beam, car, 110 / 3.6, start=-5)
    for case in cases:
        assert case.mean_eq_15[0] == pytest.approx(own[0], abs=1e-5)


def test_orders_and_errors_are_those_of_their_definitions():
    case = made_case()
    pairs = case.daf.mean(axis=(1, 3))  # by damper and pair of road and mirror image
    assert case.mean_daf == pytest.approx(case.daf.mean(axis=(1, 2, 3)))
    assert case.tau.tau == pytest.approx(kendalltau(case.class_dae, case.mean_daf).statistic)
    known = kendalltau(case.class_dae[:3], case.mean_daf[:3]).statistic
    assert case.tau_known.tau == pytest.approx(known)
    clear = [p for p in combinations(range(5), 2) if paired(pairs[p[0]] - pairs[p[1]]).clear]
    wrong = {
        (case.dampers[i], case.dampers[j])
        for i, j in clear
        if (case.mean_daf[i] - case.mean_daf[j]) * (case.class_dae[i] - case.class_dae[j]) <= 0
    }
    assert case.clear_pairs == (len(clear) - len(wrong), len(clear))
    assert {(each.lower, each.higher) for each in case.wrong} == wrong
    differences = [each.daf_difference for each in case.wrong]
    assert differences == sorted(differences, reverse=True)
    assert min(differences) > 0
    assert all(each.dae_difference <= 0 for each in case.wrong)
    rms = np.sqrt(np.mean((case.dae_2 - case.daf) ** 2)) / np.sqrt(
        np.mean((case.dae - case.daf) ** 2)
    )
    assert case.error_ratio == pytest.approx(rms)
    added, told = case.mean_daf - case.mean_eq_15, case.class_dae - case.mean_eq_15
    slope, correlation = np.polyfit(added, told, 1)[0], np.corrcoef(added, told)[0, 1]
    assert case.share == pytest.approx((slope, correlation))
    assert repr(case).startswith("DamperCase(5 dampers on 25 m, class A, tau ")


def test_the_tables_have_every_case_and_the_sentences_what_falls_short(capsys):
    good = made_case()
    good = DamperCase(**{**vars_of(good), "class_dae": good.mean_daf})
    poor = DamperCase(**{**vars_of(good), "class_dae": -good.mean_daf, "road_class": "B"})
    print_damper_validation([good])
    assert "As many as required in every case." in capsys.readouterr().out
    print_damper_validation([good, poor])
    out = capsys.readouterr().out
    assert "Fewer than required: 25 m, class B: 0 of 10 clear pairs, 0.9 required" in out
    assert "5 dampers on 12 roads of each class, half of them mirror images, 3 speeds" in out
    worst = poor.wrong[0]
    line = next(each for each in out.splitlines() if f"+{worst.daf_difference:.4f}" in each)
    assert line.split() == [
        "25", "m", "B", worst.lower, worst.higher, f"{worst.daf_difference:+.4f}",
        f"{worst.dae_difference:+.4f}",
    ]  # fmt: skip
    assert max(map(len, out.splitlines())) <= 100


def vars_of(case):
    names = ("span", "road_class", "dampers", "n_known", "daf", "dae", "dae_2", "class_dae")
    return {name: getattr(case, name) for name in names}


def test_the_figure_has_every_damper_of_every_case():
    cases = [made_case(seed=1), made_case(seed=2)]
    cases[1] = DamperCase(**{**vars_of(cases[1]), "road_class": "B"})
    figure = damper_validation_figure(cases)
    assert [axes.get_xlabel() for axes in figure.axes] == ["", "simulated mean DAF [-]"]
    for axes, case in zip(figure.axes, cases, strict=True):
        lines = {line.get_label(): line.get_xydata() for line in axes.lines}
        drawn = np.vstack([xy for label, xy in lines.items() if label.startswith("class DAE")])
        assert drawn == pytest.approx(np.column_stack([case.mean_daf, case.class_dae]))


@pytest.mark.parametrize("n_spans", [1, 2, 3])
def test_the_legend_fits_below_any_number_of_bridges(n_spans):
    cases = [DamperCase(**{**vars_of(made_case()), "span": 15.0 + i}) for i in range(n_spans)]
    figure = damper_validation_figure(cases)
    renderer = FigureCanvasAgg(figure).get_renderer()
    figure.draw(renderer)
    legend = figure.legends[0].get_window_extent(renderer)
    assert figure.bbox.contains(*legend.min)
    assert figure.bbox.contains(*legend.max)


@pytest.mark.parametrize(
    ("change", "error", "message"),
    [
        ({"spans": []}, ValueError, r"spans must hold one value at least, got none: type \[25\]"),
        ({"spans": [26]}, ValueError, "span"),
        ({"n_pairs": 1}, ValueError, "n_pairs must be 2 or more, got 1"),
        ({"speeds": -3}, ValueError, "speeds"),
    ],
)
def test_each_mistake_is_named_before_the_work(change, error, message):
    with pytest.raises(error, match=message):
        validate_dampers(**{"speeds": 25.0, "spans": [9], "n_pairs": 2, **change})


@pytest.mark.slow
def test_the_command_prints_draws_and_keeps(capsys, tmp_path, monkeypatch):
    monkeypatch.setattr(damper_validation, "known_dampers", lambda *of: known_dampers(*of)[:3])
    monkeypatch.setattr(damper_validation, "unseen_dampers", lambda *of: unseen_dampers(*of)[:2])
    kept, picture = tmp_path / "dampers.jsonl", tmp_path / "dampers.png"
    options = (*SMALL, "--workers", "1", "--resume", kept)
    status, out, err = run_command(capsys, *options, "--plot", picture)
    assert (status, err) == (0, "")
    assert picture.stat().st_size > 10_000
    assert [path.name for path in tmp_path.glob("*.jsonl")] == ["dampers-9m.jsonl"]
    # All is kept: nothing is computed the second time.
    monkeypatch.setattr("bridgectl.scoring.run._part", None)
    status, again, _ = run_command(capsys, *options, "--json")
    assert status == 0
    content = json.loads(again)
    first = content["cases"][0]
    assert (first["span_m"], first["road_class"], len(first["dampers"])) == (9, "A", 5)
    assert f"{first['clear_pairs']['right']} of {first['clear_pairs']['number']}" in out


def test_an_interruption_says_where_it_goes_on(capsys, tmp_path, monkeypatch):
    def stopped(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr(damper_validation, "score", stopped)
    status, _, err = run_command(capsys, *SMALL, "--resume", tmp_path / "kept.jsonl")
    assert status == 130
    assert "kept.jsonl keeps what is done, the same command goes on from there" in err


@pytest.mark.parametrize(
    ("options", "says"),
    [
        (("--pairs", "3"), "--pairs goes with --dampers: add it, or leave --pairs out"),
        (("--resume", "x.jsonl"), "--resume goes with --dampers"),
        (("--workers", "0"), "--workers must be 1 or more, got 0"),
        (("--dampers", "--pairs", "1"), "--pairs must be 2 or more, got 1"),
        (("--dampers", "--workers", "0"), "--workers must be 1 or more, got 0"),
        (("--dampers", "--spans", "26"), "span"),
        (("--dampers", "--resume", "nowhere/x.jsonl"), "--resume"),
    ],
)
def test_a_mistake_is_one_line_and_status_2(capsys, options, says):
    status, out, err = run_command(capsys, "validate", *options)
    assert (status, out) == (2, "")
    assert says in err
    assert err.count("\n") == 1


@pytest.mark.slow
def test_the_class_dae_orders_dampers_on_a_bridge_where_eq_15_does_not():
    """35 m, 12 pairs of road and mirror image at 2 speeds; all of it takes `validate --dampers`."""
    speeds = np.array([75, 110]) / 3.6
    for case in validate_dampers(speeds, [35], 12, approach=50, workers=1):
        assert case.tau_eq_15.tau < 0.3
        assert case.tau.tau > 0.7
        assert case.clear_pairs.share >= 0.9
        assert case.far_pairs.share >= 0.97
