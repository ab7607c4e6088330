"""The shear force at the support in a crossing, and what of it is dynamic."""

import bridgectl as bc

bridge, truck = bc.li2006.beam(n_modes=10), bc.trucks.load("T5air")
shear = bc.Shear(0.0)
road = bc.iso8608_profile("A", 125, seed=1, start=-100)
peak = bc.peak_effect(bridge, truck, 80 / 3.6, road, start=-100, effect=shear)
daf = bc.daf(bridge, truck, 80 / 3.6, road, start=-100, effect=shear)
print(f"{peak[0] / 1e3:.1f} kN, DAF {daf[0]:.3f}")
