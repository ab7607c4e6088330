"""A damper law with a filter: skyhook on a body velocity without what is slower than 0.2 Hz."""

import casadi as ca

import bridgectl as bc


def law(s, g):
    """Stiff where the damper slows the body's fast motion."""
    return ca.if_else((s.body_velocity - s.slow) * s.suspension_velocity > 0, g.c_max, g.c_min)


def update(s, g):
    """The slow motion at the next sample."""
    return {"slow": s.slow + 1.26 * s.sample_time * (s.body_velocity - s.slow)}


filtered = bc.dampers.Strategy("filtered", law, 1e3, 30e3, states={"slow": 0.0}, update=update)
case = bc.li2006.beam(), bc.li2006.car(), 80 / 3.6, bc.iso8608_profile("B", 45, seed=1, start=-20)
passive, reached = (bc.daf(*case, start=-20, damper=each)[0] for each in (None, filtered))
print(f"DAF {reached:.3f} with the filtered skyhook, {passive:.3f} passive")
