"""A vehicle from the side, and the few signals of a response."""

import control
import matplotlib.pyplot as plt
import numpy as np
import pytest
from matplotlib.patches import Circle, FancyBboxPatch

import bridgectl as bc
from bridgectl.plots import response_figure, vehicle_plot
from bridgectl.plots.vehicle_parts import parts_of


@pytest.fixture(autouse=True)
def _no_figure_stays_open():
    yield
    plt.close("all")


def words(ax):
    return [text.get_text() for text in ax.texts]


def bodies_of(ax):
    return [patch for patch in ax.patches if isinstance(patch, FancyBboxPatch)]


def test_a_truck_is_drawn_with_its_loads_and_distances():
    truck = bc.trucks.load("T5air")
    ax = vehicle_plot(truck)
    assert words(ax) == [
        "", "55.2", "", "105", "", "78.3", "", "77.3", "", "76.4",
        "", "3", "", "7.6", "", "1.1", "", "1.1", "kN", "m",
    ]  # fmt: skip
    tires = [patch.center[0] for patch in ax.patches if isinstance(patch, Circle)]
    assert tires == pytest.approx(truck.tire_offsets)
    places = [(body.get_x(), body.get_x() + body.get_width()) for body in bodies_of(ax)]
    assert np.array(places) == pytest.approx(truck.body_places)
    assert ax.get_xlabel() == "behind the first axle [m]"
    assert ax.get_xlim()[0] > ax.get_xlim()[1]  # it drives to the right
    assert ax.get_title(loc="left").startswith("40 t, natural frequencies 1.41, 1.59, 5.24")


def test_a_trailer_stands_on_the_hinge_above_the_tractor():
    tractor, trailer = bodies_of(vehicle_plot(bc.trucks.load("T5")))
    assert trailer.get_y() == pytest.approx(tractor.get_y() + tractor.get_height())


def test_a_mass_without_a_leg_sits_on_its_tire():
    ax = vehicle_plot(bc.Vehicle([[5750.0]], [[0.0]], [[0.0]], [1.6e6]))
    (box,), (tire,) = bodies_of(ax), [patch for patch in ax.patches if isinstance(patch, Circle)]
    assert box.get_y() == pytest.approx(tire.center[1] + tire.radius)


def test_it_draws_into_the_axes_that_are_given():
    ax = vehicle_plot(bc.li2006.car())
    assert vehicle_plot(bc.trucks.load("T2"), ax) is ax
    assert len(bodies_of(ax)) == 2


def test_a_group_has_one_leg_between_its_axles():
    parts = parts_of(bc.trucks.load("T5tridem"), 3.0)
    assert [leg.place for leg in parts.legs] == pytest.approx([0, 3, 10.7])
    assert parts.legs[2].shares == pytest.approx([0, 0, 1 / 3, 1 / 3, 1 / 3])
    assert [leg.body for leg in parts.legs] == [0, 0, 1]
    assert [body.on for body in parts.bodies] == [None, 0]


def test_a_group_whose_leg_is_not_in_its_middle_has_it_where_it_is():
    group = bc.trucks.Axle(4.0, 2e3, 2e6, 3e6, spread=(-0.4, 0.9), inertia=300)
    truck = bc.trucks.rigid(
        bc.trucks.Body(2e4, 6e4, [bc.trucks.Axle(0, 700, 4e5, 2e6), group], 2.5)
    )
    assert [leg.place for leg in parts_of(truck, 3.0).legs] == pytest.approx([0, 4.0])


def test_a_convoy_has_bodies_where_they_are_told_and_boxes_elsewhere():
    convoy = bc.convoy([bc.li2006.car(), bc.trucks.load("T2")], [0, 5])
    parts = parts_of(convoy, 3.0)
    assert [body.tire for body in parts.bodies] == [None, 0]
    assert [leg.body for leg in parts.legs] == [1, 0, 0]
    assert (parts.bodies[1].front, parts.bodies[1].rear) == (-1.5, 1.5)
    close = parts_of(bc.convoy([bc.li2006.car()] * 2, [0, 2]), 3.0)
    assert close.bodies[0].rear < close.bodies[1].front  # boxes do not touch


def test_a_leg_of_a_vehicle_without_damping_is_a_spring_alone():
    def lines(damping):
        car = bc.trucks.half_car(1e4, 5e4, (-2, 2), 900, 6e6, 2e6, damping=damping)
        return len(vehicle_plot(car).lines)

    assert lines(1e4) == lines(0.0) + 4  # rod and piston of two dampers


@pytest.fixture(scope="module")
def response():
    truck = bc.trucks.load("T5air")
    return bc.crossing_response(bc.li2006.beam(), truck, 25.0, static=True)


def test_a_response_is_drawn_by_moment_tire_forces_heave_and_pitch(response):
    figure = response_figure(response).figure
    labels = [ax.get_ylabel().replace("\n", " ") for ax in figure.axes]
    assert labels == [
        "moment $M / M_0$ [-]", "tire force [kN]", "displacement [mm]", "pitch [mrad]",
    ]  # fmt: skip
    assert figure.axes[-1].get_xlabel() == "time [s]"
    names = [[line.get_label() for line in ax.lines] for ax in figure.axes]
    assert names == [
        ["moment", "static"], [f"tire_force_{i}" for i in range(1, 6)], ["yB1"], ["thB1", "thB2"],
    ]  # fmt: skip
    force = figure.axes[1].lines[1].get_ydata()
    assert force == pytest.approx(response.outputs["tire_force_2"] / 1e3)
    pitch = figure.axes[3].lines[1].get_ydata()
    assert pitch == pytest.approx(1e3 * response.outputs["thB2"])


def test_signals_that_are_asked_for_are_drawn_with_their_units(response):
    asked = [
        "deflection", "suspension_travel", "suspension_velocity_1", "yB1_ddot", "thB1_dot",
        "thB_ddot", "yG1_dot", "static_moment",
    ]  # fmt: skip
    figure = response_figure(response, asked).figure
    labels = [ax.get_ylabel().replace("\n", " ") for ax in figure.axes]
    assert labels == [
        "deflection [mm]", "suspension travel [mm]", "suspension velocity [m/s]",
        "acceleration [m/s²]", "pitch [rad/s]", "pitch [rad/s²]", "velocity [m/s]",
        "static_moment [SI unit]",
    ]  # fmt: skip
    assert [len(ax.lines) for ax in figure.axes] == [2, 5, 1, 1, 1, 2, 1, 1]
    assert response_figure(response, "yB1").axes.shape == (1, 1)


def test_a_quarter_car_and_bare_matrices_have_their_body_drawn():
    for car, name in (
        (bc.li2006.car(), "y_s"), (bc.Vehicle([[5750.0]], [[0.0]], [[0.0]], [1.6e6]), "y_1"),
        (bc.convoy([bc.trucks.load("T2")] * 2, [0, 20]), "yB_1"),
    ):  # fmt: skip
        figure = response_figure(bc.crossing_response(bc.li2006.beam(), car, 25.0)).figure
        assert figure.axes[2].lines[0].get_label() == name


@pytest.mark.slow
def test_many_signals_of_one_kind_have_no_legend():
    convoy = bc.convoy([bc.trucks.load("T5")] * 3, [0, 20, 40])
    figure = response_figure(bc.crossing_response(bc.li2006.beam(), convoy, 25.0)).figure
    assert figure.axes[0].get_legend() is not None
    assert figure.axes[1].get_legend() is None
    assert len(figure.axes[1].lines) == 15


def test_a_signal_that_is_not_there_is_told(response):
    with pytest.raises(ValueError, match="outputs must be names of the response, got 'torque'"):
        response_figure(response, ["torque"])


def test_a_response_comes_as_control_plots_do(response):
    plot = response_figure(response, ["moment", "tire_force"])
    assert isinstance(plot, control.ControlPlot)
    assert plot.axes.shape == plot.lines.shape == plot.legend.shape == (2, 1)
    assert [len(lines) for lines in plot.lines[:, 0]] == [2, 5]
    assert all(line.axes is plot.axes[1, 0] for line in plot.lines[1, 0])
    plot.set_plot_title("five axles")
    assert plot.figure.get_suptitle() == "five axles"
