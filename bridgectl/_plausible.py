"""Whether what a user gives can be meant: units and order of arguments, judged in one place.

A number may be in range and yet not what its user thinks: tonnes for kg, km/h for m/s, arguments
that changed places. The public functions have what they are given judged here, once; what the
package then makes of it is not judged again.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import chain
from typing import Any, TypeAlias

import numpy as np

from bridgectl._checks import FloatArray
from bridgectl._units import from_kmh, to_kmh
from bridgectl._warn import asker, warn

# The modules of these classes import this one.
Beam: TypeAlias = Any
Crossing: TypeAlias = Any
Damper: TypeAlias = Any
Fitted: TypeAlias = Any
QuarterCar: TypeAlias = Any
RoadProfile: TypeAlias = Any
Vehicle: TypeAlias = Any

FASTEST = 60.0
"""No road vehicle crosses a bridge so fast [m/s]: 216 km/h, or 60 km/h without its unit."""

LIGHTEST_VEHICLE = 50.0
"""Vehicles lighter than this [kg] have their masses in tonnes."""

LONGEST_SPAN = 3000.0
"""[m]; the longest suspension bridges have 2 km."""

DECK_MASS = (100.0, 2e5)
"""Mass per length of decks [kg/m]: footbridges of 500, motorways of some 60 000, with room."""

SCATTER = 6.0
"""How far f_1 may be from 82 L^-0.9, either way, as a factor.

f_1 = 82 L^-0.9 of road bridges (P. Paultre, O. Chaallal, J. Proulx, Can. J. Civ. Eng. 19 (1992)
260-278); 95.4 L^-0.933 of 224 bridges (R. Cantieni, EMPA report 211, 1983) is the same within 10 %.
Single bridges are within a factor of three, railway bridges included. A thousandfold rigidity or
mass is a factor of 32.
"""

MOST_DAMPED = 0.2
"""No bridge has a larger damping ratio; in percent, all have."""

BODY, HOP = (0.1, 20.0), (2.0, 100.0)
"""Frequencies [Hz] of a body on its springs and of an axle between spring and tire, with room."""

MOVING_FORCE = 5e-3
"""Vehicles slower than this [Hz] are soft on purpose: a constant force on wheels, which textbooks
send over bridges at any speed."""

STIFFER_SPRING = 6.0
"""How many times stiffer than the tire a suspension may be: stiff leaf springs are 3.5 times."""

SUSPENSION_DAMPING = (1e-3, 4.0)
"""Damping ratios of a body on its suspension that are not 0, with room."""

STEEL_WHEEL = 1e8
"""Stiffness [N/m] above which a tire is the contact of a wheel with its rail, or a rigid one."""

STIFFEST_WHEEL = 8e3
"""How many times stiffer than the suspension such a contact is at most."""

LIGHTEST_AXLE, SOFTEST_TIRE = 10.0, 1e4
"""Axles lighter [kg] have their mass in tonnes, tires softer [N/m] their stiffness in kN/m."""

FIRMEST = 50.0
"""Largest damping of a damper over the suspension's critical damping."""

SLOWEST_SAMPLE, SLOWEST_LAG, WEAKEST, NOISIEST, LOST = 0.1, 2.0, 100.0, 1.0, 100.0
"""A damper's sample time [s], lag [s], force limit [N], noise [m/s] and error of position [m] that
are no use any more."""

WRONGEST = 0.5
"""And share by which its speed, or the way that it counts, is wrong."""

SHAKIEST, LOOSEST = 50.0, 0.1
"""And noise of its accelerometers [m/s^2] and of its travel [m]."""

ROUGHEST = 0.35
"""Largest rms slope of a road about its grade [m/m]: class G has 0.29 at steps of 0.1 m."""

STEEPEST = 0.01
"""Largest grade [m/m] on which a vehicle may start as if the road before it were level."""

SMOOTHEST = (1e-6, 0.05)
"""IRI [m/km] of no measured road: a new runway has 0.5, a class D road in m read as mm 0.01, one
that is drawn level 0 but for round-off."""


class PlausibilityWarning(UserWarning):
    """An argument is in range, but can hardly be meant: its unit or place may be another."""


def judge_beam(beam: Beam) -> None:
    """Warn of a beam that is no bridge."""
    _tell(_beam_doubts(beam))


def judge_quarter_car(car: QuarterCar) -> None:
    """Warn of a quarter-car that is no road vehicle."""
    _tell(chain(_weight_doubts(car.linear), _quarter_car_doubts(car)))


def judge_vehicle(vehicle: Vehicle) -> None:
    """Warn of a vehicle that is no road vehicle."""
    _tell(chain(_weight_doubts(vehicle), _vehicle_doubts(vehicle)))


def judge_truck(vehicle: Vehicle) -> None:
    """Warn of a vehicle from parts that is no road vehicle."""
    _tell(chain(_weight_doubts(vehicle), _truck_doubts(vehicle)))


def judge_crossing(
    crossing: Crossing, speeds: float | FloatArray, *roads: RoadProfile | None
) -> None:
    """Warn of speeds, roads or a vehicle that do not go with the bridge."""
    force = crossing.linear.frequencies[0] <= MOVING_FORCE
    if asker() == "user" and not force:  # the command line judges speeds in its own unit
        name, fastest = "speed" if np.ndim(speeds) == 0 else "speeds", float(np.max(speeds))
        judge_speed(name, fastest)
    judge_load(crossing)
    judge_roads(*roads)


def judge_speed(name: str, speed: float) -> None:
    """Warn of a speed [m/s] of no truck."""
    _tell(speed_doubts(name, speed, f"for {speed:.4g} km/h type {speed:.4g} / 3.6"))


def judge_load(crossing: Crossing) -> None:
    """Warn of a vehicle that does not go with the bridge."""
    _tell(load_doubts(crossing))


def judge_roads(*roads: RoadProfile | None) -> None:
    """Warn of roads that are too rough to be driven, or have a grade."""
    _tell(chain.from_iterable(road_doubts(road) for road in roads if road is not None))


def judge_damper(damper: Damper) -> None:
    """Warn of a damper whose units are others than s, N and m/s."""
    _tell(_damper_doubts(damper))


def judge_range(car: Vehicle | QuarterCar, *devices: Fitted | None) -> None:
    """Warn of dampings that are nothing, or all, beside what a vehicle needs."""
    dampers = (damper for each in devices if each is not None for damper in each.dampers)
    _tell(chain.from_iterable(_range_doubts(car, damper) for damper in dampers))


def judge_kmh(option: str, speeds: FloatArray) -> None:
    """Warn of speeds [km/h] on the command line."""
    _tell(speed_doubts(option, from_kmh(float(speeds.max())), "type km/h, as 80"))


def judge_smoothness(name: str, iri: float) -> None:
    """Warn of a road with an IRI [m/km] below that of any, but not level."""
    if SMOOTHEST[0] < iri < SMOOTHEST[1]:
        doubt = (
            f"{name}: an IRI of {iri:.2g} m/km is smoother than any road (a new one has 1): are "
            "its elevations in m, and not in mm? Correct or pass their unit"
        )
        _tell(iter([doubt]))


def _tell(doubts: Iterator[str]) -> None:
    """Tell the first doubt: those after it have mostly the same cause."""
    if asker() != "package" and (doubt := next(doubts, None)) is not None:
        warn(doubt, PlausibilityWarning)


def speed_doubts(name: str, fastest: float, remedy: str) -> Iterator[str]:
    if fastest >= FASTEST:
        yield (
            f"{name} of {fastest:.4g} m/s ({to_kmh(fastest):.4g} km/h) is faster than any road "
            f"vehicle: {remedy}"
        )


def _beam_doubts(beam: Beam) -> Iterator[str]:
    length, mass, rigidity = beam.length, beam.mass_per_length, beam.flexural_rigidity
    given = (
        f"length={length:g} [m], mass_per_length={mass:g} [kg/m], "
        f"flexural_rigidity={rigidity:g} [N m^2]"
    )
    lightest, heaviest = DECK_MASS
    if not 1.0 <= length <= LONGEST_SPAN:
        in_mm = LONGEST_SPAN < length < 1e3 * LONGEST_SPAN
        remedy = f"for {length:g} mm type length={length / 1e3:g}, else " if in_mm else ""
        yield (
            f"length = {length:g} m is no span of a bridge: {remedy}check the order of the "
            f"arguments, which are {given}"
        )
    if mass < lightest:
        yield (
            f"mass_per_length = {mass:g} kg/m is lighter than any deck: for {mass:g} t/m type "
            f"mass_per_length={1000 * mass:g}"
        )
    if mass > heaviest:
        yield (
            f"mass_per_length = {mass:g} kg/m is heavier than any deck: if it is the mass of the "
            f"whole span [kg] type mass_per_length={mass / length:g}, else check the order of the "
            f"arguments, which are {given}"
        )
    usual, found = 82 * length**-0.9, float(beam.frequencies[0])
    if not usual / SCATTER <= found <= usual * SCATTER:
        remedy = _beam_remedy(beam, found / usual)
        yield (
            f"the first frequency of the beam is {found:.3g} Hz; bridges of {length:g} m have "
            f"{usual / SCATTER:.2g} to {usual * SCATTER:.2g} Hz: {remedy}; given were {given}"
        )
    ratio = float(beam.damping_ratios[0])
    if ratio > MOST_DAMPED:
        yield (
            f"damping_ratio = {ratio:g} is {100 * ratio:g} percent of critical damping, more than "
            f"any bridge has: for {ratio:g} percent type damping_ratio={ratio / 100:g}"
        )


# Argument, factor to its own unit, and what to type: value is what was given, right what it means.
_BEAM_SLIPS = (
    ("flexural_rigidity", 1e3, "for {value:g} kN m^2 type flexural_rigidity={right:g}"),
    ("flexural_rigidity", 1e6, "for {value:g} MN m^2 type flexural_rigidity={right:g}"),
    ("flexural_rigidity", 1e9, "for E in GPa type flexural_rigidity={right:g}"),
    (
        "flexural_rigidity", 3.5e10,
        "if it is J [m^4] alone type flexural_rigidity=E*{value:g}, with E [N/m^2]",
    ),
    ("flexural_rigidity", 1e-8, "for J in cm^4 type flexural_rigidity={right:g}"),
    ("flexural_rigidity", 1e-12, "for J in mm^4 type flexural_rigidity={right:g}"),
    ("mass_per_length", 1e3 / 9.81, "for {value:g} kN/m type mass_per_length={right:.5g}"),
    ("length", 1e-2, "for {value:g} cm type length={right:g}"),
)  # fmt: skip

# How f_1 over the usual one, 82 L^-0.9, goes with each argument.
_POWERS = {"flexural_rigidity": 0.5, "mass_per_length": -0.5, "length": -1.1}


def _beam_remedy(beam: Beam, ratio: float) -> str:
    """The slip that explains best a first frequency of `ratio` times the usual one."""

    def unexplained(name: str, factor: float) -> float:
        return abs(float(np.log(ratio) + _POWERS[name] * np.log(factor)))

    possible = [slip for slip in _BEAM_SLIPS if slip[0] != "length" or beam.length > 300]
    name, factor, text = min(possible, key=lambda slip: unexplained(*slip[:2]))
    if unexplained(name, factor) >= np.log(SCATTER):
        return "flexural_rigidity is E [N/m^2] times J [m^4]"
    value = getattr(beam, name)
    return text.format(value=value, right=value * factor)


def _weight_doubts(vehicle: Vehicle) -> Iterator[str]:
    if vehicle.mass < LIGHTEST_VEHICLE:
        yield (
            f"the vehicle's mass is {vehicle.mass:g} kg: are its masses in tonnes? Pass kg, for "
            f"{vehicle.mass:g} t type masses of {1000 * vehicle.mass:g} in all"
        )


def _quarter_car_doubts(car: QuarterCar) -> Iterator[str]:
    body, axle = car.sprung_mass, car.unsprung_mass
    spring, tire, damping = car.suspension_stiffness, car.tire_stiffness, car.damping
    if body < axle:
        in_t = f"for {body:g} t type sprung_mass={1000 * body:g}"
        yield (
            f"sprung_mass = {body:g} kg (the body) is lighter than unsprung_mass = {axle:g} kg "
            f"(the axle): {in_t if body < LIGHTEST_VEHICLE else 'exchange the two'}"
        )
    if spring > STIFFER_SPRING * tire:
        in_kn = f"for {tire:g} kN/m type tire_stiffness={1000 * tire:g}"
        yield (
            f"suspension_stiffness = {spring:g} N/m is far stiffer than tire_stiffness = {tire:g} "
            f"N/m: {in_kn if tire < SOFTEST_TIRE else 'exchange the two'}"
        )
    both = float(np.sqrt(1 / (1 / spring + 1 / tire) / body) / (2 * np.pi))
    if not BODY[0] <= both <= BODY[1]:
        yield (
            f"the body moves at {both:.3g} Hz, vehicles at {BODY[0]:g} to {BODY[1]:g} Hz: check "
            f"sprung_mass = {body:g} kg and suspension_stiffness = {spring:g} N/m; for {spring:g} "
            f"kN/m type suspension_stiffness={1000 * spring:g}"
        )
    hop = float(np.sqrt((spring + tire) / axle) / (2 * np.pi))
    rail = STEEL_WHEEL <= tire <= STIFFEST_WHEEL * spring
    if not (HOP[0] <= hop <= HOP[1] or rail):
        remedy = f"for {tire:g} kN/m type tire_stiffness={1000 * tire:g}"
        if hop > HOP[1]:
            in_t = f"for {axle:g} t type unsprung_mass={1000 * axle:g}"
            remedy = in_t if axle < LIGHTEST_AXLE else "tires have 1e5 to 1e7 N/m"
        yield (
            f"the axle moves at {hop:.3g} Hz, vehicles' at {HOP[0]:g} to {HOP[1]:g} Hz: check "
            f"unsprung_mass = {axle:g} kg and tire_stiffness = {tire:g} N/m; {remedy}"
        )
    critical = 2 * float(np.sqrt(spring * body))
    if damping > 0 and not SUSPENSION_DAMPING[0] <= damping / critical <= SUSPENSION_DAMPING[1]:
        remedy = f"for {damping:g} kN s/m type damping={1000 * damping:g}"
        if damping < 1:
            remedy = f"for a ratio of {damping:g} type damping={damping * critical:.3g}"
        elif damping > critical:
            remedy = f"check that suspension_stiffness = {spring:g} N/m and it are in place"
        yield (
            f"damping = {damping:g} N s/m is {damping / critical:.2g} of the suspension's critical "
            f"damping, {critical:.3g} N s/m: {remedy}"
        )


def _damper_doubts(damper: Damper) -> Iterator[str]:
    step, lag, force, noise = (
        damper.sample_time, damper.lag, damper.max_force, damper.velocity_noise
    )  # fmt: skip
    if step > SLOWEST_SAMPLE:
        yield f"sample_time = {step:g} s is slow for any law: for {step:g} ms type {step / 1e3:g}"
    if lag > SLOWEST_LAG:
        yield f"lag = {lag:g} s is longer than any damper's: for {lag:g} ms type {lag / 1e3:g}"
    if force < WEAKEST:
        yield f"max_force = {force:g} N holds nothing: for {force:g} kN type {force * 1e3:g}"
    if noise > NOISIEST:
        yield f"velocity_noise = {noise:g} m/s hides all: for {noise:g} mm/s type {noise / 1e3:g}"
    for name in ("position_error", "position_deviation"):
        if abs(error := getattr(damper, name)) > LOST:
            yield f"{name} = {error:g} m misses the bridge: for {error:g} mm type {error / 1e3:g}"
    for name in ("position_drift", "speed_error"):
        if abs(share := getattr(damper, name)) > WRONGEST:
            yield f"{name} = {share:g} is more than any: for {share:g} % type {share / 100:g}"
    if (shaky := damper.acceleration_noise) > SHAKIEST:
        yield (
            f"acceleration_noise = {shaky:g} m/s^2 hides all: for {shaky:g} mm/s^2 type "
            f"{shaky / 1e3:g}"
        )
    if (loose := damper.travel_noise) > LOOSEST:
        yield f"travel_noise = {loose:g} m hides all: for {loose:g} mm type {loose / 1e3:g}"
    if (blurred := damper.preview_noise) > LOOSEST:
        yield f"preview_noise = {blurred:g} m hides all: for {blurred:g} mm type {blurred / 1e3:g}"
    if (old := damper.preview_delay) > SLOWEST_LAG:
        yield f"preview_delay = {old:g} s is older than any: for {old:g} ms type {old / 1e3:g}"


def _critical(vehicle: Vehicle | QuarterCar) -> float:
    """Critical damping of a suspension [N s/m]; of a vehicle about that of its stiffest."""
    linear = vehicle.linear
    mass = getattr(vehicle, "sprung_mass", linear.mass / len(linear.damper_map))
    axles = linear.damper_axles
    springs = ((axles @ linear.stiffness_matrix) * axles).sum(axis=1)
    return 2 * float(np.sqrt(springs.max() * mass))


def _range_doubts(car: Vehicle | QuarterCar, damper: Damper) -> Iterator[str]:
    largest = damper.strategy.c_max
    critical = _critical(car)
    judged, remedy = "", ""
    if 0 < largest < SUSPENSION_DAMPING[0] * critical:
        judged, remedy = "nothing", f"for {largest:g} kN s/m type {1000 * largest:g}"
    if largest > FIRMEST * critical:
        judged, remedy = "a rigid link", f"pass N s/m, as {critical:.2g}"
    if judged:
        yield (
            f"damper {damper.strategy.name!r} of at most {largest:g} N s/m is {judged} beside the "
            f"suspension's critical damping, {critical:.3g} N s/m: {remedy}"
        )


def _vehicle_doubts(vehicle: Vehicle) -> Iterator[str]:
    lowest = float(vehicle.frequencies[0])
    if lowest > MOVING_FORCE and not BODY[0] <= lowest <= BODY[1]:
        yield (
            f"the vehicle's lowest frequency on a rigid road is {lowest:.3g} Hz, vehicles have "
            f"{BODY[0]:g} to {BODY[1]:g} Hz: check mass_matrix [kg], stiffness_matrix and "
            "tire_stiffnesses [N/m]; for kN/m type 1e3 * stiffness"
        )


def _truck_doubts(truck: Vehicle) -> Iterator[str]:
    lowest, highest = truck.frequencies[[0, -1]]
    if not BODY[0] <= lowest <= BODY[1]:
        yield (
            f"the truck's lowest frequency on a rigid road is {lowest:.3g} Hz, trucks have "
            f"{BODY[0]:g} to {BODY[1]:g} Hz: check mass [kg], inertia [kg m^2], "
            "suspension_stiffness and tire_stiffness [N/m]; for kN/m type 1e3 * stiffness"
        )
    elif highest > HOP[1]:
        yield (
            f"an axle moves at {highest:.3g} Hz, trucks' at {HOP[1]:g} Hz at most: check its mass "
            "[kg], the inertia of its group [kg m^2] and tire_stiffness [N/m]"
        )


def load_doubts(crossing: Crossing) -> Iterator[str]:
    vehicle, beam = crossing.linear, crossing.beam
    known = [getattr(beam, name, None) for name in ("flexural_rigidity", "mass_per_length")]
    if not all(isinstance(value, float) for value in known):  # of others less is known
        return
    if vehicle.mass > beam.mass and next(_beam_doubts(beam), None) is None:
        yield (
            f"the vehicle ({vehicle.mass:g} kg) is heavier than the bridge ({beam.mass:g} kg): is "
            "mass_per_length in tonnes? Pass kg/m"
        )


def road_doubts(road: RoadProfile) -> Iterator[str]:
    steps = np.diff(road.x)
    slopes = np.diff(road.elevation) / steps
    grade = float(np.average(slopes, weights=steps))
    rms = float(np.sqrt(np.average((slopes - grade) ** 2, weights=steps)))
    if rms > ROUGHEST:
        yield (
            f"the road's slope has an rms of {rms:.2g} m/m, more than any road: are its elevations "
            "in mm (or another unit)? Type RoadProfile(x, elevation / 1000)"
        )
    if abs(grade) > max(STEEPEST, rms):
        yield (
            f"the road has a grade of {grade:.1%} and the vehicle starts as on a level one, which "
            "is a kink: take the grade off, type road.detrend()"
        )
