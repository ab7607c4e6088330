"""Parts of a truck: axles, alone or in groups, and the bodies that stand on them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from bridgectl import _checks

ALONE = (0.0,)
"""Spread of an axle that is in no group."""


@dataclass(frozen=True, repr=False)
class Axle:
    """An axle, or a group of axles on one suspension (a bogie): tandem, tridem.

    Parameters
    ----------
    place : float
        Place under the body [m], positive backward; of a group that of its suspension, which is
        at its centre of gravity.
    mass : float
        Unsprung mass, of a group in all [kg].
    suspension_stiffness, damping : float
        Of both sides together, and of a group in all [N/m] and [N s/m]. Default: no damping.
    tire_stiffness, tire_damping : float or sequence of float
        Of the tires of one axle together [N/m] and [N s/m]; in a group one number for each of its
        axles, or one for each. Default: no damping.
    name : str, optional
        Name of its damper. Default: 'front' and 'rear' of two, 'axle_1', ... of several.
    spread : sequence of float, optional
        Of a group, places of its axles behind `place` [m], as (-1.1, 0, 1.1).
    inertia : float, optional
        Of a group, its pitch moment of inertia [kg m^2].

    Raises
    ------
    TypeError, ValueError
        If a parameter has the wrong kind or range; the message names it.

    Examples
    --------
    >>> import bridgectl as bc
    >>> bc.trucks.Axle(2.5, 1000, 8e5, 3.5e6, damping=2e4, name="drive")
    Axle('drive' at 2.5 m, mass=1000 kg, 1 axle)
    >>> bc.trucks.Axle(4.0, 2250, 2.25e6, 3.5e6, spread=(-1.1, 0, 1.1), inertia=200)
    Axle(at 4 m, mass=2250 kg, 3 axles)
    """

    place: float
    mass: float
    suspension_stiffness: float
    tire_stiffness: float | Sequence[float]
    damping: float = 0.0
    tire_damping: float | Sequence[float] = 0.0
    name: str = ""
    spread: Sequence[float] = ALONE
    inertia: float = 0.0

    def __post_init__(self) -> None:
        spread = ALONE
        if self.spread is not ALONE:
            spread = tuple(_checks.array("spread", self.spread, (None,), unit="m").tolist())
        if not spread or any(b <= a for a, b in pairwise(spread)):
            raise ValueError(f"spread must rise from front to rear [m], got {self.spread}")
        n = len(spread)
        checked = {
            "place": _checks.number("place", self.place, unit="m"),
            "mass": _checks.positive("mass", self.mass, unit="kg"),
            "suspension_stiffness": _checks.positive(
                "suspension_stiffness", self.suspension_stiffness, unit="N/m"
            ),
            "damping": _checks.not_negative("damping", self.damping, unit="N s/m"),
            "tire_stiffness": _of_axles("tire_stiffness", self.tire_stiffness, n, "N/m"),
            "tire_damping": _of_axles("tire_damping", self.tire_damping, n, "N s/m"),
            "inertia": _checks.not_negative("inertia", self.inertia, unit="kg m^2"),
            "spread": spread,
        }
        for name, value in checked.items():
            object.__setattr__(self, name, value)
        if min(self.tire_stiffnesses) <= 0:
            raise ValueError(f"tire_stiffness must be above 0 [N/m], got {self.tire_stiffness}")
        if not isinstance(self.name, str):
            raise TypeError(f'name must be text, got {self.name!r}: type name="drive"')
        if (n > 1) != (self.inertia > 0):
            raise ValueError(
                "spread and inertia go together: a group has axles apart, as spread=(-0.65, 0.65), "
                f"and an inertia above 0 [kg m^2]; got spread={spread} and {self.inertia:g} kg m^2"
            )
        if spread != ALONE and n == 1:
            raise ValueError(f"spread of one axle must be (0,), got {spread}: move its place")

    def __repr__(self) -> str:
        name = f"{self.name!r} " if self.name else ""
        axles = "1 axle" if len(self.spread) == 1 else f"{len(self.spread)} axles"
        return f"Axle({name}at {self.place:g} m, mass={self.mass:g} kg, {axles})"

    @property
    def tire_stiffnesses(self) -> list[float]:
        """Stiffness of the tires of each axle [N/m]."""
        return _each(self.tire_stiffness, len(self.spread))

    @property
    def tire_dampings(self) -> list[float]:
        """Damping of the tires of each axle [N s/m]."""
        return _each(self.tire_damping, len(self.spread))

    @property
    def tire_places(self) -> list[float]:
        """Place of each axle under the body [m]."""
        return [self.place + apart for apart in self.spread]


@dataclass(frozen=True, repr=False)
class Body:
    """A body and the axles under it: that of a rigid truck, a tractor or a trailer.

    Parameters
    ----------
    mass : float
        Sprung mass [kg], without what is `loaded`.
    inertia : float
        Its pitch moment of inertia about its centre of gravity [kg m^2].
    axles : sequence of Axle
        Axles and groups from front to rear.
    centre : float, optional
        Place of the centre of gravity [m], in the coordinate of the axles. Default: they count
        from it.
    height : float, optional
        Height of the centre of gravity above the road [m], by which braking pitches the body: at
        its own axles, with no force along the road in a hinge. Default: it does not pitch.

    Raises
    ------
    TypeError, ValueError
        If a parameter has the wrong kind or range, or the axles are not in order.

    Examples
    --------
    Places that count from the front axle, and 8 t of load that make the rear one do the work:

    >>> import bridgectl as bc
    >>> axles = [bc.trucks.Axle(0, 700, 4e5, 1.75e6), bc.trucks.Axle(5, 1100, 1e6, 3.5e6)]
    >>> empty = bc.trucks.Body(6000, 25e3, axles, centre=2.0)
    >>> empty
    Body(mass=6000 kg, inertia=25000 kg m^2, centre=2 m, 2 axles)
    >>> for body in (empty, empty.loaded(8000, 4.0, 20e3)):
    ...     print((bc.trucks.rigid(body).static_loads / 1e3).round(1))
    [42.2 34.3]
    [57.9 97.1]
    """

    mass: float
    inertia: float
    axles: Sequence[Axle]
    centre: float = 0.0
    height: float = 0.0

    def __post_init__(self) -> None:
        if not isinstance(self.axles, list | tuple) or not all(
            isinstance(axle, Axle) for axle in self.axles
        ):
            raise TypeError("axles must be a list of bridgectl.trucks.Axle: type [front, rear]")
        checked = {
            "mass": _checks.positive("mass", self.mass, unit="kg"),
            "inertia": _checks.positive("inertia", self.inertia, unit="kg m^2"),
            "axles": tuple(self.axles),
            "centre": _checks.number("centre", self.centre, unit="m"),
            "height": _checks.not_negative("height", self.height, unit="m"),
        }
        for name, value in checked.items():
            object.__setattr__(self, name, value)
        places = self.tire_places
        wrong = [i for i, (a, b) in enumerate(pairwise(places)) if b <= a]
        if not places or wrong:
            found = (
                f"{places[wrong[0]]:g} m before {places[wrong[0] + 1]:g} m" if places else "none"
            )
            raise ValueError(
                f"axles must be in order from front to rear, each behind the one before, got "
                f"{found}: places are positive backward"
            )

    def __repr__(self) -> str:
        return (
            f"Body(mass={self.mass:g} kg, inertia={self.inertia:g} kg m^2, "
            f"centre={self.centre:g} m, {len(self.tire_places)} axles)"
        )

    @property
    def tire_places(self) -> list[float]:
        """Place of every axle under the body [m], those of groups too."""
        return [place for axle in self.axles for place in axle.tire_places]

    def loaded(
        self, mass: float, place: float, inertia: float = 0.0, height: float | None = None
    ) -> Body:
        """Return the body with a load on it, which moves with it.

        Parameters
        ----------
        mass : float
            Mass of the load [kg].
        place : float
            Place of its centre of gravity [m], in the coordinate of the axles.
        inertia : float, optional
            Its own pitch moment of inertia [kg m^2]: m L^2 / 12 of one L long.
        height : float, optional
            Height of its centre of gravity above the road [m]. Default: that of the body.

        Returns
        -------
        Body
            With the centre of gravity and the inertia of both.

        Raises
        ------
        TypeError, ValueError
            If a number is out of range; the message names it.
        """
        mass = _checks.positive("mass", mass, unit="kg")
        place = _checks.number("place", place, unit="m")
        inertia = _checks.not_negative("inertia", inertia, unit="kg m^2")
        above = self.height if height is None else height
        above = _checks.not_negative("height", above, unit="m")
        share = mass / (self.mass + mass)
        apart = (place - self.centre) ** 2 + (above - self.height) ** 2
        return replace(
            self,
            mass=self.mass + mass,
            inertia=self.inertia + inertia + self.mass * share * apart,
            centre=self.centre + share * (place - self.centre),
            height=self.height + share * (above - self.height),
        )


def _of_axles(
    name: str, value: float | Sequence[float], n: int, unit: str
) -> float | tuple[float, ...]:
    """One number, or one for each axle, of 0 or more."""
    if isinstance(value, float | int) or np.ndim(value) == 0:
        return _checks.not_negative(name, value, unit=unit)
    each = tuple(_checks.array(name, value, (n,), unit=unit).tolist())
    if min(each) < 0:
        raise ValueError(f"{name} must be 0 or more [{unit}], got {min(each):g}")
    return each


def _each(value: float | Sequence[float], n: int) -> list[float]:
    return [value] * n if isinstance(value, float) else list(value)
