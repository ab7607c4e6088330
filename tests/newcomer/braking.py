"""A truck that brakes on the bridge by 4 m/s^2 beside one that rolls on."""

import bridgectl as bc

bridge, truck = bc.li2006.beam(damping_ratio=0.01), bc.trucks.load("T2")
road = bc.iso8608_profile("A", 125, seed=1, start=-100)
rolls = bc.Motion(80 / 3.6)
brakes = bc.Motion(80 / 3.6, acceleration=[0, -4], changes=[-5])
for name, motion in {"rolls": rolls, "brakes": brakes}.items():
    moment = bc.peak_effect(bridge, truck, motion, road, start=-100)[0]
    axles = bc.crossing_response(bridge, truck, motion, road, start=-100)
    print(f"{name}: {moment / 1e3:.0f} kN m, front axle {axles.outputs['tire_force_1'].max() / 1e3:.1f} kN")
