"""A bridge of which two modes were measured, and a strain gauge calibrated with a slow truck."""

import bridgectl as bc

places = [0, 6.25, 12.5, 18.75, 25]
shapes = [[0, 0], [0.71, 1], [1, 0], [0.71, -1], [0, 0]]
bridge = bc.ModalBridge(
    places, shapes, frequencies=[4.1, 15.8], damping_ratio=[0.012, 0.02], mass_per_length=18358
)
truck = bc.trucks.load("T5air")
effect = bc.Deflection(12.5)
for speed in (60, 80, 100):
    peak = bc.peak_effect(bridge, truck, speed / 3.6, effect=effect)[0] * 1e3
    print(f"{speed} km/h: {peak:.2f} mm, DAF {bc.daf(bridge, truck, speed / 3.6, effect=effect)[0]:.3f}")
