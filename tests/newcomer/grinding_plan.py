"""Which 3 m of a road to grind, so that the bridge is hit less at 60 to 100 km/h."""

import numpy as np

import bridgectl as bc

bridge, truck = bc.li2006.beam(), bc.li2006.car()
road = bc.utia_road().place_bridge(678).crop(-50, 25).detrend().resample(0.1)
surface = bc.ramp_surface(bridge, truck, np.arange(60, 101, 5) / 3.6, approach=50)
height = road.elevation_at(surface.stations)
plans = np.tile(height, (len(height) - 30, 1))
for i, plan in enumerate(plans):
    plan[i : i + 31] = np.minimum(plan[i : i + 31], np.linspace(plan[i], plan[i + 30], 31))
best = surface.dae(plans).max(axis=1).argmin()
for name, each in {"as it is": height, f"ground at {surface.stations[best]:.1f} m": plans[best]}.items():
    print(f"{name}: DAE {surface.dae(each).max():.3f}, DAF {surface.superposed_daf(each).max():.3f}")
