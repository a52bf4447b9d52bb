# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
The load of one flight: what `lta simulate --seed 3` drew from its cell, every 0.1 s [W].

`python test/unit/energy/flight_load.py --write` stores it anew; the figures in docs/energy.md are
those of the load that is stored.
"""

from pathlib import Path
import sys

import numpy as np

STORED = Path(__file__).with_name('flight_load.csv')
PERIOD = 0.1  # s


def flown():
    """Return the power of a flight, rest and take-off included [W]."""
    from lta_flight.flight_spec import build_loop, load_spec

    loop = build_loop(load_spec('gtmab', 'lamp_room', 'bag', ''), 3)
    drawn = []
    for step, _ in enumerate(loop.iterate_steps()):
        voltage, current = loop.world.supply.cell_voltage_and_current
        if step % 10 == 5:
            drawn.append(-voltage * current)
    return np.array(drawn)


def stored():
    return np.loadtxt(STORED).tolist()


if __name__ == '__main__':
    if sys.argv[1:] != ['--write']:
        sys.exit('Give --write to store the load anew.')
    np.savetxt(STORED, flown(), '%.4f')
