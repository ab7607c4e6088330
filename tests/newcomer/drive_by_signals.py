"""What an accelerometer on the axle records on its way over a bridge, at 1 kHz."""

import numpy as np

import bridgectl as bc

bridge, truck, speed = bc.li2006.beam(damping_ratio=0.01), bc.li2006.car(), 20.0
road = bc.iso8608_profile("A", 75, seed=1, start=-50)
times = np.arange(-50 / speed, 25 / speed, 1e-3)
drive = bc.crossing_response(bridge, truck, speed, road, start=-50, timepts=times)
axle, body = drive.outputs["y_t_ddot"], drive.outputs["y_s_ddot"]
print(f"{len(times)} samples, {1 / np.diff(drive.time).mean():.0f} Hz")
for name, signal in {"axle": axle, "body": body}.items():
    print(f"{name}: {np.std(signal):.3f} m/s^2 rms, {abs(signal).max():.2f} m/s^2 at most")
on_bridge = abs(np.fft.rfft(axle[times >= 0] * np.hanning(sum(times >= 0))))
