"""A damper law with a filter: skyhook on a body velocity without what is slower than 0.2 Hz."""

import casadi as ca

import bridgectl as bc


def law(s, g):
    return ca.if_else((s.body_velocity - s.slow) * s.suspension_velocity > 0, g.c_max, g.c_min)


def update(s, g):
    return {"slow": s.slow + 1.26 * s.sample_time * (s.body_velocity - s.slow)}


filtered = bc.dampers.Strategy("filtered", law, 1e3, 30e3, states={"slow": 0.0}, update=update)
road = bc.iso8608_profile("B", 45, seed=1, start=-20)
for name, damper in {"passive": None, "filtered skyhook": filtered}.items():
    daf = bc.daf(bc.li2006.beam(), bc.li2006.car(), 80 / 3.6, road, start=-20, damper=damper)
    print(f"{name}: DAF {daf[0]:.3f} at 80 km/h")
