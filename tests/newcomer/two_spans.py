"""A bridge of two spans: frequencies, and DAF of sagging, hogging and the pier's reaction."""

import bridgectl as bc

bridge = bc.Bridge([25, 25], mass_per_length=18358, flexural_rigidity=4.865e10, damping_ratio=0.01)
print("frequencies", bridge.frequencies[:3].round(2), "Hz")
effects = {
    "sagging": bc.Moment(10.0),
    "hogging": bc.Moment(25.0, sense="smallest"),
    "pier": bc.Reaction(25.0),
}
peaks = bc.peak_effect(bridge, bc.trucks.load("T5air"), 80 / 3.6, effect=effects)
dafs = bc.daf(bridge, bc.trucks.load("T5air"), 80 / 3.6, effect=list(effects.values()))
for name, peak, daf in zip(effects, peaks[:, 0], dafs[:, 0], strict=True):
    print(f"{name}: {peak / 1e3:.0f} kN m, DAF {daf:.3f}")
