"""A damper law with a filter: skyhook on a body velocity without what is slower than 0.2 Hz."""

import casadi as ca

import bridgectl as bc
from bridgectl.dampers import Strategy

bridge, truck = bc.li2006.beam(), bc.li2006.car()
road = bc.iso8608_profile("B", 125, seed=1, start=-100)
law = Strategy(
    "filtered skyhook",
    lambda s, g: ca.if_else((s.body_velocity - s.slow) * s.suspension_velocity > 0, g.c_max, g.c_min),
    c_min=1e3, c_max=30e3, states={"slow": 0.0},
    update=lambda s, g: {"slow": s.slow + 1.26 * s.sample_time * (s.body_velocity - s.slow)},
)
for name, damper in {"passive": None, law.name: law}.items():
    print(name, bc.daf(bridge, truck, 80/3.6, road, start=-100, damper=damper))
