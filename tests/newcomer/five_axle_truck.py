"""A five-axle truck of the catalog: its axle loads, peak moments and DAF at 60 to 120 km/h."""

import numpy as np

import bridgectl as bc

bridge, truck = bc.li2006.beam(damping_ratio=0.01), bc.trucks.load("T5air")
print("axle loads", (truck.static_loads / 1e3).round(1), "kN")
road, speeds = bc.iso8608_profile("A", 125, seed=1, start=-100), np.arange(60, 121, 20) / 3.6
moments = bc.peak_effect(bridge, truck, speeds, road, start=-100) / 1e3
dafs = bc.daf(bridge, truck, speeds, road, start=-100)
for speed, moment, daf in zip(speeds, moments, dafs, strict=True):
    print(f"{3.6 * speed:.0f} km/h: {moment:.0f} kN m, DAF {daf:.3f}")
