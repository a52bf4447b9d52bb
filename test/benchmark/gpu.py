"""
Measure the batched kernel on a GPU: `python test/benchmark/gpu.py` prints name, value and unit.

Needs requirements-gpu.txt. Every vehicle has its own numbers and every effect on. `gpu.batched` is
the rate in the kernel and `gpu.million_flights` a whole call of 60 s flights with all its copying.
`gpu.difference` is the largest deviation of any number of 1000 states from the CPU's after 60 s in
the air; `gpu.difference_floor` that of flights that may bounce, which makes small ones grow.
"""

import sys
import time

from kernel import scattered, STEP
from lta_config.errors import BadInput
from lta_sim import gpu
from lta_sim.fleet import Fleet
from lta_sim.kernel import advance
import numpy as np

STEPS = round(60.0 / STEP)
COMPARED = 1000


def many(count: int) -> tuple[np.ndarray, Fleet, np.ndarray, np.ndarray]:
    """Return that many flights, as copies of the first thousand."""
    models, states, duties, winds = scattered(COMPARED)
    rows = np.arange(count) % COMPARED
    few = Fleet.of(models)
    fleet = Fleet(few.parameters[rows], few.body[rows], few.inverse[rows])
    return states[rows], fleet, duties[rows], winds[rows]


def seconds(count: int, steps: int) -> float:
    """Return the shortest of three times of a call. [s]"""
    flights = many(count)
    times = []
    for _ in range(3):
        begin = time.perf_counter()
        gpu.advance_many(*flights, STEP, steps)
        times.append(time.perf_counter() - begin)
    return min(times)


def difference(height: float) -> float:
    """Return the largest deviation from the CPU after a flight that begins at a height."""
    models, states, duties, winds = scattered(COMPARED)
    states[:, 2] += height
    there = gpu.advance_many(states, Fleet.of(models), duties, winds, STEP, STEPS)
    here = [
        advance(state, model, duty, wind, STEP, STEPS)
        for state, model, duty, wind in zip(states, models, duties, winds, strict=True)
    ]
    return float(np.max(abs(there - np.array(here))))


def main() -> None:
    """Print the table."""
    begin = time.perf_counter()
    try:
        gpu.advance_many(*many(1), STEP, 1)
    except BadInput as refusal:
        sys.stderr.write(f'{refusal}\n')
        return
    first = time.perf_counter() - begin
    count = 1_000_000
    whole, empty = seconds(count, STEPS), seconds(count, 0)
    rows = (
        ('gpu.first_call', f'{first:.2f}', 's'),
        ('gpu.batched', f'{count * STEPS / (whole - empty):.4g}', 'vehicle-steps/s'),
        ('gpu.million_flights', f'{whole:.2f}', 's'),
        ('gpu.difference', f'{difference(100.0):.3g}', 'SI'),
        ('gpu.difference_floor', f'{difference(0.0):.3g}', 'SI'),
    )
    for name, value, unit in rows:
        sys.stdout.write(f'{name:<22} {value:>12} {unit}\n')


if __name__ == '__main__':
    main()
