"""`bridgectl.Fleet`: random or weighed trucks, each the same whoever asks for it."""

from __future__ import annotations

import os
from collections.abc import Mapping
from hashlib import sha256
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from bridgectl import _checks
from bridgectl._labelled import Labelled
from bridgectl._plausible import judge_speed, judge_truck
from bridgectl._toml import parsed
from bridgectl._warn import warn
from bridgectl.fleet.distributions import positive
from bridgectl.fleet.kinds import FACTORS, LOOKS, fleet_path, kinds_of
from bridgectl.fleet.sources import Drawn, Passing, Weighed
from bridgectl.fleet.table import read_rows
from bridgectl.fleet.weighed import DATA, read_unweighed
from bridgectl.fleet.words import UNITS

if TYPE_CHECKING:
    import pandas

DAY = 86_400.0  # s
SHOWN = 3
"""So many rows that are left out are named."""


class Fleet:
    """Trucks that pass, from distributions or a table: `fleet.passing(i)` is the same always.

    Here they are trucks of the catalog with springs, tires, dampers and loads that differ. `load`
    takes a file in which any number of a truck may be drawn, `from_table` weighed trucks.

    A distribution is a number, ``{"min": 18, "max": 25}`` (uniform), ``{"mean": 22, "sd": 2,
    "min": 15, "max": 28}`` (normal, cut off; min and max may be left out), ``{"median": 1,
    "log_sd": 0.1}`` (lognormal, likewise), or a frozen one of `scipy.stats`, which is slower.

    Parameters
    ----------
    kinds : mapping of str to float
        Names of the catalog `bridgectl.trucks.catalog`, or TOML files of trucks, each with its
        share: numbers of any sum, as of a count.
    speed : float or distribution
        [m/s].
    load : float or distribution, optional
        Factor on mass and inertia of the body that carries, the last one, as it is in the catalog:
        loaded.
    suspension, tires, damping : float or distribution, optional
        Factors on the stiffnesses of all suspensions and of all tires, and on the damping of all
        suspensions.
    seed : int, optional
        Another seed makes other trucks.

    Raises
    ------
    TypeError, ValueError
        If a kind is not known, a share or distribution is none, or may give numbers of 0 or less.

    Warns
    -----
    PlausibilityWarning
        If no truck moves as the truck of medians does on its axles: told here, and not of each.

    Examples
    --------
    >>> import bridgectl as bc
    >>> fleet = bc.Fleet(
    ...     {"T2": 300, "T5air": 700}, speed={"mean": 23, "sd": 2, "min": 15, "max": 28},
    ...     load={"min": 0.4, "max": 1.1}, suspension={"median": 1, "log_sd": 0.2}, seed=1,
    ... )
    >>> fleet
    Fleet(30 % T2, 70 % T5air, 15 to 28 m/s, seed=1)
    >>> truck, speed, kind, time = fleet.passing(2)
    >>> print(f"{kind}: {truck.mass / 1e3:.1f} t at {speed:.2f} m/s")
    T5air: 31.0 t at 24.25 m/s
    """

    _source: Drawn | Weighed
    _indices: Any

    def __init__(
        self,
        kinds: Mapping[str, float],
        *,
        speed: Any,
        load: Any = 1.0,
        suspension: Any = 1.0,
        tires: Any = 1.0,
        damping: Any = 1.0,
        seed: int = 0,
    ) -> None:
        if not (isinstance(kinds, Mapping) and kinds):
            raise TypeError(
                f'kinds must be trucks with their shares, got {kinds!r}: type {{"T2": 0.3, '
                '"T5air": 0.7}'
            )
        factors = dict(zip(FACTORS, (load, suspension, tires, damping), strict=True))
        for name, given in factors.items():
            positive(name, given)
        tables = [
            {
                "name": str(name), "truck": name, **factors,
                "share": _checks.positive(f"kinds[{name!r}]", share),
            }
            for name, share in kinds.items()
        ]  # fmt: skip
        self._source = Drawn(kinds_of({"kinds": tables}, speed), _seed(seed))
        self._indices = None
        for kind in self._source.kinds:
            judge_truck(kind.usual)
            judge_speed("speed", kind.speed.ppf(0.5))

    @classmethod
    def load(cls, name: str | os.PathLike[str], *, speed: Any = None, seed: int = 0) -> Fleet:
        """Return the fleet of a TOML file.

        Parameters
        ----------
        name : str or path-like
            A file whose name ends in ``.toml``, or one that ships: 'monte_carlo', ranges of the
            field's Monte Carlo studies. Its keys are told in ``bridgectl/fleet/kinds.py``.
        speed : float or distribution, optional
            Takes the place of the speeds in the file [m/s].
        seed : int, optional
            Another seed makes other trucks.

        Returns
        -------
        Fleet

        Raises
        ------
        TypeError, ValueError
            If there is no such fleet, or the file does not make one, with its name and the key.

        Warns
        -----
        PlausibilityWarning
            As in `Fleet`.

        Examples
        --------
        >>> import bridgectl as bc
        >>> bc.Fleet.load("monte_carlo", seed=1)
        Fleet(50 % two axles, 50 % five axles, 10 to 16 m/s, seed=1)
        """
        path, drawn = fleet_path(name), _seed(seed)
        if speed is not None:  # a mistake of the caller's is none of the file's
            positive("speed", speed, "m/s")
        try:
            content = parsed(path, "fleet", LOOKS["share"], "monte_carlo, which ships")
            source = Drawn(kinds_of(content, speed), drawn)
        except (TypeError, ValueError) as error:
            raise ValueError(f"{path}: {error}") from None
        for kind in source.kinds:
            judge_truck(kind.usual)
            judge_speed("speed", kind.speed.ppf(0.5))
        return cls._made(source)

    @classmethod
    def from_table(
        cls,
        table: Any,
        *,
        columns: Mapping[str, Any] | None = None,
        units: Mapping[str, str] | None = None,
        bad: str = "error",
        decimal: str | None = None,
        axles: str | os.PathLike[str] | None = None,
        seed: int = 0,
    ) -> Fleet:
        """Return the trucks that a weigh-in-motion station weighed, in the order of its table.

        Each has the weighed axle loads and spacings; axles less than 2.5 m apart are a group.
        Trucks of one or two groups are rigid; of more, the first two carry a tractor and the
        others a semi-trailer. What is not weighed is drawn: axles, springs, tires and tractors
        from `axles`. An axle weighs half of its load at most. Where more than two axles carry a
        body, springs and tires are made so that its weight is shared as it was weighed.

        Parameters
        ----------
        table : str, path-like or pandas.DataFrame
            A text file (csv) whose first line names the columns, as ``time;speed_kmh;load_1_kN;
            load_2_kN;spacing_1_m``, or such a table; or 'example', which ships.
        columns : mapping, optional
            Names of columns that are called otherwise, by 'time', 'speed', 'load' and 'spacing':
            ``{"load": ["W1", "W2"], "time": ["Date", "Time"]}``. Without times, order and trucks a
            day are not known.
        units : mapping of str to str, optional
            Units of columns whose names state none, likewise: speeds in 'km/h', 'm/s' or 'mph',
            loads in 'kN', 'N', 'kg', 't', 'kip' or 'lb', spacings in 'm', 'cm', 'mm' or 'ft', times
            in 's' or a form as ``"%d.%m.%Y %H:%M:%S"``. Default of times: ISO 8601.
        bad : {'error', 'leave out'}, optional
            What to do with rows without axles, or with times, speeds, loads or spacings that are
            none or impossible.
        decimal : {'.', ','}, optional
            Decimal mark. Default: as the numbers have it.
        axles : str or path-like, optional
            A TOML file like ``bridgectl/fleet/data/axles.toml``, which is the default: soft
            springs as of T5air in the catalog, and how far they vary in Monte Carlo studies.
        seed : int, optional
            Another seed draws other springs under the same loads.

        Returns
        -------
        Fleet

        Raises
        ------
        TypeError, ValueError
            If the file cannot be read, a column or unit is missing, or a row is bad, with its line.

        Warns
        -----
        UserWarning
            If rows are left out.

        Examples
        --------
        >>> import bridgectl as bc
        >>> fleet = bc.Fleet.from_table("example")
        >>> truck, speed, kind, time = fleet.passing(2)
        >>> kind, (truck.static_loads / 1e3).round(1)
        ('1+1+3', array([52.5, 86.2, 58.9, 60.2, 60.1]))
        """
        _checks.choice("bad", bad, ("error", "leave out"))
        unweighed = read_unweighed(axles)
        path = DATA / "example.csv" if isinstance(table, str) and table == "example" else table
        rows = read_rows(path, columns, units, decimal, bad == "leave out")
        n, duration = len(rows.speed), float(np.ptp(rows.time))
        per_day = (n - 1) / duration * DAY if duration > 0 else np.nan
        if rows.left_out:
            named = "; ".join(rows.left_out[:SHOWN]) + "; ..." * (len(rows.left_out) > SHOWN)
            total = n + len(rows.left_out)
            warn(f"{len(rows.left_out)} of {total} rows are left out: {named}")
        return cls._made(Weighed(rows, duration, per_day, unweighed, _seed(seed)))

    @classmethod
    def _made(cls, source: Drawn | Weighed, indices: Any = None) -> Fleet:
        fleet = cls.__new__(cls)
        fleet._source, fleet._indices = source, indices
        return fleet

    def passing(self, i: int) -> Passing:
        """Return truck i, the same in any order, process and part of a study.

        Parameters
        ----------
        i : int
            From 0 on.

        Returns
        -------
        Passing
            A tuple of vehicle, speed [m/s], kind and time [s].

        Raises
        ------
        IndexError, TypeError, ValueError
            If there is no truck i, or an axle of the truck would have to be held down.
        """
        i = _checks.integer("i", i, at_least=0)
        size = self._size
        if size is not None and i >= size:
            raise IndexError(f"i must be below {size}, the number of trucks, got {i}")
        return self._source.passing(i if self._indices is None else int(self._indices[i]))

    def part(self, indices: ArrayLike) -> Fleet:
        """Return some of the trucks, to be sent to where they are wanted: no others go along.

        Parameters
        ----------
        indices : array_like of int, shape (n,)
            Numbers of trucks of this fleet: `passing(j)` of the part is ``passing(indices[j])``.

        Returns
        -------
        Fleet
            Its `duration` and `per_day` are those of all.

        Raises
        ------
        IndexError, TypeError, ValueError
            If they are no numbers of trucks.
        """
        chosen = np.asarray(indices)
        if chosen.ndim != 1 or chosen.dtype.kind not in "iu" or chosen.size == 0:
            raise TypeError(f"indices must be whole numbers, got {indices!r}: type range(100)")
        if chosen.min() < 0 or (self._size is not None and chosen.max() >= self._size):
            most = "" if self._size is None else f" and below {self._size}, the number of trucks"
            raise IndexError(
                f"indices must be 0 or more{most}, got {chosen.min()} to {chosen.max()}"
            )
        if isinstance(self._source, Weighed):
            return self._made(self._source.part(chosen))
        return self._made(self._source, chosen if self._indices is None else self._indices[chosen])

    def to_pandas(self) -> pandas.DataFrame:
        """Return the trucks as a table; of a fleet without end that of a `part`.

        Returns
        -------
        pandas.DataFrame
            Indexed by 'truck': 'kind', 'time', 'speed', 'gross_weight' and 'n_axles', which are
            what an `Assessment` has; units are in ``attrs["units"]``.
        """
        trucks = [self.passing(i) for i in range(len(self))]
        columns = {
            "kind": [truck.kind for truck in trucks],
            "time": [truck.time for truck in trucks],
            "speed": [truck.speed for truck in trucks],
            "gross_weight": [truck.vehicle.static_loads.sum() for truck in trucks],
            "n_axles": [truck.vehicle.n_tires for truck in trucks],
        }
        return Labelled({"truck": range(len(trucks))}, columns, UNITS).table()

    @property
    def duration(self) -> float:
        """Time from the first to the last truck of a table with times [s], else NaN."""
        return self._source.duration if isinstance(self._source, Weighed) else np.nan

    @property
    def per_day(self) -> float:
        """Number of trucks a day of a table with times, one less over its duration, else NaN."""
        return self._source.per_day if isinstance(self._source, Weighed) else np.nan

    @property
    def left_out(self) -> tuple[str, ...]:
        """Bad rows of the table that were left out, each with its place and what is wrong."""
        return self._source.rows.left_out if isinstance(self._source, Weighed) else ()

    @property
    def kinds(self) -> tuple[str, ...]:
        """Names of all kinds of trucks."""
        return self._source.kind_names

    def digest(self) -> str:
        """Return a short text that only the same trucks have.

        Returns
        -------
        str
        """
        indices = "" if self._indices is None else self._indices.tobytes().hex()
        return sha256(f"{self._source.told()}{indices}".encode()).hexdigest()[:16]

    @property
    def is_finite(self) -> bool:
        """Whether it is a table, or a part of a fleet."""
        return self._size is not None

    @property
    def _size(self) -> int | None:
        return self._source.size if self._indices is None else len(self._indices)

    def __len__(self) -> int:
        if self._size is None:
            raise TypeError("a drawn fleet has no end: type fleet.part(range(1000)) for a part")
        return self._size

    def __bool__(self) -> bool:
        return True

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Fleet):
            return NotImplemented
        return self._source == other._source and np.array_equal(
            [] if self._indices is None else self._indices,
            [] if other._indices is None else other._indices,
        )

    def __hash__(self) -> int:
        return hash((self._source.seed, self._size))

    def __repr__(self) -> str:
        some = "" if self._indices is None else f"{len(self._indices)} of "
        return f"Fleet({some}{self._source})"


def _seed(seed: int) -> int:
    return _checks.integer("seed", seed, at_least=0)
