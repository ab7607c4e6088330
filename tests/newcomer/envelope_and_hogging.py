"""The largest sagging and hogging moments of two spans under a truck, and where they are."""

import bridgectl as bc

bridge, truck = bc.Bridge([25, 25], 18358, 4.865e10, damping_ratio=0.01), bc.trucks.load("T5air")
found = bc.envelope(bridge, truck, 80 / 3.6)
sag, hog = found.largest.argmax(), found.smallest.argmin()
print(f"sagging: {found.largest[sag] / 1e3:.0f} kN m at {found.places[sag]:.2f} m")
print(f"hogging: {found.smallest[hog] / 1e3:.0f} kN m at {found.places[hog]:.2f} m")
daf = bc.daf(bridge, truck, 80 / 3.6, effect=bc.Moment(25.0, sense="smallest"))
print(f"DAF of hogging over the pier: {daf[0]:.3f}")
