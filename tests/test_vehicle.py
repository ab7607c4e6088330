import dataclasses

import control as ct
import numpy as np
import pytest

import bridgectl as bc


def sprung_mass(**change):
    """A mass on one tire: the classical sprung mass of moving-load studies."""
    parameters = {
        "mass_matrix": [[5750.0]],
        "damping_matrix": [[0.0]],
        "stiffness_matrix": [[0.0]],
        "tire_stiffnesses": [1.595e6],
    }
    return bc.Vehicle(**{**parameters, **change})


def test_the_quarter_car_has_the_state_matrix_of_equations_1_and_2():
    car = bc.li2006.car()
    ms, mt, ks, kt, c = 9000.0, 1000.0, 80e3, 1.8e6, 7e3
    expected = [
        [0, 1, 0, 0],
        [-ks / ms, -c / ms, ks / ms, c / ms],
        [0, 0, 0, 1],
        [ks / mt, c / mt, -(ks + kt) / mt, -c / mt],
    ]
    assert pytest.approx(np.array(expected)) == car.system().A
    assert car.system().state_labels == ["y_s", "y_s_dot", "y_t", "y_t_dot"]


def test_a_drop_of_the_road_unloads_the_tire_at_once_and_lowers_the_truck_in_the_end():
    system = bc.li2006.car().system()
    assert system.D[0, 0] == -1.8e6
    assert system.dcgain()[:, 0] == pytest.approx([0.0, 1.0, 1.0], abs=1e-9)


def test_the_damper_force_acts_upward_on_the_body_and_downward_on_the_axle():
    system = bc.li2006.car().system()
    assert system.B[:, 1] == pytest.approx([0, -1 / 9000, 0, 1 / 1000])


def test_static_loads_of_a_quarter_car_are_its_weight():
    assert bc.li2006.car().linear.static_loads == pytest.approx([98100.0])


def test_static_loads_of_a_half_car_follow_the_lever_rule():
    ahead, behind = 1.5, 2.5
    legs = np.array([[1, -ahead, -1, 0], [1, behind, 0, -1]])
    car = bc.Vehicle(
        mass_matrix=np.diag([12000, 20000, 700, 900]),
        damping_matrix=1e4 * legs.T @ legs,
        stiffness_matrix=2e5 * legs.T @ legs,
        tire_stiffnesses=[1.8e6, 3.6e6],
        tire_offsets=[0, ahead + behind],
        damper_map=legs,
        heave=[1, 0, 1, 1],
    )
    body = 12000 * 9.81 * np.array([behind, ahead]) / (ahead + behind)
    assert car.static_loads == pytest.approx(body + 9.81 * np.array([700, 900]))
    assert car.mass == pytest.approx(13600)
    assert car.system().input_labels == ["road_1", "road_2", "damper_force_1", "damper_force_2"]


def test_a_convoy_is_its_vehicles_side_by_side():
    convoy = bc.convoy([bc.li2006.car(), sprung_mass()], [0, 7.5])
    assert convoy.static_loads == pytest.approx([98100.0, 5750 * 9.81])
    assert convoy.tire_offsets == pytest.approx([0, 7.5])
    assert convoy.coordinates == ("y_s_1", "y_t_1", "y_1_2")
    alone = [*bc.li2006.car().system().poles(), *sprung_mass().system().poles()]
    assert np.sort_complex(convoy.system().poles()) == pytest.approx(
        np.sort_complex(np.array(alone)), abs=1e-6
    )


def test_free_response_decays_as_the_quarter_cars_poles_say():
    system = bc.li2006.car().system()
    time = np.linspace(0, 2, 201)
    response = ct.initial_response(system, time, [0.01, 0, 0, 0])
    values, vectors = np.linalg.eig(system.A)
    weights = np.linalg.solve(vectors, [0.01, 0, 0, 0])
    expected = (vectors[0] * weights) @ np.exp(np.outer(values, time))
    assert response.outputs[1] == pytest.approx(expected.real, abs=1e-9)


def test_vehicles_are_values():
    assert bc.li2006.car() == bc.li2006.car()
    assert bc.li2006.car().linear == bc.li2006.car().linear
    assert hash(bc.li2006.car().linear) == hash(bc.li2006.car().linear)
    assert bc.li2006.car().linear != dataclasses.replace(bc.li2006.car(), damping=8e3).linear
    assert bc.li2006.car().linear != "a truck"
    with pytest.raises(AttributeError):
        bc.li2006.car().linear.heave = 3
    with pytest.raises(ValueError, match="read-only"):
        bc.li2006.car().linear.mass_matrix[0, 0] = 1.0
    assert "damping=7000 N s/m" in repr(bc.li2006.car())
    assert repr(sprung_mass()) == (
        "Vehicle(1 coordinates, mass=5750 kg, tires at [0] m behind the first, 0 dampers)"
    )


@pytest.mark.parametrize(
    ("change", "error", "says"),
    [
        ({"sprung_mass": -9000}, ValueError, "sprung_mass must be above 0 [kg], got -9000"),
        ({"unsprung_mass": 0}, ValueError, "unsprung_mass must be above 0 [kg]"),
        ({"suspension_stiffness": None}, TypeError, "suspension_stiffness must be one number"),
        ({"tire_stiffness": np.inf}, ValueError, "tire_stiffness must be finite [N/m]"),
        ({"damping": -1}, ValueError, "damping must be 0 or more [N s/m], got -1"),
        ({"damping": np.nan}, ValueError, "damping must be finite"),
        ({"damping": True}, TypeError, "damping must be one number"),
        ({"tire_damping": -1}, ValueError, "tire_damping must be 0 or more [N s/m], got -1"),
    ],
)
def test_a_bad_quarter_car_parameter_is_named(change, error, says):
    with pytest.raises(error) as caught:
        dataclasses.replace(bc.li2006.car(), **change)
    assert says in str(caught.value)


def test_a_truck_in_tonnes_draws_a_warning():
    with pytest.warns(UserWarning, match="mass is 10 kg: are its masses in tonnes"):
        dataclasses.replace(bc.li2006.car(), sprung_mass=9.0, unsprung_mass=1.0)


@pytest.mark.parametrize(
    ("change", "error", "says"),
    [
        ({"mass_matrix": [[1.0, 2.0]]}, ValueError, "mass_matrix must have shape (1, 1)"),
        ({"mass_matrix": [[-5750.0]]}, ValueError, "must not have negative eigenvalues"),
        ({"mass_matrix": [[0.0]]}, ValueError, "every mass above 0 kg"),
        ({"mass_matrix": "heavy"}, TypeError, "mass_matrix must be an array of numbers"),
        ({"mass_matrix": [[1.0], [2.0, 3.0]]}, TypeError, "mass_matrix must be an array"),
        ({"damping_matrix": [1.0]}, ValueError, "damping_matrix must have shape (1, 1), got (1,)"),
        ({"stiffness_matrix": [[np.nan]]}, ValueError, "stiffness_matrix must be finite"),
        ({"tire_stiffnesses": []}, ValueError, "tire_stiffnesses must all be above 0 N/m"),
        ({"tire_stiffnesses": [-1.0]}, ValueError, "tire_stiffnesses must all be above 0 N/m"),
        ({"tire_offsets": [2.0]}, ValueError, "tire_offsets must be distances behind"),
        ({"tire_offsets": [0.0, 1.0]}, ValueError, "tire_offsets must have shape (1,)"),
        ({"tire_map": [[0.0]]}, ValueError, "leave a coordinate without support"),
        ({"heave": [-1.0], "tire_map": [[1.0]]}, ValueError, "must carry a static load above 0"),
        ({"coordinates": ["y", "z"]}, ValueError, "coordinates must be 1 different names"),
        ({"tire_damping": -1.0}, ValueError, "tire_damping must be 0 or more"),
        ({"tire_damping": [1.0, 2.0]}, ValueError, "tire_damping must have shape (1,)"),
        ({"tire_damping": [-1.0]}, ValueError, "tire_damping must be 0 N s/m or more"),
        ({"pitch_input": [1.0, 2.0]}, ValueError, "pitch_input must have shape (1,)"),
    ],
)
def test_a_bad_vehicle_parameter_is_named(change, error, says):
    with pytest.raises(error) as caught:
        sprung_mass(**change)
    assert says in str(caught.value)


def test_an_asymmetric_stiffness_matrix_is_an_error():
    with pytest.raises(ValueError, match="stiffness_matrix must be symmetric"):
        bc.Vehicle(np.eye(2) * 100, np.zeros((2, 2)), [[1.0, 2.0], [0.0, 1.0]], [1.0])


def test_a_convoy_needs_vehicles_and_one_offset_each():
    with pytest.raises(ValueError, match="vehicles must hold at least one"):
        bc.convoy([], [])
    with pytest.raises(ValueError, match=r"offsets must have shape \(1,\)"):
        bc.convoy([bc.li2006.car()], [0, 5])


def test_a_vehicle_without_its_passive_dampers_has_their_forces_no_more():
    legs = np.array([[1.0, -1.5, -1.0, 0.0], [1.0, 2.5, 0.0, -1.0]])
    damping = legs.T @ np.diag([10e3, 20e3]) @ legs
    car = bc.Vehicle(
        np.diag([12000.0, 20000, 700, 900]), damping, 200e3 * legs.T @ legs, [1.8e6, 3.6e6],
        [0.0, 4.0], damper_map=legs, heave=[1.0, 0, 1, 1], damper_dampings=[10e3, 20e3],
        damper_names=["front", "rear"],
    )  # fmt: skip
    np.testing.assert_allclose(car.undamped.damping_matrix, 0.0, atol=1e-9)  # N s/m
    np.testing.assert_array_equal(car.undamped.damper_dampings, 0.0)
    # The upper ends, travel and lower ends together, are places of the body.
    np.testing.assert_array_equal((car.damper_map + car.damper_axles)[:, 2:], 0.0)
    with pytest.raises(ValueError, match="damper_dampings must be 0 N s/m or more"):
        dataclasses.replace(car, damper_dampings=[-1.0, 0.0])


def test_dampers_fewer_than_tires_stand_on_the_nearest_hubs():
    car = bc.convoy([bc.li2006.car(), bc.li2006.car()], [0, 5])
    fewer = dataclasses.replace(
        car,
        damper_map=car.damper_map[1:],
        damper_axles=None,
        damper_dampings=None,
        damper_names=None,
    )
    np.testing.assert_array_equal(fewer.damper_axles, car.tire_map[1:])
