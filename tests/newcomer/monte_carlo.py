"""What random trucks do to a bridge: the moment that returns in 75 years, and its dynamic share."""

import bridgectl as bc

bridge = bc.Beam(25, 18358, 4.865e10, damping_ratio=0.01)
fleet = bc.Fleet.load("air_sprung", seed=1)
roads = [bc.iso8608_profile("A", 125, seed=k, start=-100) for k in range(5)]
traffic = bc.assess(bridge, fleet, roads, n=300, trucks_a_day=1500, workers=1)
median, rare = traffic.quantiles("daf", [0.5, 0.95])
print(f"DAF: half of the trucks below {median.value:.3f}, 95 % below {rare.value:.3f}")
level, ratio = traffic.characteristic(return_period=75), traffic.adr(return_period=75)
print(f"once in 75 years {level.total.value / 1e3:.0f} kN m, {ratio.value:.2f} of the static one")
print(f"(95 % between {level.total.low / 1e3:.0f} and {level.total.high / 1e3:.0f} kN m)")
