"""Eight good roads like those of Li, OBrien and Gonzalez (2006), Fig. 8(a)."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache

import numpy as np

from bridgectl._units import from_kmh
from bridgectl.extremes import extreme_road
from bridgectl.paper import li2006
from bridgectl.paper.printed import SEGMENT, SPEEDS_KMH
from bridgectl.road import RoadProfile, iso8608_profile, utia_road
from bridgectl.simulate import ramp_surface
from bridgectl.surface.surface import RampSurface

FIRST, LAST = -200.0, 35.0
"""Ends of the eight roads [m]: the longest approach, and the end of the longest bridge."""

PLACES = (678.0, 940.0)
"""Stations of the measured road where a bridge is put [m]."""

EXTREME_SPAN, EXTREME_RAMP = 25, 0.5e-3
"""For which span [m] roads 7 and 8 are made, and of ramps up to what height [m].

That is the rms ramp of an ISO 8608 class A road (0.46 mm): the extremes differ from good roads by
the order of their ramps and not by their size. No tire leaves them, and their IRI is 2 m/km.
"""


@cache
def good_roads() -> tuple[RoadProfile, ...]:
    """Return eight roads like those of the paper's Fig. 8(a), each of an IRI below 7 m/km.

    Two stretches of a measured road, three random roads of ISO 8608 class A and B and one of the
    measured road's spectrum; and as its profiles 7 and 8 two made for extremes of the DAF: the
    largest DAE, and the smallest maximum over the speeds, of ramps up to 0.5 mm under the truck
    on the 25 m bridge with 200 m of approach.

    Returns
    -------
    tuple of RoadProfile
        From x = -200 m to 35 m every 0.1 m, without their grade.

    References
    ----------
    Y. Li, E. OBrien, A. Gonzalez, J. Sound Vib. 293 (2006) 125-137, Section 4 and Fig. 8(a).

    Examples
    --------
    >>> from bridgectl.paper.good_roads import good_roads
    >>> for road in good_roads():
    ...     print(f"{road.name}: IRI {road.iri():.1f} m/km")
    1 measured, UTIA at 678 m: IRI 3.0 m/km
    2 measured, UTIA at 940 m: IRI 3.4 m/km
    3 random, ISO 8608 class A: IRI 2.2 m/km
    4 random, another of class A: IRI 2.1 m/km
    5 random, ISO 8608 class B: IRI 4.2 m/km
    6 random, spectrum of UTIA: IRI 2.9 m/km
    7 made for the largest DAF: IRI 1.8 m/km
    8 made for the smallest DAF: IRI 2.3 m/km
    """
    surface = ramp_surface(
        li2006.beam(EXTREME_SPAN), li2006.car(), from_kmh(SPEEDS_KMH),
        approach=-FIRST, ramp_length=SEGMENT,
    )  # fmt: skip
    roads = [
        *_measured_and_random(),
        ("made for the largest DAF", _extreme(surface, largest=True)),
        ("made for the smallest DAF", _extreme(surface, largest=False)),
    ]
    return tuple(
        road._measured_as(road.measured_step, f"{number} {name}")
        for number, (name, road) in enumerate(roads, 1)
    )


def _measured_and_random() -> Iterator[tuple[str, RoadProfile]]:
    """Roads 1 to 6 and what they are."""
    measured = utia_road()
    for place in PLACES:
        road = measured.place_bridge(place).crop(FIRST, LAST)
        yield f"measured, UTIA at {place:g} m", _stations(road.detrend())
    fit = measured.psd().fit()
    spectra: list[tuple[str, str | float, float]] = [
        ("ISO 8608 class A", "A", 2.0),
        ("another of class A", "A", 2.0),
        ("ISO 8608 class B", "B", 2.0),
        ("spectrum of UTIA", fit.roughness, fit.waviness),
    ]
    for seed, (what, roughness, waviness) in enumerate(spectra, 1):
        road = iso8608_profile(
            roughness, LAST - FIRST, SEGMENT, seed=seed, start=FIRST, waviness=waviness
        )
        yield f"random, {what}", _stations(road.detrend())


def _extreme(surface: RampSurface, *, largest: bool) -> RoadProfile:
    """Road of the largest, or smallest maximum, DAE over the speeds, level behind the bridge."""
    found = extreme_road(surface, max_ramp=EXTREME_RAMP, largest=largest, progress=False).road
    level = np.append(found.elevation, found.elevation[-1])
    return _stations(RoadProfile(np.append(found.x, LAST), level))


def _stations(road: RoadProfile) -> RoadProfile:
    """The road at the ends of the ramps, at elevation 0 where the bridge begins."""
    return road.resample(SEGMENT, start=FIRST, stop=LAST).level()
