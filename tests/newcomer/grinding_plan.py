"""Which 3 m of a road to grind, so that trucks of 60 to 100 km/h hit the bridge less."""

import numpy as np

import bridgectl as bc

road = bc.utia_road().place_bridge(678).crop(-50, 25).detrend()
speeds = np.arange(60, 101, 5) / 3.6
surface = bc.ramp_surface(bc.li2006.beam(), bc.li2006.car(), speeds, approach=50)
height = road.elevation_at(surface.stations)
plans = np.tile(height, (len(height) - 30, 1))  # one for each start of 3 m
for i, plan in enumerate(plans):
    plan[i : i + 31] = np.minimum(plan[i : i + 31], np.linspace(plan[i], plan[i + 30], 31))
best = surface.dae(plans).max(axis=1).argmin()
print(f"grind from {surface.stations[best]:.1f} to {surface.stations[best + 30]:.1f} m")
for name, each in {"DAE": surface.dae, "DAF": surface.superposed_daf}.items():
    print(f"{name} at most {each(height).max():.3f} before, {each(plans[best]).max():.3f} after")
