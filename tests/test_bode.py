"""A crossing frozen along the bridge, and its Bode plots, against python-control's own ways."""

import control as ct
import matplotlib.pyplot as plt
import numpy as np
import pytest

import bridgectl as bc

BEAM = bc.li2006.beam()
DAMPED_TIRE = bc.QuarterCar(9000, 1000, 80e3, 1.8e6, 7e3, tire_damping=5e3)


@pytest.fixture(autouse=True)
def _no_figure_stays_open():
    yield
    plt.close("all")


@pytest.mark.parametrize("vehicle", [DAMPED_TIRE, bc.trucks.load("T2")], ids=["tire", "two-axle"])
@pytest.mark.parametrize("x", [0.0, 7.3])
def test_a_frozen_crossing_is_its_linearization(vehicle, x):
    effects = {"pier": bc.Shear(0.0)}
    frozen = bc.Crossing(BEAM, vehicle, effects=effects, static=True).frozen(x, speed=25.0)
    moving = bc.crossing_system(BEAM, vehicle, 25.0, effects=effects, static=True)
    linear = ct.linearize(moving, 0, t=x / 25.0)
    for made, by_differences in zip(
        (frozen.A, frozen.B, frozen.C, frozen.D), (linear.A, linear.B, linear.C, linear.D),
        strict=True,
    ):  # fmt: skip
        assert made == pytest.approx(by_differences, rel=1e-6, abs=1e-9 * abs(made).max())
    assert frozen.input_labels == moving.input_labels
    assert frozen.output_labels == moving.output_labels
    assert frozen.state_labels == moving.state_labels


def exact_phase(system, hertz):
    """Phase [degrees] by the angles of poles and zeros, those on the axis as on its left.

    As a whole it may be off by turns.
    """

    def angles(roots):
        turns = np.arctan2(w - roots.imag, abs(roots.real))
        return (np.where(roots.real > 1e-6 * abs(roots), -turns, turns)).sum(axis=1)

    w = 2 * np.pi * hertz[:, np.newaxis]
    at_first = np.angle(system(1j * w[0, 0]))
    phase = angles(system.zeros()) - angles(system.poles())
    return np.degrees(phase - phase[0] + at_first)


@pytest.mark.parametrize("output", ["tire_force", "moment"])
def test_curves_are_the_responses_of_the_frozen_crossing_with_phases_unwrapped(output):
    crossing = bc.Crossing(BEAM, bc.li2006.car())
    places = [3.125, 6.25, 12.5]
    plot = crossing.plot_bode(places, outputs=output, limits=(0.2, 40))
    for x, above, below in zip(places, *plot.lines[:, 0], strict=True):
        system = crossing.frozen(x)[output, "road"]
        hertz, decibels = above.get_data()
        roots = np.concatenate([system.poles(), system.zeros()])
        near = abs(hertz[:, np.newaxis] / (abs(roots) / 2 / np.pi) - 1).min(axis=1) < 1e-3
        values = system(2j * np.pi * hertz)
        assert decibels[~near] == pytest.approx(20 * np.log10(abs(values[~near])), abs=0.01)
        phase = exact_phase(system, hertz)[~near]
        assert below.get_ydata()[~near] == pytest.approx(phase, abs=0.3)
        assert 20 < near.sum() < len(hertz) / 2  # narrow resonances are followed
    assert plot.axes[1, 0].get_xlim() == (0.2, 40)


def test_every_place_is_seen_and_named():
    crossing = bc.Crossing(BEAM, bc.li2006.car())
    plot = crossing.plot_bode([0, 6.25, 18.75], outputs=["tire_force", "moment"])
    assert plot.lines.shape == plot.axes.shape == (2, 2)
    assert plot.axes[0, 0].get_ylabel() == "magnitude [dB re 1 N/m]"
    assert plot.axes[1, 1].get_xlabel() == "frequency [Hz]"
    names = [text.get_text() for text in plot.legend.get_texts()]
    assert names == ["0 l: none", "0.25 l", "0.75 l"]
    for lines in plot.lines.flat:  # mirror images cover each other, the narrower on top
        widths = [line.get_linewidth() for line in lines]
        assert widths == sorted(widths, reverse=True)
        assert len({*widths}) == len({line.get_color() for line in lines}) == 3
    # A vehicle at the support moves the tire force, and no moment.
    assert np.isfinite(plot.lines[0, 0][0].get_ydata()).all()
    assert np.isnan(plot.lines[0, 1][0].get_ydata()).all()
    assert plot.lines[0, 1][0].get_label() == "0 l: none"
    assert len({round(line.get_ydata()[0]) for line in plot.lines[1, 1][1:]}) == 1


def test_many_places_have_a_colour_bar_and_one_place_a_line():
    crossing = bc.Crossing(BEAM, bc.li2006.car())
    many = crossing.plot_bode(np.linspace(2, 12, 9), input="damper_force", limits=(1, 10))
    assert many.legend is None
    assert many.axes[0, 0].get_ylabel() == "magnitude [dB re 1/N]"
    (bar,) = many.axes[0, 0].child_axes
    assert bar.get_ylabel() == "place of the vehicle, x/l [-]"
    one = crossing.plot_bode(12.5, outputs=["moment"])
    assert len(one.lines[0, 0]) == 1


def test_control_draws_on_into_the_same_axes():
    crossing = bc.Crossing(BEAM, bc.li2006.car())
    plot = crossing.plot_bode([6.25])
    assert isinstance(plot, ct.ControlPlot)
    assert plot.figure.number in plt.get_fignums()
    other = crossing.frozen(12.5)["moment", "road"]
    omega = 2 * np.pi * np.geomspace(1, 3, 20)
    ct.bode_plot(other, omega, ax=plot.axes[:, 0], Hz=True, dB=True, initial_phase=0)
    drawn = plot.axes[0, 0].lines[1]
    assert drawn.get_xdata() == pytest.approx(omega / 2 / np.pi)
    assert drawn.get_ydata() == pytest.approx(20 * np.log10(abs(other(1j * omega))))
    plot.set_plot_title("two places")
    assert plot.figure.get_suptitle() == "two places"


@pytest.mark.parametrize(
    ("asked", "told"),
    [
        ({"places": []}, "places must be positions along the bridge"),
        ({"outputs": ["momentum"]}, "outputs must be one of .*type 'moment'"),
        ({"input": "rod"}, "input must be one of 'road', 'damper_force', got 'rod': type 'road'"),
        ({"limits": (40, 0.2)}, r"limits must be above 0 Hz and increase, got \[40.0, 0.2\]"),
    ],
)
def test_what_cannot_be_drawn_is_told(asked, told):
    with pytest.raises(ValueError, match=told):
        bc.Crossing(BEAM, bc.li2006.car()).plot_bode(**({"places": [12.5]} | asked))
