"""What accelerometers on axle and body record on the way over a bridge, at 1 kHz."""

import numpy as np

import bridgectl as bc

bridge, truck, speed = bc.li2006.beam(damping_ratio=0.01), bc.li2006.car(), 20.0
road = bc.iso8608_profile("A", 75, seed=1, start=-50)
times = np.arange(-50 / speed, 25 / speed, 1e-3)
drive = bc.crossing_response(bridge, truck, speed, road, start=-50, timepts=times)
for name, label in {"axle": "y_t_ddot", "body": "y_s_ddot"}.items():
    signal = drive.outputs[label]
    strongest = np.fft.rfftfreq(len(times), 1e-3)[abs(np.fft.rfft(signal)).argmax()]
    print(f"{name}: {np.std(signal):.3f} m/s^2 rms, strongest at {strongest:.1f} Hz")
