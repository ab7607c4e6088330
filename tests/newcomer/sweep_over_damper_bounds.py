"""How far a damper must reach: DAF of bridgehook for softer and stiffer bounds."""

import numpy as np

import bridgectl as bc

bridge, truck, speeds = bc.li2006.beam(), bc.li2006.car(), np.array([70, 90, 110]) / 3.6
roads = [bc.iso8608_profile("A", 65, seed=k, start=-40) for k in range(5)]
for c_min, c_max in [(7e3, 7e3), (4e3, 15e3), (1e3, 15e3), (1e3, 30e3)]:
    hook = bc.dampers.bridgehook(bridge, truck, c_min, c_max)
    dafs = [bc.daf(bridge, truck, speeds, road, start=-40, damper=hook) for road in roads]
    print(f"{c_min / 1e3:g} to {c_max / 1e3:g} kN s/m: mean DAF {np.mean(dafs):.3f}")
