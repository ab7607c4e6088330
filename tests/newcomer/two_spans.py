"""A bridge of two spans: frequencies, and peaks of sagging, hogging and the pier's reaction."""

import bridgectl as bc

bridge, truck = bc.Bridge([25, 25], 18358, 4.865e10, damping_ratio=0.01), bc.trucks.load("T5air")
print("frequencies", bridge.frequencies[:3].round(2), "Hz")
effects = [bc.Moment(10.0), bc.Moment(25.0, sense="smallest"), bc.Reaction(25.0)]
peaks = bc.peak_effect(bridge, truck, 80 / 3.6, effect=effects)[:, 0] / 1e3
dafs = bc.daf(bridge, truck, 80 / 3.6, effect=effects)[:, 0]
for effect, peak, daf in zip(effects, peaks, dafs, strict=True):
    print(f"{effect.label} at {effect.at:g} m: {peak:.0f} k{effect.unit}, DAF {daf:.3f}")
