"""Strategies behind sensors: ideal signals replaced by estimates, and signals that come late."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike

from bridgectl import _checks as check
from bridgectl._checks import FloatArray
from bridgectl.dampers.sensors import Sensors, estimates, moved, states_of
from bridgectl.dampers.signals import parts_of
from bridgectl.dampers.strategy import Strategy
from bridgectl.model.crossing import Crossing

ODOMETER = ("position", "speed")
"""What every vehicle measures itself: `Damper` has the error of its position."""

COMMAND = "command"
"""What delays call the command."""

STANDING = {COMMAND, "tire_force", *ODOMETER}
"""What is not 0 before the first sample, at rest: late ones have always been as at the first."""


def _standing(key: str) -> bool:
    """Whether a signal, of any leg, or the command is not 0 at rest."""
    return key in STANDING or parts_of(key)[0] in STANDING


class Measured(Strategy):
    """A strategy behind sensors; made by `measured`. At each speed it is that of the strategy."""

    def __init__(
        self, strategy: Strategy, sensors: Sensors | None, delays: Mapping[str, int], name: str
    ) -> None:
        self.strategy, self.sensors, self.delays = strategy, sensors, dict(delays)
        self.registers = {
            key: [f"{key}_late_{i + 1}" for i in range(n)] for key, n in self.delays.items()
        }
        own = {} if sensors is None else states_of(sensors)
        own |= {state: 0.0 for each in self.registers.values() for state in each}
        own |= {"started": 0.0} if any(map(_standing, self.delays)) else {}
        if taken := set(own) & set(strategy.states):
            raise ValueError(
                f"strategy {strategy.name!r} has a state {sorted(taken)[0]!r} already: put all "
                "sensors and delays into one measured(...)"
            )
        if sensors is not None:
            _require_told(strategy, sensors)
        self.laws: dict[float, Measured] = {}
        self._found: tuple[Any, Any] = (None, None)
        states = {**strategy.states, **own}
        super().__init__(
            name, self._law, strategy.c_min, strategy.c_max, strategy.bounds,
            states, self._update, strategy.preview,
        )  # fmt: skip
        self._found = (None, None)  # expressions do not go to other processes

    def __repr__(self) -> str:
        return (
            f"Measured({self.name!r}, {self.strategy!r}, {self.sensors!r}, "
            f"delays={self.delays} samples)"
        )

    def for_speed(self, speed: float) -> Strategy:
        """Return the law at a speed [m/s]: see `Strategy.for_speed`."""
        law = self.strategy.for_speed(speed)
        if law is self.strategy:
            return self
        if speed not in self.laws:
            made = Measured(law, self.sensors, self.delays, self.name)
            self.laws[speed] = made.with_gains(**self.gains)
        return self.laws[speed]

    def with_gains(self, **values: float) -> Measured:
        """Return the strategy with other values of some gains: see `Strategy.with_gains`."""
        changed: Any = super().with_gains(**values)
        changed.laws = {}
        return changed

    @property
    def kept(self) -> FloatArray | None:
        """See `Strategy`."""
        return self.strategy.kept

    def gains_for(
        self, crossing: Crossing, speeds: FloatArray, stations: FloatArray, elevations: FloatArray
    ) -> Mapping[str, FloatArray]:
        """Return those of the strategy: see `Strategy.gains_for`."""
        return self.strategy.gains_for(crossing, speeds, stations, elevations)

    def command(self, **signals: ArrayLike) -> FloatArray:
        """Evaluate the command [N s/m]: see `Strategy.command`, and that of the strategy."""
        speed: Any = signals.get("speed", ())
        law = self if np.ndim(speed) else self.for_speed(float(speed))
        if law is self:
            self._require_one_law("command(speed=25.0, ...)")
            return super().command(**signals)
        return law.command(**signals)

    def to_c(self, path: str | Path) -> Path:
        """Write the law of a strategy that is the same at all speeds: see `Strategy.to_c`."""
        self._require_one_law("law.for_speed(25.0).to_c(path)")
        return super().to_c(path)

    def _require_one_law(self, instead: str) -> None:
        if self.strategy.for_speed(25.0) is not self.strategy:
            raise ValueError(f"{self.name} has a law for each speed: type for example {instead}")

    def _law(self, s: Any, g: Any) -> Any:
        """The command of this sample, or of one that far ago."""
        return self._solved(s, g).told

    def _update(self, s: Any, g: Any) -> dict[str, Any]:
        return dict(self._solved(s, g).states)

    def _solved(self, s: Any, g: Any) -> SimpleNamespace:
        """Law and update, of the same expressions: they are asked for one after the other."""
        if self._found[0] is not s:
            self._found = s, self._solve(s, g)
        return self._found[1]

    def _solve(self, s: Any, g: Any) -> SimpleNamespace:
        known, after = {name: getattr(s, name) for name in self.strategy.signals}, dict[str, Any]()
        for key in self.registers.keys() & known.keys():
            known[key] = self._passed(s, key, known[key], after)
        x = ca.SX(0, 1)
        heard = dict(known)
        if self.sensors is not None:
            x = ca.vertcat(*(getattr(s, name) for name in states_of(self.sensors)))
            heard |= estimates(self.sensors, x)
        inner = self.strategy
        columns = (
            [heard[name] for name in inner.signals],
            [getattr(g, name) for name in inner.gains],
            [getattr(s, name) for name in inner.states],
            [s.sample_time],
            s.ahead if inner.preview else [],
        )
        inputs = [ca.vertcat(*column) if column else ca.SX(0, 1) for column in columns]
        command, *own = inner.function.call(inputs[: inner.function.n_in()])
        if own:
            after |= dict(zip(inner.states, ca.vertsplit(own[0]), strict=True))
        told = self._passed(s, COMMAND, command, after) if COMMAND in self.registers else command
        if self.sensors is not None:
            given = ca.vertcat(*(known[name] for name in self.sensors.inputs))
            following = moved(self.sensors, x, given, told, s.sample_time)
            after |= dict(zip(states_of(self.sensors), ca.vertsplit(following), strict=True))
        after |= {"started": 1.0} if "started" in self.states else {}
        return SimpleNamespace(told=told, states=after)

    def _passed(self, s: Any, key: str, value: Any, after: dict[str, Any]) -> Any:
        """What has come through a register, and into `after` what is in it next."""
        names = self.registers[key]
        held = [getattr(s, name) for name in names]
        if _standing(key):
            held = [ca.if_else(s.started > 0, old, value) for old in held]
        after |= dict(zip(names, [value, *held[:-1]], strict=True))
        return held[-1]


def _require_told(strategy: Strategy, sensors: Sensors) -> None:
    """Refuse a strategy that measures what sensors neither measure nor estimate."""
    known = [*dict.fromkeys((*sensors.inputs, *sensors.outputs, *ODOMETER))]
    if missing := [signal for signal in strategy.used if signal not in known]:
        raise ValueError(
            f"{strategy.name} measures {' and '.join(missing)}, of which {sensors.name} tell "
            f"nothing, but of {', '.join(known)}: type other sensors, as Sensors.kalman(vehicle)"
        )


def measured(
    strategy: Strategy,
    sensors: Sensors | None = None,
    *,
    delays: Mapping[str, int] | None = None,
    name: str = "",
) -> Strategy:
    """Return a strategy as sensors let it work.

    Its ideal velocities, and what else the sensors estimate, are replaced by estimates; it sees
    what the sensors measure, position and speed as they are measured. The states of the filters are
    its states, so that it goes where any strategy goes: `Damper` has noise, `score` its gain beside
    the ideal one's.

    Parameters
    ----------
    strategy : Strategy
        The strategy, which must measure nothing else.
    sensors : Sensors, optional
        What is measured; all signals as they are if omitted.
    delays : mapping, optional
        Number of samples by which signals that are measured, or the 'command', come late, by name,
        as ``{"suspension_travel": 2, "command": 1}``.
    name : str, optional
        What tables call it; its own name with that of the sensors if omitted.

    Returns
    -------
    Strategy
        With the gains, bounds and preview of the first.

    Raises
    ------
    TypeError, ValueError
        If an argument is not what is described above.

    Notes
    -----
    As a block of `control.interconnect` a law with accelerometers takes 'y_s_ddot' and 'y_t_ddot'.
    With no more systems than the crossing and the law, `control` finds a loop there that there is
    none of: put a sensor of its own between them.

    Examples
    --------
    What is left of a skyhook whose velocities are from accelerometers:

    >>> import numpy as np
    >>> import bridgectl as bc
    >>> from bridgectl.dampers import Sensors, measured, simulate_loop, skyhook
    >>> ideal, road = skyhook(1e3, 30e3), bc.iso8608_profile("A", 85, start=-60, seed=1)
    >>> dafs = [
    ...     simulate_loop(bc.li2006.beam(), bc.li2006.car(), law, 25.0, road.x, road.elevation).daf
    ...     for law in (ideal, measured(ideal, Sensors.accelerometers()))]
    >>> bool(abs(dafs[0] - dafs[1]) < 0.02)
    True
    """
    if not isinstance(strategy, Strategy):
        raise TypeError(
            f"strategy must be a Strategy, got {type(strategy).__name__}: type for example "
            "bridgectl.dampers.skyhook(1e3, 30e3)"
        )
    if not (sensors is None or isinstance(sensors, Sensors)):
        raise TypeError(
            f"sensors must be Sensors, got {type(sensors).__name__}: type for example "
            "Sensors.accelerometers()"
        )
    late = _checked_delays({} if delays is None else delays, strategy, sensors)
    told = [*([] if sensors is None else [sensors.name]), *(["delayed"] if late else [])]
    if not told:
        raise ValueError(
            "measured needs sensors, or delays: type for example Sensors.accelerometers()"
        )
    return Measured(strategy, sensors, late, name or f"{strategy.name} ({', '.join(told)})")


def _checked_delays(delays: Any, strategy: Strategy, sensors: Sensors | None) -> dict[str, int]:
    """Check the delays in samples, by signal."""
    example = 'delays={"suspension_travel": 2, "command": 1}'
    if not isinstance(delays, Mapping):
        raise TypeError(f"delays must be a mapping, got {delays!r:.60}: type for example {example}")
    known = [*(strategy.signals if sensors is None else (*sensors.inputs, *ODOMETER)), COMMAND]
    for key, value in delays.items():
        if key not in known:
            raise ValueError(
                f"delays has {key!r}, which is not measured; what is: {', '.join(known)}"
            )
        check.integer(f"delays[{key!r}]", value, at_least=1)
    return {key: int(value) for key, value in delays.items()}
