"""A crossing in the hands of the control library: as it moves, frozen at a place, and drawn."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import control
import numpy as np
from numpy.typing import ArrayLike

from bridgectl._checks import FloatArray
from bridgectl.model.equations import Equations
from bridgectl.model.motion import Motion
from bridgectl.model.vehicle import road_signals, signals


@dataclass(frozen=True)
class ControlSystems(Equations):
    """What a `bridgectl.Crossing` is to the control library; its outputs are told there."""

    if TYPE_CHECKING:

        @property
        def output_labels(self) -> list[str]:
            """Names of the outputs."""

        def outputs(
            self,
            x: FloatArray,
            states: FloatArray,
            forces: FloatArray,
            damper: FloatArray,
            accelerations: FloatArray | float = 0.0,
        ) -> FloatArray:
            """Outputs [units of each], shape (n_outputs, m)."""

    def frozen(self, x: float, speed: float = 0.0, name: str = "crossing") -> control.StateSpace:
        """Return the crossing frozen with the vehicle at a place, every tire in contact.

        What `control.linearize` makes of `bridgectl.crossing_system`, but exact: for poles, Bode
        plots (`plot_bode`) and designs.

        Parameters
        ----------
        x, speed : float
            Position of the reference tire [m]; its speed [m/s] counts with tire damping alone.
        name : str, optional
            Name of the system.

        Returns
        -------
        control.StateSpace
            With inputs, states and outputs as of `bridgectl.crossing_system`.

        Examples
        --------
        >>> import bridgectl as bc
        >>> middle = bc.Crossing(bc.li2006.beam(), bc.li2006.car()).frozen(12.5)
        >>> sorted({round(float(abs(pole)) / 6.2832, 2) for pole in middle.poles()})
        [0.46, 4.08, 6.91, 16.37, 36.83]
        """
        vehicle = self.linear
        n_roads, n_dampers = len(road_signals(vehicle)), len(vehicle.damper_map)
        # Road and, with tire damping, its rate; then the dampers, which the tires do not feel.
        taken = np.hstack([np.eye(vehicle.n_tires), np.diag(vehicle.tire_lags)])[:, :n_roads]
        # Columns: nothing, whose outputs are those of the weight, then one of each.
        unit = np.eye(1 + self.n_states + n_roads + n_dampers)[1:]
        states, roads, damper = np.split(unit, [self.n_states, self.n_states + n_roads])
        forces = self.tire_forces(
            (vehicle.leading_hubs @ states[: self.n_vehicle]).T,
            (self.deflection_rows(x, speed) @ states[self.n_vehicle :]).T,
            (taken @ roads).T,
        ).T
        values = self.outputs(np.full(unit.shape[1], float(x)), states, forces, damper)
        gains = values[:, 1:] - values[:, :1]
        return control.ss(
            self.state_matrix(x, speed),
            np.hstack([self.road_matrix(x) @ taken, self.damper_matrix]),
            *np.hsplit(gains, [self.n_states]),
            inputs=self.input_labels, outputs=self.output_labels, states=self.state_labels,
            name=name,
        )  # fmt: skip

    def plot_bode(
        self,
        places: ArrayLike,
        *,
        outputs: Sequence[str] = ("moment",),
        input: str | None = None,
        limits: Sequence[float] | None = None,
        speed: float = 0.0,
    ) -> control.ControlPlot:
        """Draw Bode plots of the crossing frozen with the vehicle at some places.

        Phases are unwrapped; poles and zeros of an undamped bridge turn them as with a little
        damping. Where curves are the same, the first are the wider ones: all are seen.

        Parameters
        ----------
        places : array_like, shape (n,)
            Positions of the reference tire [m].
        outputs : sequence of str, optional
            Names of outputs, a column each.
        input : str, optional
            Name of the input: the first, the road under the first tire, if omitted.
        limits : sequence of float, optional
            Lowest and highest frequency [Hz]; about the poles if omitted.
        speed : float, optional
            Speed [m/s], which counts with tire damping alone.

        Returns
        -------
        control.ControlPlot
            With `lines` and `axes` of shape (2, n_outputs), magnitudes in dB of SI units above
            phases in degrees, in a new figure of pyplot. To add another system, type
            ``control.bode_plot(other, ax=plot.axes[:, 0], Hz=True, dB=True)``.

        Raises
        ------
        TypeError, ValueError
            If there are no places, no such input or output, or the limits do not increase.

        Examples
        --------
        >>> import bridgectl as bc
        >>> crossing = bc.Crossing(bc.li2006.beam(), bc.li2006.car())
        >>> plot = crossing.plot_bode([3.125, 6.25, 12.5], outputs=["tire_force", "moment"])
        >>> plot.axes.shape, plot.axes[0, 0].get_ylabel()
        ((2, 2), 'magnitude [dB re 1 N/m]')
        """
        from bridgectl.plots.bode import bode_plot  # late, for matplotlib is slow to load

        return bode_plot(self, places, outputs, input, limits, speed)

    def system(
        self, motion: Motion, name: str = "crossing", *, outputs: str = "all"
    ) -> control.NonlinearIOSystem:
        """Return the crossing as a control system: see `crossing_system`.

        Parameters
        ----------
        motion : Motion
            How the vehicle moves.
        name : str, optional
            Name of the system.
        outputs : {'all', 'forces', 'states'}, optional
            The tire forces alone are quicker, and the states more so.

        Returns
        -------
        control.NonlinearIOSystem
        """
        lags, n_tires = self.linear.tire_lags, self.linear.n_tires
        n_roads = len(road_signals(self.linear))
        labels = {"all": self.output_labels, "forces": signals("tire_force", n_tires),
                  "states": self.state_labels}  # fmt: skip

        def taken(t: float, u: FloatArray) -> tuple[float, float, float, FloatArray]:
            place = motion.position(t)
            speed, a = float(motion.speeds(place)), float(motion.accelerations(place))
            return place, speed, a, u[:n_tires] + lags * u[n_roads - n_tires : n_roads]

        def update(t: float, x: FloatArray, u: FloatArray, _: dict[str, Any]) -> FloatArray:
            place, speed, a, road = taken(t, u)
            return self.dynamics(place, x, road, u[n_roads:], speed, a)

        def output(t: float, x: FloatArray, u: FloatArray, _: dict[str, Any]) -> FloatArray:
            place, speed, a, road = taken(t, u)
            shapes, rates = self.tire_shapes(place), self.shape_rates(place, speed)
            force = self.contact_forces(x, road, shapes, rates)
            if outputs == "forces":
                return force
            columns = x[:, np.newaxis], force[:, np.newaxis], u[n_roads:, np.newaxis]
            return self.outputs(np.array([place]), *columns, a)[:, 0]

        return control.nlsys(
            update,
            None if outputs == "states" else output,
            inputs=self.input_labels,
            outputs=labels[outputs],
            states=self.state_labels,
            name=name,
        )
