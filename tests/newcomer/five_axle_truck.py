"""Load the five-axle truck, see its axle loads and frequencies, and let it cross at 60 to 120 km/h."""

import numpy as np

import bridgectl as bc

bridge, truck = bc.li2006.beam(damping_ratio=0.01), bc.trucks.load("T5air")
print("axle loads", (truck.static_loads / 1e3).round(1), "kN")
road = bc.iso8608_profile("A", 150, seed=1, start=-100)
speeds = np.arange(60, 121, 20) / 3.6
moment = bc.peak_effect(bridge, truck, speeds, road, start=-100) / 1e3
daf = bc.daf(bridge, truck, speeds, road, start=-100)
for speed, kNm, factor in zip(speeds, moment, daf, strict=True):
    print(f"{3.6 * speed:.0f} km/h: {kNm:.0f} kN m, DAF {factor:.3f}")
