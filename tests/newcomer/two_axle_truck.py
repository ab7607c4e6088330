"""A truck of two axles from its data sheet: axle loads, frequencies and peak moments."""

import bridgectl as bc

truck = bc.trucks.half_car(
    body_mass=14e3, inertia=6e4, places=(-2.8, 1.7), axle_mass=(700, 1100), damping=(2e4, 4e4),
    suspension_stiffness=(4e5, 9e5), tire_stiffness=(1.75e6, 3.5e6)
)  # fmt: skip
print("axle loads", (truck.static_loads / 1e3).round(1), "kN")
print("frequencies", truck.frequencies.round(2), "Hz")
road, speeds = bc.iso8608_profile("B", 125, seed=1, start=-100), [60 / 3.6, 80 / 3.6, 100 / 3.6]
moments = bc.peak_effect(bc.li2006.beam(damping_ratio=0.01), truck, speeds, road, start=-100)
for speed, moment in zip(speeds, moments, strict=True):
    print(f"{3.6 * speed:.0f} km/h: {moment / 1e3:.0f} kN m")
