"""The shear force at the support in a crossing, in kN and over the static one."""

import bridgectl as bc

bridge, truck = bc.li2006.beam(n_modes=6, damping_ratio=0.01), bc.trucks.load("T5air")
road, shear = bc.iso8608_profile("A", 125, seed=1, start=-100), bc.Shear(0.0)
peak = bc.peak_effect(bridge, truck, 80 / 3.6, road, start=-100, effect=shear)[0]
daf = bc.daf(bridge, truck, 80 / 3.6, road, start=-100, effect=shear)[0]
print(f"{peak / 1e3:.1f} kN, DAF {daf:.3f}")
