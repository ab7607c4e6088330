"""A bridge of which two modes were measured at five places: deflections and their DAF."""

import bridgectl as bc

shapes = [[0, 0], [0.71, 1], [1, 0], [0.71, -1], [0, 0]]  # one row a place, one column a mode
modes = {"frequencies": [4.1, 15.8], "damping_ratio": [0.012, 0.02], "mass_per_length": 18358}
bridge = bc.ModalBridge([0, 6.25, 12.5, 18.75, 25], shapes, **modes)
truck, middle = bc.trucks.load("T5air"), bc.Deflection(12.5)
for kmh in (60, 80, 100):
    peak = bc.peak_effect(bridge, truck, kmh / 3.6, effect=middle)[0]
    daf = bc.daf(bridge, truck, kmh / 3.6, effect=middle)[0]
    print(f"{kmh} km/h: {1e3 * peak:.2f} mm, DAF {daf:.3f}")
