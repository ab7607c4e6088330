"""Two trucks that meet on the bridge, each in its lane: how much more than one alone."""

import bridgectl as bc

bridge, truck = bc.li2006.beam(damping_ratio=0.01), bc.trucks.load("T5air")
alone = bc.peak_effect(bridge, truck, 80 / 3.6)[0]
for late in (0, 10, 20):
    both = bc.convoy([truck, truck], [0, late], opposite=[False, True], lane_factors=[1, 0.6])
    moment = bc.peak_effect(bridge, both, 80 / 3.6)[0]
    print(f"the other {late} m late: {moment / 1e3:.0f} kN m, {moment / alone:.2f} of one alone")
