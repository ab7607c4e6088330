"""What the page on the crossing as a control system draws and checks."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import SimpleNamespace
from typing import Any

import control as ct
import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Rectangle

from bridgectl.plots import style
from pages.claims import hold

PLACE = "place of the tire, x [m]"
MODES = ("body", "bridge 1", "axle", "bridge 2", "bridge 3")


def upper(poles: np.ndarray) -> np.ndarray:
    """Return one pole of each pair, slowest first."""
    poles = poles[poles.imag > 0]
    return poles[np.argsort(abs(poles))]


@style.styled
def blocks() -> Figure:
    """Draw the loop of truck, tire and bridge; what changes with time is blue."""
    fig = Figure(figsize=(10, 4.6), layout="constrained")
    ax = fig.subplots()
    _block(ax, 2.9, 0, "tire\n$W + K_t\\,(\\cdot)$")
    _block(ax, 7.0, 0, "input map\n$\\sin(j\\pi ct/l)$", varying=True)
    _block(ax, 10.3, 0, "beam\n$q_1 \\ldots q_n$")
    _block(ax, 13.9, 0, "moment\n$c_M(t)$", varying=True)
    _block(ax, 7.0, 1.9, "shapes\n$\\sin(j\\pi ct/l)$", varying=True)
    _block(ax, 2.9, -2.1, "truck\n$m_s, m_t, K_s, C$", width=2.4)
    _block(ax, 9.2, -2.1, "your controller", width=2.6)
    ax.add_patch(Circle((0.9, 0), 0.2, fc="white", ec="k", lw=1.3, zorder=2))
    _wire(ax, (-1.1, 0), (0.7, 0), label="road", at=(-0.5, 0.05))
    _wire(ax, (1.1, 0), (1.85, 0))
    _wire(ax, (3.95, 0), (5.95, 0), label="tire_force", at=(4.95, 0.05))
    _wire(ax, (8.05, 0), (9.25, 0))
    _wire(ax, (11.35, 0), (12.85, 0), label="$q,\\ \\dot q$", at=(12.2, 0.05))
    _wire(ax, (14.95, 0), (16.4, 0), label="moment", at=(15.8, 0.05))
    _wire(ax, (11.7, 0), (11.7, 1.9), (8.05, 1.9))
    _wire(ax, (5.95, 1.9), (0.9, 1.9), (0.9, 0.2), label="$v(x_1, t)$", at=(3.4, 1.95))
    _wire(ax, (4.6, 0), (4.6, -1.9), (4.1, -1.9))
    _wire(ax, (1.7, -2.1), (0.9, -2.1), (0.9, -0.2), label="y_t", at=(1.25, -2.05))
    _wire(ax, (4.6, -1.0), (13.9, -1.0), (13.9, -0.55))
    words = "y_s_dot,\nsuspension_velocity"
    _wire(ax, (4.1, -2.3), (7.9, -2.3), label=words, at=(6.2, -2.25))
    corners = (9.2, -2.65), (9.2, -3.3), (2.9, -3.3), (2.9, -2.65)
    _wire(ax, *corners, label="damper_force", at=(6, -3.25))
    for x, y, sign in [(0.45, 0.12, "$-$"), (1.2, 0.3, "$-$"), (1.2, -0.6, "$+$")]:
        ax.text(x, y, sign, ha="center")
    ax.set(xlim=(-1.3, 16.6), ylim=(-3.6, 2.6), aspect="equal")
    ax.set_axis_off()
    return fig


def _block(
    ax: Axes, x: float, y: float, text: str, width: float = 2.1, *, varying: bool = False
) -> None:
    """Draw a block; blue if it changes with time."""
    look = {"fc": style.BRIDGE_TINT if varying else "white", "ec": style.BLUE if varying else "k"}
    ax.add_patch(Rectangle((x - width / 2, y - 0.55), width, 1.1, lw=1.3, zorder=2, **look))
    ax.text(x, y, text, ha="center", va="center", zorder=3)


def _wire(
    ax: Axes, *points: tuple[float, float], label: str = "", at: tuple[float, float] | None = None
) -> None:
    """Draw a signal through some points, with an arrow at its end."""
    ax.plot(*np.transpose(points), color=style.BLACK, lw=1.1, zorder=1)
    ax.annotate("", points[-1], points[-2], arrowprops={"arrowstyle": "-|>", "color": "k"})
    ax.text(*(at or points[0]), label, ha="center", va="bottom", color=style.VERMILLION)


@style.styled
def input_map(x: np.ndarray, rows: np.ndarray, length: float) -> Figure:
    """Draw the entries of the input map over the place of the tire, a line for each mode."""
    fig = Figure(figsize=(7.5, 3.2), layout="constrained")
    ax = fig.subplots()
    ax.axvspan(0, length, color=style.BRIDGE_TINT, zorder=0)
    for j, (row, color) in enumerate(zip(rows.T, style.TRACKS, strict=False)):
        ax.plot(x, 1e6 * row, color=color, label=f"mode {j + 1}")
    ax.set(xlabel=PLACE, ylabel="$b_j$ [$10^{-6}$ 1/kg]", xlim=(x[0], x[-1]))
    ax.legend(loc="lower left")
    return fig


@style.styled
def pole_paths(shares: np.ndarray, loci: np.ndarray) -> Figure:
    """Draw the path of each pole while the truck moves, each with a scale of its own."""
    fig = Figure(figsize=(11, 3.2), layout="constrained")
    axes = fig.subplots(1, len(MODES))
    for ax, poles, name in zip(axes, loci.T, MODES, strict=True):
        dots = ax.scatter(poles.real, poles.imag / 2 / np.pi, c=shares, s=14, cmap="viridis")
        ax.set(xlabel="real part [1/s]", title=name)
        ax.margins(0.25)
        ax.ticklabel_format(useOffset=False, style="plain")
        ax.tick_params(labelsize=8)
        ax.xaxis.set_major_locator(mpl.ticker.MaxNLocator(2))
        ax.yaxis.set_major_locator(mpl.ticker.MaxNLocator(4))
    axes[0].set_ylabel("imaginary part / 2π [Hz]")
    fig.colorbar(dots, ax=axes, label="place of the truck, x/l [-]", pad=0.01)
    return fig


@style.styled
def zero_beside_pole(frozen: ct.StateSpace, frequency: float) -> Figure:
    """Draw the responses to the road around the first frequency [Hz] of the bridge alone."""
    fig = Figure(figsize=(10, 3.2), layout="constrained")
    axes = fig.subplots(1, 2)
    hertz = np.linspace(4.05, 4.13, 801)
    units = {"tire_force": (1e-6, "tire force [kN/mm]"), "moment": (1e-3, "moment / $M_0$ [1/mm]")}
    for ax, (output, (factor, label)) in zip(axes, units.items(), strict=True):
        response = ct.frequency_response(frozen[output, "road"], 2 * np.pi * hertz)
        ax.semilogy(hertz, factor * response.magnitude, color=style.BLUE)
        ax.axvline(frequency, color=style.GREY, ls=":", label="$f_1$ of the bridge alone")
        ax.set(title=f"road → {output}, truck at 0.5 l", ylabel=label)
        ax.set(xlabel="frequency [Hz]", xlim=(hertz[0], hertz[-1]))
    axes[1].set_ylim(0.1, 10)
    axes[0].legend(loc="lower left")
    return fig


@style.styled
def solver_errors(x: np.ndarray, errors: Mapping[str, np.ndarray]) -> Figure:
    """Draw the error of the moment of each simulation over the place of the tire."""
    fig = Figure(figsize=(7.5, 3.6), layout="constrained")
    ax = fig.subplots()
    for (name, error), color in zip(errors.items(), (style.VERMILLION, style.BLUE), strict=True):
        ax.semilogy(x[1:], error[1:], color=color, label=name)
    ax.axhline(0.006, color=style.GREY, ls=":", label="effect of a 1 mm ramp at 0.3 l")
    ax.set(xlabel=PLACE, ylabel="error of the moment / $M_0$ [-]")
    ax.set(xlim=(0, x[-1]), ylim=(1e-10, 1))
    ax.legend(loc="center", bbox_to_anchor=(0.5, 0.34))
    return fig


@style.styled
def closed_loop(
    x: np.ndarray, elevation: np.ndarray, responses: Mapping[str, Any], length: float
) -> Figure:
    """Draw the road, and body acceleration and moment of each response."""
    fig = Figure(figsize=(8.5, 6.4), layout="constrained")
    axes = fig.subplots(3, 1, sharex=True)
    axes[0].plot(x, 1e3 * elevation, color=style.BLACK, lw=1)
    for (name, response), color in zip(responses.items(), (style.GREY, style.BLUE), strict=True):
        axes[1].plot(x, response.outputs["y_s_ddot"], color=color)
        axes[2].plot(x, response.outputs["moment"], color=color, label=name)
    labels = "elevation [mm]", "body acceleration\n[m/s²]", "moment / $M_0$ [-]"
    for ax, label in zip(axes, labels, strict=True):
        ax.axvspan(0, length, color=style.BRIDGE_TINT, zorder=0)
        ax.set_ylabel(label)
    fig.align_ylabels(axes)
    axes[2].legend(loc="upper left")
    axes[2].set(xlabel=PLACE, xlim=(x[0], x[-1]))
    return fig


def print_poles(shares: Sequence[float], poles: Sequence[np.ndarray]) -> None:
    """Print frequency and damping ratio of each pair of poles, a line for each place."""
    print("frequency [Hz] / damping ratio [-]")
    print(" " * 8 + "".join(f"{name:>17}" for name in MODES))
    for share, each in zip(shares, poles, strict=True):
        pairs = [f"{abs(p) / 2 / np.pi:8.3f} /{abs(p.real) / abs(p):7.4f}" for p in upper(each)]
        print(f"x = {share:4} l", " ".join(pairs))


def check(names: dict[str, Any]) -> None:
    """Assert what the page says of poles and zeros, of tolerances, and of the skyhook."""
    n = SimpleNamespace(**names)
    at = 0.4 * n.beam.length
    frozen = n.matrices.frozen(at)
    linear = ct.linearize(n.crossing, 0, t=at / n.speed)
    road = frozen.B[:, 0] - linear.B[:, 0]
    first, second = (abs(n.loci[:, k]) for k in (1, 3))
    ratio = abs(n.loci[:, 1].real) / first
    (passive_ride, passive_daf, _), (sky_ride, sky_daf, _) = n.ratings.values()
    tight = n.errors["rtol 1e-9, atol 1e-12"].max()
    slow = [
        abs(n.matrices.frozen(share * n.beam.length)["moment", "road"](1j * np.pi))
        for share in (0.25, 0.5)
    ]
    mass = (n.truck.sprung_mass + n.truck.unsprung_mass) / (n.beam.mass_per_length * n.beam.length)

    def blocked(share: float) -> float:
        """Return the frequency [Hz] of the zero of the moment on the axis that mode 2 has not."""
        system = n.matrices.frozen(share * n.beam.length)["moment", "road"]
        zeros = upper(system.zeros()) / 2 / np.pi
        own = abs(zeros.imag - n.beam.frequencies[1]) < 1e-3
        return zeros[(abs(zeros.real) < 1e-3) & ~own].imag.min()

    hold([
        ("linearization - frozen at 0.4 l: A, relative",
         abs(linear.A - frozen.A).max() / abs(frozen.A).max(), 0, 1e-6),
        ("the same of its input, relative", abs(road).max() / abs(frozen.B).max(), 0, 1e-6),
        ("mass of the truck over that of the bridge", mass, 0.02, 0.002),
        ("truck at the support: bridge 1 [Hz]",
         first[0] / 2 / np.pi, n.beam.frequencies[0], 1e-6),
        ("truck at the support: its damping ratio", ratio[0], 0, 1e-6),
        ("truck at mid-span: its damping ratio", ratio[-1], 0.0013, 1e-4),
        ("truck at a quarter point: bridge 2 [Hz]", second[20] / 2 / np.pi, 16.3734, 1e-3),
        ("truck at mid-span: bridge 2 [Hz]", second[-1] / 2 / np.pi, n.beam.frequencies[1], 1e-3),
        ("zero of road -> tire_force, over w_1", abs(n.nearest) / n.beam.omega[0], 1, 1e-6),
        ("road -> moment at 0.5 Hz, truck at 0.25 l over 0.5 l", slow[0] / slow[1], 0.5, 0.01),
        ("zero of road -> moment, truck at mid-span [Hz]", blocked(0.5), 9.6, 0.05),
        ("zero of road -> moment, truck at 0.375 l [Hz]", blocked(0.375), 25, 0.2),
        ("DAF, default tolerances: off by", n.peaks["default tolerances"] - 1.1302, 0.006, 1e-3),
        ("DAF, tight tolerances", n.peaks["rtol 1e-9, atol 1e-12"], 1.1302, 1e-4),
        ("tight - fast, largest of the history", tight, 0, 1e-7),
        ("closed loop: DAF - that of bridgectl.dampers", n.dafs[1] - n.same_loop, 0, 1e-3),
        ("40 roads: ride, skyhook over passive", sky_ride / passive_ride, 0.7, 0.05),
        ("40 roads: mean DAF, skyhook - passive", sky_daf - passive_daf, 0.012, 0.006),
    ])  # fmt: skip
