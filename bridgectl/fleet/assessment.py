"""The assessment of a bridge under traffic: what `bridgectl.assess` finds, and what it tells."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from bridgectl import _checks as check
from bridgectl._checks import FloatArray
from bridgectl.fleet.comparison import DafBins, bins_of, mean_of, means_by_truck
from bridgectl.fleet.crossings import Crossings
from bridgectl.fleet.levels import Characteristic, Reading, Rule, quantile, ratio
from bridgectl.fleet.tails import DAYS_A_YEAR, METHODS, Estimate

if TYPE_CHECKING:
    from matplotlib.figure import Figure

QUANTITIES = ("daf", "static", "total")

N_BINS = 10
"""Of static effect."""

SHARES = (0.05, 0.5, 0.95, 0.99)

RETURN_PERIOD = 1000.0
"""Years that characteristic loads of EN 1991-2 stand for (AASHTO: 75)."""


class Read(NamedTuple):
    """What a return period asks of an effect on a road quality, and what it is read from."""

    effect: str
    unit: str
    sign: int
    """-1 if the smallest values count: the readings are of their negatives."""
    daf: FloatArray
    daf_by_quality: Mapping[str, FloatArray]
    total: Reading
    static: Reading
    rule: Rule

    @property
    def bins(self) -> DafBins:
        """DAF by static effect."""
        return bins_of(self.static.values, self.daf, N_BINS)


@dataclass(frozen=True, eq=False, repr=False)
class Assessment(Crossings):
    """Crossings of random traffic and what they tell of a bridge; made by `bridgectl.assess`.

    Parameters
    ----------
    columns : mapping of str to array, shape (n,)
        By crossing 'crossing', 'truck' (the number in the fleet), 'kind', 'road', 'quality' (''
        of one), 'speed' [m/s], 'gross_weight' [N], 'n_axles', 'damped', 'meeting' and
        'least_tire_force' (over the static one); of each effect E 'static E' and 'total E', its
        peaks, 'daf E', and 'place E' [m] of the reference tire and 'time E' [s] of the total one.
        Words are strings, or a tuple of codes and names.
    effects : mapping of str to str
        Names of the effects with their units.
    bridge : str, optional
        The bridge in words.
    trucks_a_day : float, optional
        Number of crossings a day, for return periods.

    Raises
    ------
    ValueError
        If a column is missing, or of another length.

    Examples
    --------
    >>> import numpy as np
    >>> import bridgectl as bc
    >>> rng, n = np.random.default_rng(1), 5000
    >>> static = 2e5 * rng.weibull(3.0, n)
    >>> daf = 1.1 + 0.1 * rng.normal(size=n) / (1 + static / 2e5)
    >>> same = dict.fromkeys(["kind", "road", "quality"], np.full(n, "")) | dict.fromkeys(
    ...     ["speed", "gross_weight", "n_axles", "least_tire_force", "place moment",
    ...      "time moment"], np.ones(n))
    >>> assessment = bc.Assessment(same | {
    ...     "crossing": np.arange(n), "truck": np.arange(n), "damped": np.zeros(n, dtype=bool),
    ...     "meeting": np.zeros(n, dtype=bool), "static moment": static,
    ...     "total moment": daf * static, "daf moment": daf}, {"moment": "N m"}, trucks_a_day=1000)
    >>> assessment.quantiles("daf", [0.5])
    [Estimate(1.1, 95% between 1.099 and 1.102)]
    >>> print(f"ADR {assessment.adr(return_period=75).value:.2f}")
    ADR 1.09
    """

    def __repr__(self) -> str:
        weight = self.columns["gross_weight"].max() / 1e3
        return (
            f"Assessment({len(self)} crossings of trucks up to {weight:.0f} kN, "
            f"effects={list(self.effects)}, qualities={list(self.qualities)})"
        )

    def __str__(self) -> str:
        return self.summary()

    def quantiles(
        self, quantity: str = "daf", shares: Sequence[float] = SHARES, *,
        effect: str | None = None, quality: str | None = None, damper_share: float | None = None,
    ) -> list[Estimate]:  # fmt: skip
        """Return values that shares of the crossings stay below, whatever the distribution.

        Parameters
        ----------
        quantity : {'daf', 'static', 'total'}, optional
            Of which the distribution is asked.
        shares : sequence of float, optional
            Fractions of the crossings.
        effect, quality, damper_share : optional
            As in `characteristic`.

        Returns
        -------
        list of Estimate
            Values with 95 % intervals of order statistics, in the unit of the quantity; ends that
            so few crossings cannot tell are NaN.

        Raises
        ------
        ValueError
            If an argument is not one of those that there are.
        """
        check.choice("quantity", quantity, QUANTITIES)
        of = self._values(quantity, effect, self._rows(quality, damper_share))
        return [quantile(of, check.fraction("shares", share)) for share in shares]

    def daf_bins(
        self, n_bins: int = N_BINS, *, effect: str | None = None, quality: str | None = None,
        damper_share: float | None = None,
    ) -> DafBins:  # fmt: skip
        """Return the DAF in bins of static effect: it falls as the effect rises.

        Parameters
        ----------
        n_bins : int, optional
            Number of bins of one width from the smallest to the largest static effect.
        effect, quality, damper_share : optional
            As in `characteristic`.

        Returns
        -------
        DafBins
            Edges in the unit of the effect, and counts, means and quantiles of DAF.

        Raises
        ------
        ValueError
            If an argument is not one of those that there are.
        """
        check.integer("n_bins", n_bins, at_least=1)
        rows = self._rows(quality, damper_share)
        return bins_of(
            self._values("static", effect, rows), self._values("daf", effect, rows), n_bins
        )

    def characteristic(
        self, return_period: float = RETURN_PERIOD, *, effect: str | None = None,
        quality: str | None = None, damper_share: float | None = None,
        method: str = METHODS[1], trucks_a_day: float | None = None,
        days_a_year: float = DAYS_A_YEAR, block: int | None = None, threshold: float | None = None,
    ) -> Characteristic:  # fmt: skip
        """Return the total and the static effect that one crossing of a return period exceeds.

        Parameters
        ----------
        return_period : float, optional
            [years]; EN 1991-2 has 1000, AASHTO 75.
        effect, quality : str, optional
            May be left out where there is one.
        damper_share : float, optional
            Share of the trucks that have dampers, of those that were simulated with and without.
            Default: the smallest that there is.
        method : {'peaks over threshold', 'block maxima'}, optional
            Generalized Pareto or extreme value distribution: see `bridgectl.fleet.tails`.
        trucks_a_day : float, optional
            Number of crossings a day. Default: that of the assessment.
        days_a_year : float, optional
            Number of days on which trucks drive.
        block : int, optional
            Number of crossings in a block. Default: a day, or less for 50 blocks.
        threshold : float, optional
            In the unit of the effect. Default: one that the largest n^(2/3) / log(log n) exceed.

        Returns
        -------
        Characteristic
            Both with 95 % intervals, in the unit of the effect, and the fits.

        Raises
        ------
        ValueError
            If blocks or exceedances are too few, or an argument is not one of those that there are.

        Warns
        -----
        PlausibilityWarning
            If the return period is shorter than what was simulated: the value is then that of
            the crossings themselves.
        """
        read = self._read(
            return_period, effect, quality, damper_share, method, trucks_a_day, days_a_year, block,
            threshold,
        )  # fmt: skip
        read.rule.warn_if_short(len(read.total.values))
        sign, total, static = read.sign, read.total, read.static
        return Characteristic(
            total.estimate.times(sign), static.estimate.times(sign), total.tail, static.tail
        )

    def adr(self, return_period: float = RETURN_PERIOD, **options: Any) -> Estimate:
        """Return the assessment dynamic ratio: characteristic total over static effect.

        Its interval is of crossings, or blocks, drawn again with total and static effect in pairs:
        see `bridgectl.fleet.levels`.

        Parameters
        ----------
        return_period : float, optional
            [years].
        **options
            As of `characteristic`.

        Returns
        -------
        Estimate
            A ratio with its 95 % interval; of identical crossings their DAF.

        Raises
        ------
        ValueError
            As of `characteristic`, and for an effect that static loads do not have.

        Warns
        -----
        PlausibilityWarning
            As of `characteristic`.
        """
        read = self._read(return_period, **options)
        read.rule.warn_if_short(len(read.total.values))
        if read.static.value == 0:
            raise ValueError(f"effect must have a static value for a ratio, {read.effect!r} has 0")
        return ratio(read.total, read.static)

    def quality_influence(
        self, quantity: str = "daf", *, effect: str | None = None,
        damper_share: float | None = None,
    ) -> dict[str, Estimate]:  # fmt: skip
        """Return how much each road quality adds to a mean, over the same trucks on the first one.

        Parameters
        ----------
        quantity : {'daf', 'static', 'total'}, optional
            Of which the mean is asked.
        effect, damper_share : optional
            As in `characteristic`.

        Returns
        -------
        dict of str to Estimate
            Mean differences with 95 % intervals (Student's t), in the unit of the quantity.

        Raises
        ------
        ValueError
            If an argument is not one of those that there are.
        """
        check.choice("quantity", quantity, QUANTITIES)
        first, *others = (
            self._by_truck(quantity, effect, self._rows(quality, damper_share))
            for quality in self.qualities
        )
        return {
            quality: mean_of(first, other)
            for quality, other in zip(self.qualities[1:], others, strict=True)
        }

    def damper_influence(
        self, damper_share: float, quantity: str = "daf", *, effect: str | None = None
    ) -> dict[str, Estimate]:
        """Return how much dampers in a share of the trucks add to the mean of all, by quality.

        Parameters
        ----------
        damper_share : float
            Share of the trucks, which were simulated with and without dampers.
        quantity : {'daf', 'static', 'total'}, optional
            Of which the mean is asked.
        effect : str, optional
            May be left out where there is one.

        Returns
        -------
        dict of str to Estimate
            Mean differences with 95 % intervals (Student's t), in the unit of the quantity.

        Raises
        ------
        ValueError
            If so many trucks were not simulated with dampers and without.
        """
        check.choice("quantity", quantity, QUANTITIES)
        return {
            quality: mean_of(*(
                self._by_truck(quantity, effect, self._rows(quality, share))
                for share in (0.0, damper_share)
            ))
            for quality in self.qualities
        }  # fmt: skip

    def summary(self, return_period: float = RETURN_PERIOD, **options: Any) -> str:
        """Return tables of all of it as text.

        Parameters
        ----------
        return_period : float, optional
            [years].
        **options
            Of `characteristic`.

        Returns
        -------
        str
            Lines of 100 columns.
        """
        from bridgectl.fleet.text import assessment_text

        return assessment_text(self, return_period, options)

    def plot(self, return_period: float = RETURN_PERIOD, **options: Any) -> Figure:
        """Return a figure of an effect: see `bridgectl.plots.fleet.fleet_figure`.

        Parameters
        ----------
        return_period : float, optional
            [years].
        **options
            As of `characteristic`.

        Returns
        -------
        matplotlib.figure.Figure

        Raises
        ------
        ValueError
            As of `characteristic`.
        """
        from bridgectl.plots.fleet import fleet_figure  # late, for matplotlib is slow to load

        return fleet_figure(self._read(return_period, **options))

    def _by_truck(
        self, quantity: str, effect: str | None, rows: NDArray[np.integer[Any]]
    ) -> tuple[NDArray[Any], FloatArray]:
        return means_by_truck(self.columns["truck"][rows], self._values(quantity, effect, rows))

    def _sign(self, effect: str | None) -> int:
        """-1 of an effect whose smallest values count, as hogging moments."""
        return -1 if np.median(self.columns[f"total {self._effect(effect)}"]) < 0 else 1

    def _read(
        self, return_period: float, effect: str | None = None, quality: str | None = None,
        damper_share: float | None = None, method: str = METHODS[1],
        trucks_a_day: float | None = None, days_a_year: float = DAYS_A_YEAR,
        block: int | None = None, threshold: float | None = None,
    ) -> Read:  # fmt: skip
        """Read what a return period asks of an effect: see `characteristic`."""
        name, sign = self._effect(effect), self._sign(effect)
        a_day = self.trucks_a_day if trucks_a_day is None else trucks_a_day
        if a_day is None:
            raise ValueError(
                "trucks_a_day must be said for a return period: type trucks_a_day=1000, "
                "or --trucks-a-day 1000"
            )
        limit = None if threshold is None else sign * check.number("threshold", threshold)
        rule = Rule(method, return_period, a_day, days_a_year, block, limit, sign).checked()
        rows = self._rows(quality, damper_share)
        values = {quantity: self._values(quantity, name, rows) for quantity in QUANTITIES}
        for quantity in ("total", "static"):
            check.finite(f"{quantity} {name}", values[quantity])
        daf = {
            each: self._values("daf", name, self._rows(each, damper_share))
            for each in self.qualities
        }
        total, static = (rule.reading(sign * values[each]) for each in ("total", "static"))
        return Read(name, self.effects[name], sign, values["daf"], daf, total, static, rule)
