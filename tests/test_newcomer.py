"""Fifteen things that people want in their first week are scripts of at most 15 lines.

Each runs as it stands, in a folder of its own and with warnings as errors, and what it prints and
finds is compared with a second route.
"""

from __future__ import annotations

import json
import re
import runpy
import shutil
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import control as ct
import numpy as np
import pandas as pd
import pytest
import xarray as xr
from helpers import called_in_c, loop_of_the_control_library, module_of
from scipy.stats import genpareto

import bridgectl as bc
from bridgectl.dampers import Damper

ROOT = Path(__file__).parents[1]
SCRIPTS = {path.stem: path for path in sorted((ROOT / "tests" / "newcomer").glob("*.py"))}
G = 9.81
CHECKS: dict[str, Callable[[Any, list[float], str], None]] = {}
SLOW = {
    "animation_to_html", "envelope_and_hogging", "law_with_filter", "lqg_around_the_crossing",
    "monte_carlo", "own_damper", "sweep_over_damper_bounds",
}  # fmt: skip


SURVEY = module_of(ROOT / "notebooks" / "pages" / "survey.py")


@contextmanager
def run(name: str, folder: Path) -> Iterator[Any]:
    """Run a script in a folder, as its main program, and give what it leaves behind."""
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        SURVEY.survey()
        yield SimpleNamespace(**runpy.run_path(str(SCRIPTS[name]), run_name="__main__"))


def numbers(text: str) -> list[float]:
    return [float(found) for found in re.findall(r"(?<![\w.^])-?\d+(?:\.\d+)?(?![\w/])", text)]


def check(function: Callable[[Any, list[float], str], None]) -> Callable[..., None]:
    """Keep a check under the name of its script."""
    CHECKS[function.__name__] = function
    return function


# The scripts


def test_there_are_fifteen_scripts_and_each_is_checked():
    assert len(SCRIPTS) >= 15
    assert set(CHECKS) == set(SCRIPTS)
    assert set(SCRIPTS) > SLOW


@pytest.mark.parametrize("name", SCRIPTS)
def test_a_script_has_at_most_15_lines_and_says_what_it_does(name):
    text = SCRIPTS[name].read_text(encoding="utf-8")
    assert len([line for line in text.splitlines() if line.strip()]) <= 15
    assert re.match(r'"""[^"\n]+\."""\n', text)
    assert "bc." in text
    assert not re.search(r"bridgectl\.\w*_|\b_[a-z]\w+\(|\bbc\._", text)  # what is public alone


@pytest.mark.parametrize(
    "name", [pytest.param(n, marks=[pytest.mark.slow] * (n in SLOW)) for n in SCRIPTS]
)
def test_a_script_finds_what_another_route_finds(name, tmp_path, capsys):
    with run(name, tmp_path) as left:
        text = capsys.readouterr().out
        CHECKS[name](left, numbers(text), text)


NOTEBOOK = ROOT / "notebooks" / "12_cookbook.ipynb"
RECIPES = [
    "moment_history_for_fatigue", "drive_by_signals", "lqg_around_the_crossing", "law_with_filter",
    "envelope_and_hogging", "daf_percentile", "monte_carlo", "export_to_pandas_and_xarray",
    "animation_to_html", "road_from_gps", "grinding_plan", "damper_in_c",
]  # fmt: skip


def test_the_cookbook_has_its_twelve_recipes_from_the_scripts_in_ten_lines_each():
    cells = json.loads(NOTEBOOK.read_text(encoding="utf-8"))["cells"]
    code = ["".join(cell["source"]).splitlines() for cell in cells if cell["cell_type"] == "code"]
    recipes = [lines for lines in code[1:] if len(lines) > 1]  # others draw, or check
    assert len(recipes) == len(RECIPES)
    for name, lines in zip(RECIPES, recipes, strict=True):
        script = SCRIPTS[name].read_text(encoding="utf-8").splitlines()
        assert set(lines) <= set(script), name
        assert len([line for line in lines if line.strip()]) <= 10, name
        assert not set(code[0]).isdisjoint(script), name


# Second routes


def static_peak(line: Callable[[np.ndarray], np.ndarray], truck: Any, length: float) -> float:
    """Largest static effect [its unit] of axles that creep over an influence line."""
    x = np.linspace(0, length + truck.tire_offsets[-1], 20001)
    tires = x[:, np.newaxis] - truck.tire_offsets
    on = (tires >= 0) & (tires <= length)
    return float((np.where(on, line(tires), 0.0) @ truck.static_loads).max())


def tent(at: float, length: float = 25.0) -> Callable[[np.ndarray], np.ndarray]:
    return lambda x: np.minimum(x * (length - at), at * (length - x)) / length


@check
def animation_to_html(left, printed, text):
    page = Path("crossing.html").read_text(encoding="utf-8")
    assert page.count("data:image/png;base64,iVBOR") == 8 == printed[0]
    assert "<script" in page
    assert left.film.to_jshtml() is not None
    # The truck rolls on evenly: the last picture is as far behind the bridge as it says.
    assert left.film._save_count == 8


@check
def braking(left, printed, text):
    """Of 14 t at 1.4 m on axles 4.5 m apart 17.4 kN move to the front, and overshoot by a half."""
    (_, front, rear), (_, front_braking, rear_braking) = np.reshape(printed, (2, 3))
    moved = 14e3 * 4 * 1.4 / 4.5 / 1e3
    assert moved < front_braking - front < 1.5 * moved
    assert moved < rear - rear_braking < 1.5 * moved
    steady = bc.crossing_response(
        bc.li2006.beam(damping_ratio=0.01), left.truck,
        bc.Motion(40.0, acceleration=[0, -4], changes=[-150]), start=-170,
    )  # fmt: skip
    forces = np.array([steady.outputs[f"tire_force_{i}"] for i in (1, 2)])
    before = forces[:, (steady.time > -1.0) & (steady.time < 0)].mean(axis=1)
    assert (before - left.truck.static_loads) / 1e3 == pytest.approx([moved, -moved], abs=0.4)


@check
def daf_percentile(left, printed, text):
    roads = bc.road.iso8608_elevations(200, "A", 125, seed=1)
    for i in (0, 77):
        road = bc.RoadProfile(left.surface.stations, roads[i])
        expected = bc.daf(bc.li2006.beam(), bc.li2006.car(), left.speeds, road, start=-100)
        assert left.roads_daf[i] == pytest.approx(expected, abs=1e-6)
    assert (left.roads_daf < left.high).mean(axis=0).tolist() == [0.95] * 4
    assert np.reshape(printed, (4, 5))[:, 4] == pytest.approx(left.high, abs=6e-4)


@check
def damper_in_c(left, printed, text):
    """Bridgehook is stiff where the damper takes load off: by the sign of its own costate."""
    assert "damping(arg, res, iw, w, 0);" in text
    assert text.splitlines()[-2:] == [
        "body +0.15 m/s to the axle: 30000 N s/m", "body -0.15 m/s to the axle: 1000 N s/m"
    ]  # fmt: skip
    if shutil.which("cc"):
        once = called_in_c(left.law, Path.cwd())
        signals = dict.fromkeys(bc.dampers.SIGNALS, 0.0) | {"position": 10.0, "body_velocity": 0.05}
        in_c = [once(*(signals | {"suspension_velocity": v}).values()) for v in (0.15, -0.15)]
        assert in_c == [30e3, 1e3]


@check
def drive_by_signals(left, printed, text):
    """Accelerations are second differences of the displacements.

    But for a sixth of what the axle's third derivative jumps by in 1 ms, where the slope does.
    """
    step, slopes = 1e-3, left.road.ramps().heights / 0.1
    jump = 1800e3 / 1000 * left.speed * np.abs(np.diff(slopes)).max()
    for coordinate, kinks in {"y_t": step * jump / 6, "y_s": 0.0}.items():
        moved = np.asarray(left.drive.outputs[coordinate])
        found = np.asarray(left.drive.outputs[f"{coordinate}_ddot"])[1:-1]
        assert found == pytest.approx(np.diff(moved, 2) / step**2, abs=kinks + 5e-3)  # m/s^2
    hop = np.sqrt((80e3 + 1800e3) / 1000) / (2 * np.pi)
    assert printed[1] == pytest.approx(hop, abs=0.7)  # Hz


@check
def envelope_and_hogging(left, printed, text):
    effects = [bc.Moment(10.0), bc.Moment(25.0, sense="smallest")]
    peaks = bc.peak_effect(left.bridge, left.truck, 80 / 3.6, effect=effects)[:, 0] / 1e3
    assert printed[:4] == pytest.approx([peaks[0], 10.0, peaks[1], 25.0], abs=0.51)
    assert 1e3 * peaks[1] / over_the_pier(left.truck) == pytest.approx(printed[4], abs=6e-4)


def over_the_pier(truck: bc.Vehicle) -> float:
    """Static hogging moment of two spans of 25 m [N m], by the theorem of three moments."""
    return -static_peak(lambda x: from_support(x) * (625 - from_support(x) ** 2) / 2500, truck, 50)


def from_support(x: np.ndarray) -> np.ndarray:
    """Distance of a force on two spans of 25 m from the outer support of its span [m]."""
    return np.clip(np.minimum(x, 50 - x), 0, 25)


@check
def export_to_pandas_and_xarray(left, printed, text):
    peak = bc.peak_effect(left.bridge, left.truck, 80 / 3.6)[0] / 1e3
    table = pd.read_csv("crossing.csv", index_col="time")
    assert table["M"].max() / 1e3 == pytest.approx(peak, abs=0.1)  # kN m
    assert printed[0] == pytest.approx(peak, abs=0.1)
    assert list(table.index) == pytest.approx(left.crossing.time, abs=1e-12)
    with xr.open_dataset("surface.nc") as read:
        at_80 = bc.ramp_surface(left.bridge, left.truck, 80 / 3.6)
        row = read["daf_unit"].sel(speed=80 / 3.6, method="nearest")
        assert row.values == pytest.approx(at_80.daf_unit[0], abs=1e-6)


@check
def five_axle_truck(left, printed, text):
    assert sum(printed[:5]) == pytest.approx(40e3 * G / 1e3, rel=2e-3)
    peak = static_peak(tent(12.5), left.truck, 25) / 1e3
    assert left.moments == pytest.approx(left.dafs * peak, rel=1e-5)
    assert np.reshape(printed[5:], (4, 3))[:, 1] == pytest.approx(left.moments, abs=0.51)


@check
def grinding_plan(left, printed, text):
    """Simulated, the ground road does what is printed; it was nowhere filled."""
    ground = left.plans[left.best]
    assert np.all(ground <= left.height)
    for heights, daf in ((left.height, printed[4]), (ground, printed[5])):
        road = bc.RoadProfile(left.surface.stations, heights)
        dafs = bc.daf(bc.li2006.beam(), bc.li2006.car(), left.speeds, road, start=-50)
        assert dafs.max() == pytest.approx(daf, abs=6e-4)
    assert printed[5] < printed[4] - 0.02


class ByHand:
    """The filtered skyhook in Python's own arithmetic, as a strategy is asked."""

    slow = 0.0

    def gains_for(self, *_):
        return {}

    def for_leg(self, _):
        return self

    for_speed = for_leg

    def with_gains(self):
        return self

    def command(self, body_velocity, suspension_velocity, **_):
        fast = body_velocity - self.slow
        self.slow += 1.26 * 2e-3 * fast
        return 30e3 if fast * suspension_velocity > 0 else 1e3


@check
def law_with_filter(left, printed, text):
    """As `control.input_output_response` has it from sample to sample, with a filter by hand."""
    by_hand = SimpleNamespace(strategy=ByHand(), max_force=np.inf, lag=0.0, sample_time=2e-3)
    beam, truck, speed, road = left.case
    found = loop_of_the_control_library(beam, truck, by_hand, speed, road)
    passive = bc.daf(*left.case, start=road.x[0], method="control")[0]
    assert printed == pytest.approx([found, passive], abs=6e-4)


@check
def lqg_around_the_crossing(left, printed, text):
    """Separation: the poles of the loop at mid-span are the regulator's and the filter's."""
    p, force = left.p, left.p.B[:, 1:]
    middle = ct.linearize(left.loop, 0, t=12.5 / left.c).poles()
    apart = [np.linalg.eigvals(p.A - force @ left.k), np.linalg.eigvals(p.A - left.f @ p.C)]
    assert np.sort_complex(middle) == pytest.approx(np.sort_complex(np.hstack(apart)), rel=1e-4)
    road = bc.iso8608_profile("B", 45, seed=1, start=-20)
    passive = bc.daf(left.beam, left.truck, left.c, road, start=-20)[0]
    assert printed[0] == pytest.approx(passive, abs=1e-3)
    assert printed[3] < 0.6 * printed[1]  # the body is calmer
    assert printed[2] > printed[0]  # the bridge is not


@check
def measured_modes(left, printed, text):
    """As a beam of the first mode's rigidity: the five places and the second mode cost 2 %."""
    rigidity = 18358 * (2 * np.pi * 4.1) ** 2 * (25 / np.pi) ** 4
    beam = bc.Beam(25, 18358, rigidity, n_modes=2, damping_ratio=(0.012, 0.02))
    for row in np.reshape(printed, (3, 3)):
        peak = bc.peak_effect(beam, left.truck, row[0] / 3.6, effect=bc.Deflection())[0]
        assert row[1] == pytest.approx(1e3 * peak, rel=0.02)


@check
def meeting(left, printed, text):
    """Histories of the two, of which one is the other's mirror image, added up: within 2 %."""
    one = bc.crossing_response(
        left.bridge, left.truck, 80 / 3.6, effects={"M": bc.Moment()}, tail=2.0
    )
    for late, moment, ratio in np.reshape(printed, (3, 3)):
        second = np.interp(one.time - late / (80 / 3.6), one.time, one.outputs["M"])
        both = (one.outputs["M"] + 0.6 * second).max()
        assert moment == pytest.approx(both / 1e3, rel=0.02)
        assert ratio == pytest.approx(1e3 * moment / left.alone, abs=6e-3)
    assert printed[2] == 1.6


@check
def moment_at_04_l(left, printed, text):
    static = 10e3 * G * 10 * 15 / 25 / 1e3
    rows = np.reshape(printed, (4, 3))
    assert rows[:, 1] == pytest.approx(rows[:, 2] * static, rel=1e-3)
    along = bc.envelope(left.bridge, left.truck, 80 / 3.6, at=[10.0])
    assert rows[1, 1] == pytest.approx(along.largest[0] / 1e3, abs=0.06)


@check
def moment_history_for_fatigue(left, printed, text):
    """The two largest half cycles reach from the highest point to the lowest before and behind."""
    moment = np.asarray(left.crossing.outputs["M"]) / 1e3
    before, after = (part.min() for part in np.split(moment, [moment.argmax()]))
    assert printed[:4:2] == pytest.approx([moment.max() - after, moment.max() - before], abs=0.06)
    assert printed[1:4:2] == [0.5, 0.5]
    peak = bc.peak_effect(left.bridge, left.truck, 80 / 3.6, left.road, start=-100)[0]
    assert moment.max() == pytest.approx(peak / 1e3, abs=0.5)
    # Cycles go up and down by their size, and all together as far as the moment does.
    way = np.abs(np.diff(moment)).sum()
    assert 2 * sum(size * count for size, _, count, _, _ in left.cycles) == pytest.approx(way)
    fifth = sum(count * size**5 for size, _, count, _, _ in left.cycles)
    assert printed[-1] ** 5 == pytest.approx(fifth, rel=1e-3)


@check
def monte_carlo(left, printed, text):
    """Crossings one by one, quantiles by counting, and a tail of all exceedances by likelihood."""
    columns = left.traffic.columns
    for i in (0, 41, 299):
        truck = left.fleet.passing(int(columns["truck"][i]))
        peaks = [
            bc.peak_effect(left.bridge, truck.vehicle, truck.speed, road, start=-100)[0]
            for road in left.roads
        ]
        assert min(abs(peak / columns["total moment"][i] - 1) for peak in peaks) < 1e-5
    assert (columns["daf moment"] < printed[0]).mean() == pytest.approx(0.5, abs=0.01)
    total = columns["total moment"]
    assert left.level.total.value > total.max()
    threshold = np.quantile(total, 0.85)
    shape, _, scale = genpareto.fit(total[total > threshold] - threshold, floc=0)
    chance = 1 / (75 * 250 * 1500) / (total > threshold).mean()
    rare = threshold + genpareto.isf(chance, shape, 0, scale)
    assert left.level.total.low < rare < left.level.total.high


@check
def own_damper(left, printed, text):
    """As `control.input_output_response` has it from sample to sample, valve and all."""
    case, mine = (left.bridge, left.truck), Damper(left.sinking, lag=0.01)
    found = loop_of_the_control_library(*case, mine, 80 / 3.6, left.roads[0])
    own = bc.daf(*case, 80 / 3.6, left.roads[0], start=-20, damper=mine)[0]
    assert own == pytest.approx(found, abs=1e-4)
    dafs = [bc.daf(*case, 80 / 3.6, road, start=-20, damper=mine)[0] for road in left.roads]
    assert printed[3] == pytest.approx(np.mean(dafs), abs=6e-4)
    passive = [bc.daf(*case, 80 / 3.6, road, start=-20)[0] for road in left.roads]
    assert printed[0] == pytest.approx(np.mean(passive), abs=6e-4)


@check
def road_from_gps(left, printed, text):
    """The survey's own road, to 0.1 m/km (noise adds, the mean over a step takes off), and DAF."""
    true = SURVEY.survey().resample(0.25, start=-100, stop=25).detrend()
    assert left.short.iri() == pytest.approx(true.iri(), abs=0.1)
    daf = bc.daf(bc.li2006.beam(), bc.li2006.car(), 80 / 3.6, true, start=-100)[0]
    assert left.daf == pytest.approx(daf, abs=5e-3)
    assert printed[-2:-1] == pytest.approx([left.daf], abs=6e-4)


@check
def shear_at_support(left, printed, text):
    static = static_peak(lambda x: 1 - x / 25, left.truck, 25) / 1e3
    assert printed == pytest.approx([left.daf * static, left.daf], abs=0.06)
    assert left.peak / 1e3 == pytest.approx(left.daf * static, rel=1e-4)


@check
def sweep_over_damper_bounds(left, printed, text):
    """A damper that keeps 7 kN s/m is the truck's own, and a wider range does no harm."""
    rows = np.reshape(printed, (4, 3))
    passive = [bc.daf(left.bridge, left.truck, 22.0, road, start=-20)[0] for road in left.roads]
    assert rows[0, 2] == pytest.approx(np.mean(passive), abs=6e-4)
    assert rows[:, 2].argmin() == 3
    assert rows[3, 2] < rows[0, 2] - 0.01


@check
def two_axle_truck(left, printed, text):
    """Loads by levers about the other axle."""
    front = (14e3 * 1.7 / 4.5 + 700) * G / 1e3
    rear = (14e3 * 2.8 / 4.5 + 1100) * G / 1e3
    assert printed[:2] == pytest.approx([front, rear], abs=0.06)
    dafs = bc.daf(
        bc.li2006.beam(damping_ratio=0.01), left.truck, left.speeds, left.road, start=-100
    )
    static = static_peak(tent(12.5), left.truck, 25) / 1e3
    assert printed[7::2] == pytest.approx(dafs * static, abs=0.6)


@check
def two_spans(left, printed, text):
    """Closed forms: sines, a span clamped at the pier, and static peaks by three moments."""
    first = np.pi / 2 / 25**2 * np.sqrt(4.865e10 / 18358)
    assert printed[:3] == pytest.approx([first, first * (3.9266 / np.pi) ** 2, 4 * first], abs=6e-3)
    (_, sag, _), (_, hog, hogging), (_, force, reaction) = np.reshape(printed[3:], (3, 3))
    assert hog == pytest.approx(hogging * over_the_pier(left.truck) / 1e3, abs=1.0)
    line = lambda x: from_support(x) * (3 - (from_support(x) / 25) ** 2) / 50  # noqa: E731
    assert force == pytest.approx(reaction * static_peak(line, left.truck, 50) / 1e3, abs=0.6)
    along = bc.envelope(left.bridge, left.truck, 80 / 3.6, at=[10.0])
    assert sag == pytest.approx(along.largest[0] / 1e3, abs=0.6)
