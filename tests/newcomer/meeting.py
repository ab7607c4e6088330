"""Two trucks that meet at mid-span, and the moment against one alone."""

import bridgectl as bc

bridge, truck = bc.li2006.beam(damping_ratio=0.01), bc.trucks.load("T5air")
both = bc.convoy([truck, truck], [0, 0], opposite=[False, True], lane_factors=[1, 0.6])
alone = bc.peak_effect(bridge, truck, 80 / 3.6)[0] / 1e3
for apart in (0, 10, 20):
    both = bc.convoy([truck, truck], [0, apart], opposite=[False, True], lane_factors=[1, 0.6])
    moment = bc.peak_effect(bridge, both, 80 / 3.6)[0] / 1e3
    print(f"{apart} m: {moment:.0f} kN m, {moment / alone:.2f} of one alone")
