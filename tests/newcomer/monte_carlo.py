"""What random trucks do to a bridge in 75 years: characteristic moment and dynamic ratio."""

import bridgectl as bc

bridge = bc.Beam(25, 18358, 4.865e10, damping_ratio=0.01)
fleet = bc.Fleet.load("air_sprung", seed=1)
roads = [bc.iso8608_profile("A", 125, seed=k, start=-100) for k in range(5)]
traffic = bc.assess(bridge, fleet, roads, n=300, trucks_a_day=1500, workers=1)
level = traffic.characteristic(return_period=75)
ratio = traffic.adr(return_period=75)
print(f"{level.total.value / 1e3:.0f} kN m")
print(ratio)
