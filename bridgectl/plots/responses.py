"""What happens on a bridge, over time: the few signals of a response that tell most."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

import control
import matplotlib.pyplot as plt
import numpy as np

from bridgectl.plots import style
from bridgectl.plots.shown import ResponseShown

KINDS = (
    (r"moment", "moment\n$M / M_0$ [-]", 1.0),
    (r"deflection", "deflection\n[mm]", 1e3),
    (r"tire_force", "tire force\n[kN]", 1e-3),
    (r"suspension_travel", "suspension\ntravel [mm]", 1e3),
    (r"suspension_velocity", "suspension\nvelocity [m/s]", 1.0),
    (r"damper_force", "damper force\n[kN]", 1e-3),
    (r"th\w+_ddot", "pitch [rad/s²]", 1.0),
    (r"th\w+_dot", "pitch [rad/s]", 1.0),
    (r"th\w+", "pitch [mrad]", 1e3),
    (r"\w+_ddot", "acceleration\n[m/s²]", 1.0),
    (r"\w+_dot", "velocity\n[m/s]", 1.0),
    (r"y\w*", "displacement\n[mm]", 1e3),
    (r"road_rate", "road rate\n[m/s]", 1.0),
    (r"road", "road\n[mm]", 1e3),
)
"""Labels and units of signals by their names, of which the first that fits counts."""

SI = {"kN": "N", "mm": "m", "mrad": "rad", "-": "1"}
"""Units of the library, of those that are drawn."""

USUAL = ("moment", "tire_force", "yB", "thB")
"""What is drawn if nothing is asked for: of bodies heave and pitch."""

HEAVES = ("yB", "y_s", "y_1")
"""Names that the coordinate of a body may have."""

HEIGHT, WIDTH, MOST_NAMED = 1.7, 8.0, 10
"""Height of a panel and width of a figure [in]; signals of a panel that get a name."""


@style.styled
def response_figure(response: ResponseShown, outputs: Sequence[str] = ()) -> control.ControlPlot:
    """Draw a few outputs of a crossing over time, those of one kind in one panel.

    As what the control library draws: `ControlPlot.figure` has the figure, one of pyplot.

    Parameters
    ----------
    response : control.TimeResponseData
        What `bridgectl.crossing_response` returns; with ``static=True`` static values are dashed.
    outputs : sequence of str, optional
        Names of outputs, a panel each; 'tire_force' or 'yB' stands for all that are numbered.
        Default: moment, tire forces, and heave and pitch of the bodies.

    Returns
    -------
    control.ControlPlot
        With `lines` and `axes` of shape (n_panels, 1).

    Raises
    ------
    ValueError
        If there is no such output.

    Examples
    --------
    >>> import bridgectl as bc
    >>> truck = bc.trucks.load("T2")
    >>> response = bc.crossing_response(bc.li2006.beam(), truck, 25.0, static=True)
    >>> plot = bc.plots.response_figure(response)
    >>> [ax.get_ylabel().replace(chr(10), " ") for ax in plot.axes[:, 0]]
    ['moment $M / M_0$ [-]', 'tire force [kN]', 'displacement [mm]', 'pitch [mrad]']
    """
    signals = dict(zip(response.output_labels, np.asarray(response.outputs), strict=True))
    asked = [outputs] if isinstance(outputs, str) else list(outputs)
    panels = [_named(name, signals) for name in asked] or list(_usual(signals))
    figure = plt.figure(figsize=(WIDTH, 0.5 + HEIGHT * len(panels)), layout="tight")
    axes = figure.subplots(len(panels), 1, sharex=True, squeeze=False)[:, 0]
    lines = np.empty((len(panels), 1), dtype=object)
    legends = np.full(lines.shape, None)
    for k, (ax, names) in enumerate(zip(axes, panels, strict=True)):
        label, factor = _kind(names[0])
        colors = [f"C{i}" for i in range(len(names))] if len(names) > len(style.TRACKS) else (
            style.TRACKS
        )  # fmt: skip
        for name, color in zip(names, colors, strict=False):
            ax.plot(response.time, factor * signals[name], color=color, lw=1.4, label=name)
            if (static := f"static_{name}") in signals:
                ax.plot(response.time, factor * signals[static], "--", color=style.GREY, lw=1.2,
                        label="static")  # fmt: skip
        ax.set_ylabel(label)
        if len(names) <= MOST_NAMED:
            legends[k, 0] = ax.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), fontsize=8)
        lines[k, 0] = list(ax.lines)
    axes[-1].set(xlabel="time [s]", xlim=(response.time[0], response.time[-1]))
    figure.align_ylabels(axes)
    return control.ControlPlot(lines, axes[:, np.newaxis], figure, legends)


def _usual(signals: dict[str, object]) -> Iterator[list[str]]:
    """Panels of what is usually looked at, as far as there is any."""
    for name in USUAL:
        others = HEAVES if name == "yB" else (name,)
        for each in others:
            if found := _numbered(each, signals):
                yield found
                break


def _numbered(name: str, signals: dict[str, object]) -> list[str]:
    """The signals of a name, and of that name with numbers, as yB1_2_dot of yB_dot."""
    stem, dot, order = name.partition("_d")
    number = r"(_\d+)*" if stem[-1:].isdigit() else r"\d*(_\d+)*"
    pattern = re.escape(stem) + number + re.escape(dot + order)
    return [label for label in signals if re.fullmatch(pattern, label)]


def _named(name: str, signals: dict[str, object]) -> list[str]:
    found = [name] if name in signals else _numbered(name, signals)
    if not found:
        known = ", ".join(signals)
        raise ValueError(f"outputs must be names of the response, got {name!r}: there are {known}")
    return found


def _kind(name: str) -> tuple[str, float]:
    """Label and factor of a signal; of further effects, whose unit is not known, SI units."""
    for pattern, label, factor in KINDS:
        if re.fullmatch(rf"{pattern}(_\d+)*", name):
            return label, factor
    return f"{name}\n[SI unit]", 1.0


def unit_of(name: str) -> str:
    """Return the SI unit of a signal."""
    unit = _kind(name)[0].partition("[")[2].rstrip("]")
    return SI.get(unit, unit)
