"""Parameters and printed results of Li, OBrien and Gonzalez (2006), and the thesis behind them."""

from __future__ import annotations

import numpy as np

from bridgectl._plausible import judge_beam
from bridgectl.model.beam import Beam
from bridgectl.model.quarter_car import QuarterCar
from bridgectl.road import RoadProfile

YOUNGS_MODULUS = 3.5e10
"""Young's modulus E of every beam here [N/m^2] (Table 1)."""

# Y. Li, PhD thesis, University College Dublin, 2006, Appendix A, p. 235, as tabulated by
# VBI-2D: span [m]: (mass per unit length [kg/m], second moment of area [m^4]).
SOLID_T_BEAM = {
    9: (16875.0, 0.1139),
    11: (20625.0, 0.2080),
    13: (24375.0, 0.3433),
    15: (28125.0, 0.5273),
    17: (31875.0, 0.7677),
    19: (35625.0, 1.0717),
    21: (39375.0, 1.4470),
}
Y_BEAM = {
    17: (15002.0, 0.4911),
    19: (15741.0, 0.6660),
    21: (16530.0, 0.8722),
    23: (17419.0, 1.1133),
    25: (18358.0, 1.3901),
    27: (19372.0, 1.7055),
    29: (20486.0, 2.0634),
    31: (21650.0, 2.4651),
}
SUPER_Y_BEAM = {
    33: (20952.0, 2.9327),
    35: (21752.0, 3.4162),
    37: (22552.0, 3.9425),
    39: (23352.0, 4.5132),
    41: (24152.0, 5.1305),
    43: (24952.0, 5.7957),
}
DECKS = {"solid": SOLID_T_BEAM, "Y": Y_BEAM, "super-Y": SUPER_Y_BEAM}

PRINTED = {
    "daf_smooth_110": 1.1302,
    "critical_speed_kmh": 105.0,
    "unit_ramp_0.12l_110": 0.00433,
    "unit_ramp_0.3l_110": 0.006031,
    "unit_ramp_0.75l_110": 0.0,
    "fig7_dae": 1.0663,
    "fig7_daf": 1.0656,
    "tall_ramp_lowest": 0.23,
    "tall_ramp_right_half": 0.0,
}
"""Numbers printed in the paper: Sections 3.1 and 3.3, Fig. 7's example at 110 km/h.

A 10 mm ramp leaves the DAF low at 105 km/h 'for some locations (e.g., 0.23 x length)', and 'has no
influence on the maximum total moment when it occurs in the right half of the bridge'.
"""

FIG7_RAMPS = {0.12: -5.0, 0.3: -7.0, 0.75: 10.0}
"""Fig. 7's road: ramp scale factor s of each ramp, by its place as a fraction of the span."""


def car() -> QuarterCar:
    """Return the paper's truck: Table 1, representative of a typical air suspension.

    Returns
    -------
    QuarterCar

    Examples
    --------
    >>> import bridgectl as bc
    >>> bc.li2006.car().sprung_mass
    9000.0
    """
    return QuarterCar(
        sprung_mass=9000.0,
        unsprung_mass=1000.0,
        suspension_stiffness=80e3,
        tire_stiffness=1800e3,
        damping=7e3,
    )


def beam(
    span: int = 25,
    deck: str | None = None,
    *,
    n_modes: int = 3,
    damping_ratio: float | tuple[float, ...] = 0.0,
) -> Beam:
    """Return a bridge of the paper (25 m, Table 1) or of the thesis behind it.

    Parameters
    ----------
    span : int, optional
        Span [m]: an odd number from 9 to 43.
    deck : {'solid', 'Y', 'super-Y'}, optional
        Kind of deck. Spans of 17, 19 and 21 m exist as a solid and as a Y-beam deck;
        the default takes the solid one up to 15 m and the beam-and-slab one above, as the
        paper does for its 15, 25 and 35 m spans.
    n_modes : int, optional
        Number of modes. Table 1 prints none; its results are those of three.
    damping_ratio : float or tuple of float, optional
        See `Beam`. Table 1 prints none; its results are those of an undamped beam.

    Returns
    -------
    Beam

    Raises
    ------
    ValueError
        If the thesis has no such span or deck.

    References
    ----------
    Y. Li, PhD thesis, University College Dublin, 2006, Appendix A, p. 235.

    Examples
    --------
    >>> import bridgectl as bc
    >>> [round(float(bc.li2006.beam(span).frequencies[0]), 2) for span in (15, 25, 35)]
    [5.66, 4.09, 3.01]
    """
    if deck is not None and deck not in DECKS:
        raise ValueError(f"deck must be one of {', '.join(map(repr, DECKS))}, got {deck!r}")
    # Later entries win, so the beam-and-slab deck is the default where there are two.
    default = {s: values for table in DECKS.values() for s, values in table.items()}
    table = default if deck is None else DECKS[deck]
    if span not in table:
        kind = "" if deck is None else f" with a {deck} deck"
        known = ", ".join(map(str, sorted(table)))
        raise ValueError(f"span must be one of {known} m{kind}, got {span!r}")
    mass_per_length, second_moment = table[span]
    bridge = Beam(
        length=float(span),
        mass_per_length=mass_per_length,
        flexural_rigidity=YOUNGS_MODULUS * second_moment,
        n_modes=n_modes,
        damping_ratio=damping_ratio,
    )
    judge_beam(bridge)
    return bridge


def fig7_road(earlier: float = 0.0) -> RoadProfile:
    """Return the road of Fig. 7: rises of 5 and 7 mm and a drop of 10 mm, each over 0.1 m.

    Parameters
    ----------
    earlier : float, optional
        How far before the printed places the ramps start [m]. The paper's printed values
        lie between those of ramps that start at the printed place and 0.1 m earlier.

    Returns
    -------
    RoadProfile
        Elevation positive up: the paper's positive ramp is a drop.

    Examples
    --------
    >>> import bridgectl as bc
    >>> bc.li2006.fig7_road().elevation_at([0, 5, 12, 25])
    array([0.   , 0.005, 0.012, 0.002])
    """
    span = beam().length
    stations, elevations = [0.0], [0.0]
    for place, scale in FIG7_RAMPS.items():
        start = place * span - earlier
        stations += [start, start + 0.1]
        elevations += [elevations[-1], elevations[-1] - scale * 1e-3]
    return RoadProfile(
        np.append(stations, span), np.append(elevations, elevations[-1]), name="Fig. 7"
    )
