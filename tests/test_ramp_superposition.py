"""Eqs. (9)-(13): ramps superpose, through control.forced_response."""

import control as ct
import numpy as np
import pytest

MASS, STIFFNESS, SPEED, LENGTH = 1000.0, 1.8e6, 30.0, 0.1
OMEGA = np.sqrt(STIFFNESS / MASS)
END = LENGTH / SPEED
# A multiple of the ramp's duration is a sample: forced_response is exact between samples.
TIME = np.linspace(0, 40 * END, 1601)


def ramp(start):
    """A drop of 1 mm over 100 mm, in units of time."""
    return 0.001 * np.clip((TIME - start) / END, 0, 1)


def simulated(road):
    oscillator = ct.tf([STIFFNESS], [MASS, 0, STIFFNESS])  # Eq. (9)
    return ct.forced_response(oscillator, TIME, road).outputs


def printed(start):
    """Eq. (10), and Eq. (11) for a ramp that starts later."""
    t = TIME - start
    rising = t / END - np.sin(OMEGA * t) / (OMEGA * END)
    after = 1 + (np.sin(OMEGA * (t - END)) - np.sin(OMEGA * t)) / (OMEGA * END)
    return 0.001 * np.where(t < 0, 0, np.where(t <= END, rising, after))


@pytest.mark.parametrize("start", [0.0, END])
def test_equations_10_and_11_are_the_response_to_one_ramp(start):
    assert simulated(ramp(start)) == pytest.approx(printed(start), abs=1e-12)


@pytest.mark.parametrize(("down", "up"), [(1.0, 1.0), (3.0, 5.0), (10.0, 2.0)])
def test_equation_13_is_h1_times_equation_10_minus_h2_times_equation_11(down, up):
    both = simulated(down * ramp(0.0) - up * ramp(END))  # Eq. (12)
    assert both == pytest.approx(down * printed(0.0) - up * printed(END), abs=1e-12)
