"""A damper law of one's own, with a lag, beside the passive one and bridgehook."""

import casadi as ca

import bridgectl as bc
from bridgectl.dampers import Damper, Strategy, bridgehook

bridge, truck = bc.li2006.beam(), bc.li2006.car()
road = bc.iso8608_profile("B", 125, seed=1, start=-100)
def law(s, g):
    return ca.if_else(s.position > 5, g.c_max, g.c_min)
mine = Damper(Strategy("stiff on the bridge", law, 1e3, 30e3), lag=0.01)
for name, damper in {"passive": None, "mine": mine, "hook": bridgehook(bridge, truck, 1e3, 30e3)}.items():
    print(name, bc.daf(bridge, truck, 80 / 3.6, road, start=-100, damper=damper))
