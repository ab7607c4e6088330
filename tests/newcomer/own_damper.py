"""A damper law of one's own, which a valve follows with a lag, beside passive and bridgehook."""

import casadi as ca
import numpy as np

import bridgectl as bc
from bridgectl.dampers import Damper, Strategy, bridgehook

bridge, truck = bc.li2006.beam(), bc.li2006.car()
roads = [bc.iso8608_profile("B", 45, seed=k, start=-20) for k in range(3)]
sinking = Strategy(
    "mine", lambda s, g: ca.if_else(s.body_velocity > 0, g.c_max, g.c_min), 1e3, 30e3
)
hook = bridgehook(bridge, truck, 1e3, 30e3)
for name, damper in {"passive": None, "mine": Damper(sinking, lag=0.01), "hook": hook}.items():
    dafs = [bc.daf(bridge, truck, 80 / 3.6, road, start=-20, damper=damper) for road in roads]
    print(f"{name}: DAF {np.mean(dafs):.3f} at 80 km/h, mean of {len(roads)} roads")
