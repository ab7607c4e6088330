"""The bending moment at a section, recovered from truncated modes in three ways.

'exact' (the default)
    M = M_R + M_mu: the tire forces R through the static influence line, plus the inertia and
    damping forces of the modes, M_mu = - sum_j mu (q_j'' + 2 w_b q_j') (l / j pi)^2 sin(j pi s).
    A few modes suffice, and the DAF tends to 1 at creeping speed for any number of them.
'li2006'
    Eqs. (5)-(8) of Li, OBrien and Gonzalez (2006) as printed. The 1/12 of Eq. (8) belongs to
    v_0 = W l^3 / (48 E J), while Eq. (5) prints 2 W l^3 / (pi^4 E J): together they scale M_mu by
    pi^4 / 96 = 1.01468, and Eq. (8) has no damping term. This is what reproduces the printed DAF
    of 1.1302 at 110 km/h, where 'exact' gives 1.1284.
'modal'
    M = E J sum_j (j pi / l)^2 q_j sin(j pi s), which converges as 1 / n.

Eq. (4) prints sin(j pi c t / l) for the shape at the section; sin(j pi s) is meant.
"""

from __future__ import annotations

import numpy as np

from bridgectl._checks import FloatArray
from bridgectl.model.bridge import BridgeModel

RECOVERIES = ("exact", "li2006", "modal")

LI2006_INERTIA_SCALE = np.pi**4 / 96
"""Factor on M_mu that Eqs. (5) and (8) have as printed."""


def recover(
    bridge: BridgeModel, line: FloatArray, of_modes: FloatArray, tires: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Rows of any effect on tire forces and bridge states, as 'exact' has it.

    E = sum_k R_k I(x_k) - sum_j (q_j'' + 2 zeta_j w_j q_j') E_j / w_j^2, where the modal equation
    eliminates q_j'': of the influence line I at the tires, shape (..., n_tires), and the effect of
    each mode's shape E_j, shape (n_modes,).
    """
    carried = of_modes / (bridge.modal_masses * bridge.omega**2)
    per_force = line - bridge.mode_shapes(tires) @ carried
    return per_force, np.kron(of_modes, [1.0, 0.0])


def recover_moment(
    beam: BridgeModel, section: float, recovery: str, tires: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Rows of the bending moment at a section, a fraction of the span, on forces and beam states.

    The modal equation eliminates q_j'' from M_mu: what remains is the modal moment, minus the share
    of the static moment that the truncated modes carry. Rows per force [N m / N] have the shape of
    the tires' places [m], (..., n_tires); those per beam state, (2 n_modes,), are the same there.
    """
    displacement = beam.modal_moments(section)
    velocity = np.zeros(beam.n_modes)
    if recovery == "modal":
        return np.zeros_like(tires), np.column_stack([displacement, velocity]).ravel()
    scale = 1.0
    if recovery == "li2006":
        scale = LI2006_INERTIA_SCALE
        # Eq. (8) has q_j'' alone: the damping that 'exact' adds to it stays in the row.
        velocity = displacement * 2 * beam.damping_ratios / beam.omega
    # Static moment at the section that mode j carries of a unit force on its crest.
    carried = beam.modal_moments(section) / (beam.modal_masses * beam.omega**2)
    per_force = beam.influence_line(tires, section) - scale * (beam.mode_shapes(tires) @ carried)
    return per_force, scale * np.column_stack([displacement, velocity]).ravel()
