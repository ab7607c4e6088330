"""What `bridgectl.dampers.clairvoyant` finds: a damping over the road, and a damper that has it."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any

import casadi as ca
import numpy as np

from bridgectl._checks import FloatArray
from bridgectl._labelled import Labelled
from bridgectl.dampers.actuator import Damper
from bridgectl.dampers.strategy import Strategy

if TYPE_CHECKING:
    import pandas

EARLIER = 1e-6
"""How far before an interval's start its damping is given [m]: places of samples are rounded."""


@dataclass(frozen=True, eq=False)
class Clairvoyant:
    """The damping of the least peak moment, found by `clairvoyant`.

    Attributes
    ----------
    daf : float
        Peak moment over the peak static one [-], by `simulate_loop` with this damping.
    passive_daf : float
        The same [-] with the vehicle's own damping, kept within the damper's range.
    positions : ndarray, shape (n,)
        Where the intervals start [m].
    damping : ndarray, shape (n,), or (n_dampers, n) of several
        Damping held from there [N s/m].
    step : float
        Time that it is held [s].
    c_min, c_max : float
        Bounds of the damping [N s/m].
    status : str
        What the solver said of the solution that was taken, or that it is the descent's. The
        numbers above do not depend on it.
    offsets : ndarray, shape (n_dampers,)
        How far each damper is behind the reference tire [m], whose places `positions` are.
    ipopt_daf, descent_daf : float
        DAF [-] of the best that IPOPT finds from passive and bridgehook, and of the best of the
        descent over blocks, polished by IPOPT. `daf` is the better of them.
    """

    daf: float
    passive_daf: float
    positions: FloatArray
    damping: FloatArray
    step: float
    c_min: float
    c_max: float
    status: str
    offsets: FloatArray = field(default_factory=lambda: np.zeros(1))
    ipopt_daf: float = np.nan
    descent_daf: float = np.nan

    def __repr__(self) -> str:
        return (
            f"Clairvoyant(DAF {self.daf:.4f}, passive {self.passive_daf:.4f}, "
            f"{self.damping.size} dampings from x = {self.positions[0]:.4g} m to "
            f"{self.positions[-1]:.4g} m held {self.step * 1e3:g} ms, c from {self.c_min:g} to "
            f"{self.c_max:g} N s/m)"
        )

    def to_pandas(self) -> pandas.DataFrame:
        """Return the damping [N s/m] as a table over the positions [m].

        Returns
        -------
        pandas.DataFrame
            Indexed by 'position' with a column 'damping', numbered if of several dampers; units
            are in ``attrs["units"]``.
        """
        several = self.damping.ndim == 2
        columns = {
            f"damping_{k}" if several else "damping": each
            for k, each in enumerate(np.atleast_2d(self.damping), 1)
        }
        units = dict.fromkeys(columns, "N s/m")
        return Labelled({"position": self.positions}, columns, units).table()

    @cached_property
    def damper(self) -> Damper | list[Damper]:
        """The damping as an open-loop damper, for `simulate_loop` at the same speed and start.

        Of several dampers a list of one for each.
        """
        each = [
            _open_loop(self.positions - behind, own, self.step, self.c_min, self.c_max)
            for behind, own in zip(self.offsets, np.atleast_2d(self.damping), strict=True)
        ]
        return each[0] if len(each) == 1 else each


def _open_loop(
    positions: FloatArray, damping: FloatArray, held: float, c_min: float, c_max: float
) -> Damper:
    """Damping over position, sampled where its intervals start.

    Read from a table: `bridgectl.dampers.program`, a choice for each of hundreds of places, takes
    far longer.
    """
    x = ca.MX.sym("x")
    place = ca.low(ca.DM(np.append(positions - EARLIER, np.inf)), x)
    table = ca.Function("held", [x], [ca.MX(ca.DM(damping))[place]], {"never_inline": True})

    def law(s: Any, g: Any) -> Any:
        return table(s.position) if np.ptp(damping) else damping[0] + 0 * s.position

    return Damper(Strategy("clairvoyant", law, c_min, c_max), sample_time=held)
