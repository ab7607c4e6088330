"""What a scoreboard has of each strategy, and what is printed of it."""

from __future__ import annotations

from typing import NamedTuple

from bridgectl._units import to_kmh
from bridgectl.scoring.agreement import Agreement, GapClosed, Paired, Pairs

MEASURES = {
    "daf": "dynamic amplification factor [-]",
    "dae": "dynamic amplification estimate, Eq. (15) [-]",
    "dae_2": "dynamic amplification estimate of second order [-]",
    "dynamic_load_coefficient": "dynamic load coefficient [-]",
    "tire_force_95": "95th percentile of the tire force over the static load [-]",
    "road_stress": "mean fourth power of the tire force over the static load [-]",
    "least_force": "least tire force over the static load [-]",
    "body_acceleration": "body acceleration, rms [m/s^2]",
    "weighted_acceleration": "body acceleration weighted by W_k (ISO 2631-1), rms [m/s^2]",
    "suspension_travel": "largest suspension travel [m]",
    "switching_rate": "switches of the damper [1/s]",
}
"""What is known of each strategy, road and speed; of several tires or legs the worst."""

EQ_15, CLASS_DAE = "mean of Eq. (15)", "class DAE"
"""What orders strategies."""


class Row(NamedTuple):
    """One strategy, made by `score`: means over roads and speeds unless said otherwise."""

    strategy: str
    """Its name."""
    daf: float
    """DAF [-]."""
    daf_difference: Paired
    """Of the DAF, to the first strategy [-]."""
    worst_speed: float
    """Where the mean DAF over roads is largest [m/s]."""
    worst_daf: float
    """That DAF."""
    dae: float
    """DAE [-]."""
    dae_error: float
    """Root mean square of DAE - DAF over roads and speeds."""
    dae_rank: float
    """Spearman's rank correlation of DAE and DAF over roads and speeds."""
    dae_2: float
    """DAE of second order [-]; NaN if a road's class has no surface."""
    dae_2_error: float
    """Root mean square of it - DAF over roads and speeds."""
    dynamic_load_coefficient: float
    """See `bridgectl.measures.dynamic_load_coefficient` [-]."""
    fourth_power_95: float
    """Aggregate fourth power of all speeds that 95 % of the road stays below [-]."""
    body_acceleration: float
    """Of the body, rms [m/s^2]."""
    weighted_acceleration: float
    """The same weighted by W_k (ISO 2631-1), rms [m/s^2]."""
    suspension_travel: float
    """Largest of all roads and speeds [m]."""
    least_force: float
    """Least tire force of all roads and speeds over the static load [-]."""
    switching_rate: float
    """Switches of the damper [1/s]."""
    gap_closed: GapClosed
    """Of the DAF, from the first strategy to the clairvoyant optimum; NaN if that is not known."""

    def __repr__(self) -> str:
        return (
            f"Row({self.strategy!r}, DAF {self.daf:.4f}, at {to_kmh(self.worst_speed):g} km/h "
            f"{self.worst_daf:.4f}, DAE {self.dae:.4f}, load coefficient "
            f"{self.dynamic_load_coefficient:.4f}, body acceleration {self.body_acceleration:.3g} "
            f"m/s^2, travel up to {self.suspension_travel * 1e3:.3g} mm)"
        )


class ClassRow(NamedTuple):
    """One strategy over a road class, of a board made by `score`: means over the speeds."""

    strategy: str
    """Its name."""
    dae: float
    """Mean DAE of second order over the class, in closed form [-]."""
    dae_spread: float
    """Its standard deviation over the class, in closed form [-]."""
    daf: float
    """Mean simulated DAF of the roads of the class [-]."""
    daf_spread: float
    """Standard deviation of the simulated DAF over those roads [-]; NaN for a single road."""


class Ranking(NamedTuple):
    """How an estimate orders the strategies of a board made by `score`."""

    estimate: str
    """What it is."""
    roads: str
    """The roads of the simulation."""
    agreement: Agreement
    """Kendall's tau with the simulated values."""
    pairs: Pairs | None
    """Of the pairs that differ clearly in mean DAF, those in the right order; None of a spread."""
