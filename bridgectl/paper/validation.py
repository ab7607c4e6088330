"""Section 4 of Li, OBrien and Gonzalez (2006) again: DAE against DAF on good roads and spans."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import closing
from dataclasses import dataclass
from functools import lru_cache
from itertools import product
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bridgectl import _checks as check
from bridgectl._checks import FloatArray
from bridgectl._progress import track
from bridgectl._units import from_kmh, to_kmh
from bridgectl._workers import check_scheduler, in_processes
from bridgectl.linear.lift_off import LiftOffWarning
from bridgectl.linear.runs import linear_contact, prepare
from bridgectl.model.beam import Beam
from bridgectl.model.crossing import Crossing
from bridgectl.paper import li2006
from bridgectl.paper.good_roads import EXTREME_SPAN, good_roads
from bridgectl.paper.printed import SEGMENT, SPEEDS_KMH
from bridgectl.road import RoadProfile, iso8608_elevations
from bridgectl.simulate import crossing_response, daf, ramp_surface
from bridgectl.surface.surface import RampSurface
from bridgectl.surface.trust import TOLERANCE, dae_trust

SPANS = (15, 25, 35)
"""Spans of Figs. 8, 9 and 11 [m]."""

STARTS = (0.0, 200.0)
"""Approaches [m]: none, at rest where the bridge begins (Figs. 8, 9), and that of Fig. 11."""

PEAK_TOLERANCE = 0.002
"""What the median difference of the peaks over speed of DAE and DAF is to stay below."""

SUPERPOSED_TOLERANCE = 1e-6
"""What superposed and simulated DAF are to differ by less than, while the tires stay down."""

N_RANDOM, PART, SEED = 1000, 100, 8608
"""Random roads that the warning light is tried on, how many at once, and their seed."""


class Peak(NamedTuple):
    """The largest amplification over the speeds, found by `validate`."""

    value: float
    """Amplification [-]."""
    speed: float
    """Where it is [m/s]."""

    def __repr__(self) -> str:
        return f"Peak({self.value:.4f} at {to_kmh(self.speed):g} km/h)"


@dataclass(frozen=True, eq=False)
class Case:
    """One road on one bridge: amplifications over speed, found by `validate`."""

    span: float
    """Length of the bridge [m]."""
    approach: float
    """Length of the road before it that counts [m]."""
    road: int
    """Number of the road, from 1."""
    speeds: FloatArray
    """Speeds c [m/s], shape (n_speeds,), as of all arrays."""
    smooth: FloatArray
    """DAF of a smooth road."""
    dae: FloatArray
    """DAE of Eq. (15)."""
    superposed: FloatArray
    """Superposed DAF; where a tire leaves the road, the simulated one."""
    simulated: FloatArray
    """Simulated DAF."""
    flying: NDArray[np.bool_]
    """Where a tire leaves the road."""
    lift_off: float | None
    """First place where a tire leaves the road at any of those speeds [m]."""

    def __repr__(self) -> str:
        return (
            f"Case(road {self.road} on {self.span:g} m after {self.approach:g} m, peak DAF "
            f"{self.daf_peak.value:.4f} at {to_kmh(self.daf_peak.speed):g} km/h, peak DAE "
            f"{self.dae_peak.value:.4f} at {to_kmh(self.dae_peak.speed):g} km/h)"
        )

    @property
    def daf_peak(self) -> Peak:
        """Largest simulated DAF."""
        return _peak(self.speeds, self.simulated)

    @property
    def dae_peak(self) -> Peak:
        """Largest DAE."""
        return _peak(self.speeds, self.dae)

    @property
    def peak_difference(self) -> float:
        """Largest DAE minus largest DAF, each at its own speed."""
        return self.dae_peak.value - self.daf_peak.value

    @property
    def rms_error(self) -> float:
        """Root mean square over the speeds of DAE minus DAF."""
        return float(np.sqrt(np.mean((self.dae - self.simulated) ** 2)))

    @property
    def largest_error(self) -> Peak:
        """Largest size of DAE minus DAF, and the speed where it is."""
        return _peak(self.speeds, np.abs(self.dae - self.simulated))

    @property
    def superposed_error(self) -> float:
        """Largest size of superposed minus simulated DAF, where the tires stay down."""
        difference = np.abs(self.superposed - self.simulated)[~self.flying]
        return float(difference.max(initial=0.0))


class WarningLight(NamedTuple):
    """How well `bridgectl.dae_trust` tells of large errors of the DAE: made by `validate`."""

    tolerance: float
    """Error of the DAE that is large [-]."""
    crossings: int
    """Roads times speeds."""
    large: int
    """Crossings of a large error."""
    lit: int
    """Crossings where the light is on."""
    both: int
    """Crossings of a large error where it is."""

    def __repr__(self) -> str:
        return (
            f"WarningLight({self.large} of {self.crossings} crossings with errors above "
            f"{self.tolerance:g}, precision {self.precision:.3g}, recall {self.recall:.3g})"
        )

    @property
    def precision(self) -> float:
        """Share of the crossings with the light on that have a large error."""
        return self.both / max(self.lit, 1)

    @property
    def recall(self) -> float:
        """Share of the large errors that the light tells of."""
        return self.both / max(self.large, 1)


@dataclass(frozen=True, eq=False)
class ValidationResults:
    """Amplifications of roads on bridges, found by `validate`."""

    roads: tuple[RoadProfile, ...]
    """The roads; a case has the number of its own, from 1."""
    speeds: FloatArray
    """Speeds c [m/s], shape (n_speeds,)."""
    cases: tuple[Case, ...]
    """Every road on every bridge with every approach: by span, approach and road."""
    light: WarningLight
    """How well the DAE's warning light tells of large errors, on many random roads."""

    def __repr__(self) -> str:
        kmh = to_kmh(self.speeds)
        return (
            f"ValidationResults({len(self.cases)} cases of {len(self.roads)} roads, {kmh.size} "
            f"speeds from {kmh.min():g} to {kmh.max():g} km/h, median difference of peaks "
            f"{self.median_difference:.2g})"
        )

    @property
    def iri(self) -> FloatArray:
        """IRI of each road [m/km]."""
        return np.array([road.resample(SEGMENT).iri() for road in self.roads])

    @property
    def groups(self) -> dict[tuple[float, float], list[Case]]:
        """Cases of each span and approach [m]."""
        found: dict[tuple[float, float], list[Case]] = {}
        for case in self.cases:
            found.setdefault((case.span, case.approach), []).append(case)
        return found

    @property
    def median_difference(self) -> float:
        """Median over the cases of the size of the difference of the peaks [-]."""
        return float(np.median([abs(case.peak_difference) for case in self.cases]))

    @property
    def median_differences(self) -> dict[float, float]:
        """The same for the cases of each span [m] alone."""
        spans = sorted({case.span for case in self.cases})
        return {
            span: float(np.median([abs(c.peak_difference) for c in self.cases if c.span == span]))
            for span in spans
        }

    @property
    def peak_tolerance(self) -> float:
        """What the median difference of the peaks is to stay below [-]."""
        return PEAK_TOLERANCE

    @property
    def worst_peak(self) -> Case:
        """The case whose peaks differ most."""
        return max(self.cases, key=lambda case: abs(case.peak_difference))

    @property
    def worst_superposed(self) -> Case:
        """The case whose superposed DAF is furthest from the simulated one."""
        return max(self.cases, key=lambda case: case.superposed_error)


def validate(
    speeds: ArrayLike | None = None,
    spans: Sequence[int] = SPANS,
    starts: Sequence[float] = STARTS,
    roads: Sequence[RoadProfile] | None = None,
    n_random: int = N_RANDOM,
    progress: bool = True,
    workers: int | None = None,
    scheduler: str | None = None,
) -> ValidationResults:
    """Compare DAE and superposed DAF with the simulated DAF, as Section 4 of the paper does.

    The paper's truck crosses its bridges (15 m solid, 25 m Y-beam, 35 m super-Y-beam; undamped,
    three modes, exact recovery) at `speeds` [m/s], from rest where the bridge begins or after an
    approach [m] of `starts`; the warning light is tried on `n_random` random roads. `workers` and
    `scheduler` are those of `bridgectl.score`.

    The moment of the static load has a kink at mid-span. While it holds the peak there, with each
    ramp and with the road, DAF is linear in the road and the DAE is exact. Where it does not, as
    on the short bridge, the DAE falls short: a maximum is convex in the road.
    """
    check_scheduler(scheduler)
    c = check.speeds(from_kmh(SPEEDS_KMH) if speeds is None else speeds)
    if not len(spans) or not len(starts) or (roads is not None and not len(roads)):
        raise ValueError("spans, starts and roads must hold one value each at least")
    approaches = [check.not_negative("starts", start, unit="m") for start in starts]
    beams = [li2006.beam(span) for span in spans]
    every = good_roads() if roads is None else tuple(roads)
    for road in every:
        road.require(-max(approaches), max(beam.length for beam in beams), "the validation")
    count = check.integer("n_random", n_random, at_least=2)
    pairs = list(product(beams, approaches))
    jobs: list[tuple[Any, ...]] = [(_cases, beam, c, approach, every) for beam, approach in pairs]
    jobs += [(_lights, c, part) for part in _random_roads(count)]
    found: dict[int, Any] = {}
    with closing(in_processes(_do, jobs, workers, scheduler)) as done:
        for index, result in track(done, "Roads on bridges", len(jobs), show=progress):
            found[index] = result
    cases = tuple(case for i in range(len(pairs)) for case in found[i])
    counts = np.sum([found[i] for i in range(len(pairs), len(jobs))], axis=0)
    return ValidationResults(every, c, cases, WarningLight(TOLERANCE, *map(int, counts)))


def _do(job: Callable[..., Any], *arguments: Any) -> Any:
    return job(*arguments)


def _random_roads(n_roads: int) -> list[FloatArray]:
    """Random roads that the light is tried on, class A and B by halves, in parts."""
    half = n_roads // 2
    roads = [
        iso8608_elevations(number, name, float(EXTREME_SPAN), SEGMENT, seed=SEED)
        for number, name in ((half, "A"), (n_roads - half, "B"))
    ]
    return np.array_split(np.vstack(roads), max(1, n_roads // PART))


def _lights(speeds: FloatArray, roads: FloatArray) -> list[int]:
    """Try the light on some random roads, on the paper's bridge."""
    surface = _light_surface(tuple(speeds))
    trust = dae_trust(surface, roads)
    with warnings.catch_warnings(action="ignore", category=LiftOffWarning):
        error = np.abs(surface.dae(roads) - surface.superposed_daf(roads))
    large, lit = error > TOLERANCE, ~trust.trusted
    return [large.size, large.sum(), lit.sum(), (large & lit).sum()]


@lru_cache(maxsize=1)
def _light_surface(speeds: tuple[float, ...]) -> RampSurface:
    """Make the surface that all random roads share, once in each process."""
    return ramp_surface(li2006.beam(EXTREME_SPAN), li2006.car(), speeds)


def _cases(
    beam: Beam, speeds: FloatArray, approach: float, roads: Sequence[RoadProfile]
) -> list[Case]:
    """Every road on one bridge."""
    return list(_each_case(ramp_surface(beam, li2006.car(), speeds, approach=approach), roads))


def _each_case(surface: RampSurface, roads: Sequence[RoadProfile]) -> Iterator[Case]:
    """Every road on one bridge; the superposed histories of all in one product."""
    # The simulations tell of tires that leave the road.
    with warnings.catch_warnings(action="ignore", category=LiftOffWarning):
        superposed = surface.superposed_daf(roads)
    for number, road in enumerate(roads, 1):
        exact, (simulated, flew) = superposed[number - 1], _simulated(surface, road)
        flying, place = np.zeros(len(surface.speeds), dtype=bool), None
        if flew:
            with warnings.catch_warnings(action="ignore", category=LiftOffWarning):
                flying, place = _flights(surface, road)
        yield Case(
            surface.beam.length, surface.approach, number, surface.speeds, surface.daf_smooth,
            surface.dae(road), exact, simulated, flying, place,
        )  # fmt: skip


def _simulated(surface: RampSurface, road: RoadProfile) -> tuple[FloatArray, bool]:
    """Simulated DAF, and whether a tire leaves the road at any speed."""
    with warnings.catch_warnings(record=True, action="always", category=LiftOffWarning) as told:
        values = daf(surface.beam, surface.vehicle, surface.speeds, road, start=-surface.approach)
    return values, any(issubclass(warning.category, LiftOffWarning) for warning in told)


def _flights(surface: RampSurface, road: RoadProfile) -> tuple[NDArray[np.bool_], float | None]:
    """At which speeds a tire leaves the road, and the first place of any of them [m]."""
    beam, vehicle, start = surface.beam, surface.vehicle, -surface.approach
    run = prepare(Crossing(beam, vehicle), road, start)
    flying = ~linear_contact(run, surface.speeds)
    places = []
    for speed in surface.speeds[flying]:
        response = crossing_response(beam, vehicle, float(speed), road, start=start)
        off = np.asarray(response.outputs)[response.output_labels.index("tire_force")] <= 0
        places += list(response.time[off][:1] * speed)
    return flying, float(min(places)) if places else None


def _peak(speeds: FloatArray, values: FloatArray) -> Peak:
    at = int(np.argmax(values))
    return Peak(float(values[at]), float(speeds[at]))
