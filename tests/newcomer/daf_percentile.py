"""The DAF that 95 % of class A roads stay below, at 60 to 120 km/h."""

import numpy as np

import bridgectl as bc
from bridgectl.road import iso8608_elevations

speeds = np.arange(60, 121, 20) / 3.6
surface = bc.ramp_surface(bc.li2006.beam(), bc.li2006.car(), speeds, approach=100)
roads_daf = surface.superposed_daf(iso8608_elevations(200, "A", 125, seed=1))
high = np.quantile(roads_daf, 0.95, axis=0)
for speed, smooth, mean, rare in zip(
    speeds, surface.daf_smooth, roads_daf.mean(axis=0), high, strict=True
):
    print(f"{3.6 * speed:.0f} km/h: smooth {smooth:.3f}, mean {mean:.3f}, 95 % below {rare:.3f}")
