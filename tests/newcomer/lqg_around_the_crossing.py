"""LQG around the crossing: an actuator that calms the body, and what the bridge gets of it."""

import control as ct

import bridgectl as bc

beam, truck, c = bc.li2006.beam(damping_ratio=0.01), bc.li2006.car(), 80 / 3.6
crossing, kept = bc.crossing_system(beam, truck, c), ["moment", "y_s_ddot"]
p = ct.linearize(crossing, 0, t=12.5 / c, copy_names=True)["y_s_dot", ["road", "damper_force"]]
k = ct.lqr(p.A, p.B[:, 1:], p.C.T @ p.C, 1e-12)[0]
f = ct.lqe(p.A, p.B[:, :1], p.C, 1e-4, 1e-8)[0]
lqg = ct.ss(p.A - p.B[:, 1:] @ k - f @ p.C, f, -k, 0, inputs="y_s_dot", outputs="damper_force")
loop = ct.interconnect([crossing, lqg], inputs="road", outputs=kept, check_unused=False)
no = bc.crossing_response(beam, truck, c, bc.iso8608_profile("B", 45, seed=1, start=-20), start=-20)
yes = ct.input_output_response(loop, no.time, no.inputs["road"], solve_ivp_kwargs={"rtol": 1e-8})
for name, run in {"passive": no, "LQG": yes}.items():
    moment, body = (abs(run.outputs[signal]).max() for signal in kept)
    print(f"{name}: DAF {moment:.3f}, body at most {body:.2f} m/s^2")
