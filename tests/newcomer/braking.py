"""A truck that brakes by 4 m/s^2 from 5 m before the bridge on, beside one that rolls."""

import bridgectl as bc

axles = {"axle_mass": (700, 1100), "suspension_stiffness": (4e5, 9e5), "damping": (2e4, 4e4)}
truck = bc.trucks.half_car(14e3, 6e4, (-2.8, 1.7), **axles, tire_stiffness=(2e6, 4e6), height=1.4)
road = bc.iso8608_profile("A", 125, seed=1, start=-100)
brakes = bc.Motion(80 / 3.6, acceleration=[0, -4], changes=[-5])
for name, motion in {"rolls": 80 / 3.6, "brakes": brakes}.items():
    moment, front, rear = bc.peak_effect(
        bc.li2006.beam(damping_ratio=0.01), truck, motion, road, start=-100,
        effect=[bc.Moment(), bc.TireForce(1), bc.TireForce(2)],
    )[:, 0] / 1e3  # fmt: skip
    print(f"{name}: {moment:.0f} kN m, front axle {front:.1f} kN, rear axle {rear:.1f} kN")
