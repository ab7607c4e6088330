"""How far a damper must reach: mean DAF of bridgehook over roads for soft and stiff bounds."""

import numpy as np

import bridgectl as bc

bridge, truck = bc.li2006.beam(), bc.li2006.car()
roads = [bc.iso8608_profile("A", 45, seed=k, start=-20) for k in range(4)]
for c_min, c_max in [(7e3, 7e3), (4e3, 15e3), (1e3, 15e3), (1e3, 30e3)]:
    hook = bc.dampers.bridgehook(bridge, truck, c_min, c_max)
    dafs = [bc.daf(bridge, truck, 22.0, road, start=-20, damper=hook) for road in roads]
    print(f"{c_min / 1e3:.0f} to {c_max / 1e3:.0f} kN s/m: mean DAF {np.mean(dafs):.3f}")
