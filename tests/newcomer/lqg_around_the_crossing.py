"""LQG around the crossing: an actuator in the suspension, designed with the truck at mid-span."""

import control as ct
import numpy as np

import bridgectl as bc

bridge, truck, speed = bc.li2006.beam(damping_ratio=0.01), bc.li2006.car(), 100 / 3.6
crossing = bc.crossing_system(bridge, truck, speed)
middle = ct.linearize(crossing, 0, t=12.5 / speed, copy_names=True)
plant = middle[["suspension_travel", "y_s_dot", "moment"], ["damper_force", "road"]]
gain, _, _ = ct.lqr(plant.A, plant.B[:, :1], 1e4*plant.C[2:].T @ plant.C[2:], 1e-8*np.eye(1))
filt, _, _ = ct.lqe(plant.A, plant.B[:, 1:], plant.C[:2], 1e-4*np.eye(1), 1e-8 * np.eye(2))
lqg = ct.ss(plant.A - plant.B[:, :1] @ gain - filt @ plant.C[:2], filt, -gain, 0, inputs=["suspension_travel", "y_s_dot"], outputs=["damper_force"])
loop = ct.interconnect([crossing, lqg], inputs=["road"], outputs=["moment", "damper_force"], check_unused=False)
t = np.linspace(0, 25 / speed, 500)
for sys in (crossing, loop):
    sim = ct.input_output_response(loop, t, 0*t, solve_ivp_kwargs={"rtol":1e-8,"atol":1e-10})
    print(sim.outputs["moment"].max(), abs(sim.outputs["damper_force"]).max())
print(bc.daf(bridge, truck, speed))
