"""Print the time that work takes over the time that is told before it begins: about 1.

Run ``python tests/benchmarks/estimates.py`` from the top of the repository. The estimates decide
what is refused as hopeless, and are of one core of some years ago: a factor of a few is no matter.
"""

from __future__ import annotations

from timing import timed  # isort: skip  # before numpy, for it limits the threads

from unittest.mock import patch

import numpy as np

import bridgectl as bc
from bridgectl import _work
from bridgectl.dampers import simulate_loop, skyhook


def main():
    """Print a row for each piece of work."""
    beam, dense, truck = bc.li2006.beam(), bc.li2006.beam(n_modes=12), bc.li2006.car()
    few, many = (np.linspace(50, 150, n) / 3.6 for n in (21, 201))
    road = bc.iso8608_profile("A", 225, seed=0, start=-200)
    x = np.linspace(0, 25, 251)
    work = {
        "daf, 201 speeds, 200 m of approach": lambda: bc.daf(beam, truck, many, road, start=-200),
        "daf, 12 modes, 21 speeds": lambda: bc.daf(dense, truck, few, road, start=-200),
        "surface, 201 speeds": lambda: bc.ramp_surface(beam, truck, many),
        "surface, 12 modes, 21 speeds": lambda: bc.ramp_surface(dense, truck, few),
        "skyhook, 21 speeds x 50 roads": lambda: simulate_loop(
            beam, truck, skyhook(1e3, 30e3), few, x, np.zeros((50, 251))
        ),
    }
    for name, call in work.items():
        with patch.object(_work, "_evaluate", wraps=_work._evaluate) as told:
            took = timed(call, 1)
            seconds = _work._evaluate(*told.call_args_list[0].args).seconds
        print(f"{name:36} {took:6.2f} s, {took / seconds:5.2f} times the estimate")


if __name__ == "__main__":
    main()
