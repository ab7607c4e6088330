"""The moment at 0.4 of the span, where curtailed bars end: peak and DAF over speed."""

import numpy as np

import bridgectl as bc

bridge, truck, speeds = bc.li2006.beam(), bc.li2006.car(), np.arange(60, 121, 20) / 3.6
place = bc.Moment(at=0.4 * bridge.length)
peaks = bc.peak_effect(bridge, truck, speeds, effect=place) / 1e3
for speed, peak, daf in zip(speeds, peaks, bc.daf(bridge, truck, speeds, effect=place), strict=True):
    print(f"{3.6 * speed:.0f} km/h: {peak:.1f} kN m, DAF {daf:.3f}")
