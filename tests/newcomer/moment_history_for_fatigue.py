"""Cycles of bending moment in one crossing, by rainflow counting, and what they do in fatigue."""

import rainflow

import bridgectl as bc

bridge, truck = bc.li2006.beam(damping_ratio=0.01), bc.trucks.load("T5air")
road = bc.iso8608_profile("B", 125, seed=1, start=-100)
crossing = bc.crossing_response(
    bridge, truck, 80 / 3.6, road, start=-100, tail=5.0, effects={"M": bc.Moment()}
)
cycles = list(rainflow.extract_cycles(crossing.outputs["M"] / 1e3))
for size, _, count, _, _ in sorted(cycles, reverse=True)[:4]:
    print(f"{size:6.1f} kN m, counted {count:g}")
alike = sum(count * size**5 for size, _, count, _, _ in cycles) ** (1 / 5)
print(f"as bad as one of {alike:.1f} kN m, where fatigue goes with the fifth power")
