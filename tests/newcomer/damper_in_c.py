"""Bridgehook at 80 km/h as C for a microcontroller, and how the controller calls it."""

import bridgectl as bc

hook = bc.dampers.bridgehook(bc.li2006.beam(), bc.li2006.car(), c_min=1e3, c_max=30e3)
law = hook.for_speed(80 / 3.6)
file = law.to_c("damping.c")
print(file.read_text(encoding="utf-8").partition("*/")[0])
for down in (0.15, -0.15):
    c = law.command(position=10.0, body_velocity=0.05, suspension_velocity=down)
    print(f"body {down:+.2f} m/s to the axle: {c:.0f} N s/m")
