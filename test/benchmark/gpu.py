"""
Measure the batched kernel on a GPU.

Needs requirements-gpu.txt. Every vehicle is a GT-MAB with its own numbers. `gpu.batched` is the
rate in the kernel and `gpu.million_flights` a whole call of 60 s flights with all its copying.
`gpu.difference` is the largest deviation of any number of 1000 states from the CPU's after 60 s in
the air; `gpu.difference_floor` that of flights that may bounce, which makes small ones grow.
`gpu.closed` is the rate of closed loops, a million flights to the lamp, copying included; its
first sample also compiles.
"""

from collections.abc import Callable
import time

from bench import Figure
from fleet import realtime
from gtmab import scattered, STEP
from lta_sim.kernels import gpu
from lta_sim.kernels.cpu_batch import advance_many
from lta_sim.kernels.vehicle_batch import VehicleBatch
import numpy as np

STEPS = round(60.0 / STEP)
COMPARED = 1000
MANY = 1_000_000


def many(count: int) -> tuple[np.ndarray, VehicleBatch, np.ndarray, np.ndarray]:
    """Return that many flights, as copies of the first thousand."""
    states, fleet, duties, surroundings = scattered(COMPARED)
    rows = np.arange(count) % COMPARED
    return states[rows], fleet.select_vehicles(rows), duties[rows], surroundings[rows]


def seconds(count: int, steps: int) -> float:
    """Return the time of a call. [s]"""
    flights = many(count)
    begin = time.perf_counter()
    gpu.advance_many(*flights, STEP, steps)
    return time.perf_counter() - begin


def batched(count: int) -> float:
    """Return the rate in the kernel: what 60 s of flight take beyond the copying. [1/s]"""
    whole = min(seconds(count, STEPS) for _ in range(3))
    empty = min(seconds(count, 0) for _ in range(3))
    return count * STEPS / (whole - empty)


def difference(height: float) -> float:
    """Return the largest deviation from the CPU after a flight that begins at a height."""
    states, *others = scattered(COMPARED)
    risen = states.copy()
    risen[:, 2] += height
    there = gpu.advance_many(risen, *others, STEP, STEPS)
    return float(np.max(abs(there - advance_many(risen, *others, STEP, STEPS))))


def figures() -> list[Figure]:
    """
    Return what is measured here.

    Raise `BadInput` if there is no GPU that numba-cuda can use.
    """
    first = seconds(1, 1)

    def once(name: str, unit: str, measure: Callable[[], float]) -> Figure:
        return Figure(f'gpu.{name}', unit, measure, rounds=1)

    return [
        once('first_call', 's', lambda: first),
        once('batched', 'vehicle-steps/s', lambda: batched(MANY)),
        Figure('gpu.million_flights', 's', lambda: seconds(MANY, STEPS), 3, min),
        Figure('gpu.closed', 'vehicle s/s', lambda: realtime('gpu', MANY), 2),
        once('difference', 'SI', lambda: difference(100.0)),
        once('difference_floor', 'SI', lambda: difference(0.0)),
    ]
