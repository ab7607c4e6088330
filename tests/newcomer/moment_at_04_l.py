"""The moment at 0.4 of the span, where bars may end: its peak and DAF at 60 to 120 km/h."""

import numpy as np

import bridgectl as bc

bridge, truck, speeds = bc.li2006.beam(), bc.li2006.car(), np.arange(60, 121, 20) / 3.6
moment = bc.Moment(at=0.4 * bridge.length)
peaks = bc.peak_effect(bridge, truck, speeds, effect=moment) / 1e3
dafs = bc.daf(bridge, truck, speeds, effect=moment)
for speed, peak, daf in zip(speeds, peaks, dafs, strict=True):
    print(f"{3.6 * speed:.0f} km/h: {peak:.1f} kN m, DAF {daf:.3f}")
