"""
Measure the kernel: one vehicle on one core, many on all, and a program that starts.

With GT-MAB's realistic set on and every other effect one number away, and with every effect on
(`_all`). Rates are by processor time, here and in the peers, so that other work on the machine
does not spoil the ratios. `kernel.cold` and `kernel.warm` are whole processes from their first
import to their first step, without the start of the interpreter and with an empty and a filled
cache.
"""

from functools import partial
import os
from pathlib import Path
import subprocess
import sys
import tempfile
import time

from bench import Figure, pace
from gtmab import DUTY, scattered, start, STEP, SURROUNDED, vehicle
from lta_sim.kernels.cpu_batch import advance_many
from lta_sim.kernels.kernel import advance
import numpy as np

FIRST = """
import time; begin = time.perf_counter()
import numpy as np
from lta_model.effects import initial_memory
from lta_sim.kernels.kernel import advance
from lta_model.model import VehicleModel
from lta_model.state import pack_state
weight = {'weight_and_buoyancy': {'gravity': 9.81}}
model = VehicleModel.build(weight, mass=0.358, cg=np.zeros(3), inertia=np.eye(3))
advance(pack_state(memory=initial_memory()), model, (0.1,), (0.1,), 2e-3, 1)
import sys; sys.stdout.write(str(time.perf_counter() - begin))
"""


def call(every: bool, steps: int, calls: int = 1) -> float:
    """Return the time of a call. [s]"""
    model, state = vehicle(every), start()
    begin = time.process_time()
    for _ in range(calls):
        last = advance(state, model, DUTY, SURROUNDED, STEP, steps)
    taken = (time.process_time() - begin) / calls
    if not np.isfinite(last).all():
        raise FloatingPointError('the vehicle left the numbers: what is measured is no flight')
    return taken


def single(every: bool, steps: int = 300_000) -> float:
    """Return the pace of one vehicle, called in a loop inside. [1/s]"""
    return steps / call(every, steps)


def composed(steps: int = 300_000) -> float:
    """Return the pace of one vehicle by a kernel of its effects only. [1/s]"""
    states, fleet, duties, surroundings = scattered(1)
    begin = time.process_time()
    last = advance_many(states, fleet, duties, surroundings, STEP, steps)
    reached = steps / (time.process_time() - begin)
    if not np.isfinite(last).all():
        raise FloatingPointError('the vehicle left the numbers: what is measured is no flight')
    return reached


def control_step() -> float:
    """Return the time of a call of 5 steps, 10 ms of flight. [us]"""
    return 1e6 * call(False, 5, 10_000)


def batched(every: bool, count: int = 10_000, steps: int = 500) -> float:
    """Return the pace of many vehicles together, on all cores. [1/s]"""
    states, fleet, duties, surroundings = scattered(count, every)
    begin = time.process_time()
    last = advance_many(states, fleet, duties, surroundings, STEP, steps)
    reached = pace(count * steps, begin)
    if not np.isfinite(last).all():
        raise FloatingPointError('vehicles left the numbers: what is measured is no flight')
    return reached


def first_step(cache: Path) -> float:
    """Return the time of a new process from import to its first step. [s]"""
    path = os.pathsep.join(filter(None, sys.path))
    environment = os.environ | {'PYTHONPATH': path, 'XDG_CACHE_HOME': str(cache)}
    command = [sys.executable, '-c', FIRST]
    return float(subprocess.check_output(command, env=environment, text=True))


def cold() -> float:
    """Return the time of the first step of all. [s]"""
    with tempfile.TemporaryDirectory() as folder:
        return first_step(Path(folder))


def warm() -> float:
    """Return the time of the first step where the kernel is in the cache. [s]"""
    with tempfile.TemporaryDirectory() as folder:
        first_step(Path(folder))
        return min(first_step(Path(folder)) for _ in range(3))


def figures() -> list[Figure]:
    """Return what is measured here."""
    one, many = 'steps/s', 'vehicle-steps/s'
    return [
        Figure('kernel.single', one, partial(single, False)),
        Figure('kernel.single_composed', one, composed),
        Figure('kernel.single_all', one, partial(single, True)),
        Figure('kernel.batched', many, partial(batched, False)),
        Figure('kernel.batched_all', many, partial(batched, True)),
        Figure('kernel.control_step', 'us per 5 steps', control_step, choose=min),
        Figure('kernel.cold', 's', cold, rounds=1, choose=min),
        Figure('kernel.warm', 's', warm, rounds=1, choose=min),
    ]
