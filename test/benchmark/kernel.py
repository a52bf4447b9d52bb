"""
Measure the kernel: one vehicle on one core, many on all, and a program that starts.

Every effect is on; `kernel.cold` and `kernel.warm` are whole processes from their first import to
their first step, without the start of the interpreter and with an empty and a filled cache.
"""

import os
from pathlib import Path
import subprocess
import sys
import tempfile
import time

from bench import Figure
from lta_sim.batch import advance_many
from lta_sim.effects import initial_memory
from lta_sim.fleet import Fleet
from lta_sim.kernel import advance
from lta_sim.model import Model
from lta_sim.state import pack
import numpy as np

CALM = np.zeros(3)
DUTY = np.array([0.1, 0.1, 0.2, 0.2])
STEP = 2e-3


def vehicle(generator: np.random.Generator | None = None) -> Model:
    """Return a flat balloon of 1 m with every effect on; a generator scatters its numbers."""

    def about(value: float) -> float:
        return value * generator.uniform(0.95, 1.05) if generator else value

    thrust = {f'{letter}_{i}': 0.08 for letter in 'ab' for i in range(1, 5)}
    places = {'heave_1': 1.0, 'heave_2': 1.0, 'roll_1': 0.2, 'roll_2': -0.2, 'surge_3': 1.0}
    axes = ('surge', 'sway', 'heave', 'roll', 'pitch', 'yaw')
    given = {
        'weight_and_buoyancy': {'buoyancy': 3.49, 'weight': 3.51, 'cg_z': -0.08},
        'added_mass': dict(zip(axes, (0.146, 0.146, 0.374, 5e-3, 5e-3, 0.0), strict=True)),
        'linear_drag': dict(zip(axes, (0.01, 0.01, 0.01, 7e-4, 6e-4, 3e-4), strict=True)),
        'quadratic_drag': dict(zip(axes, (0.09, 0.09, 0.36, 2e-3, 2e-3, 6e-4), strict=True)),
        'motor_lag': {'up': 0.072, 'down': 0.1},
        'rotor_thrust': thrust | places | {'surge_4': 1.0, 'yaw_3': -0.1, 'yaw_4': 0.1},
        'floor_contact': {'stiffness': 100.0, 'relaxation': 0.05, 'friction': 0.5, 'z': -0.36},
    }
    return Model.build(
        {effect: {name: about(v) for name, v in of.items()} for effect, of in given.items()},
        mass=about(0.358),
        cg=(0.0, 0.0, about(-0.08)),
        inertia=np.diag([about(0.015), about(0.015), about(0.018)]),
    )


def scattered(count: int) -> tuple[list[Model], np.ndarray, np.ndarray, np.ndarray]:
    """Return different vehicles, their states, duties and winds."""
    generator = np.random.default_rng(1)
    models = [vehicle(generator) for _ in range(count)]
    states = np.array([pack((0.0, 0.0, 1.0), memory=initial_memory())] * count)
    states[:, :3] += generator.uniform(-0.5, 0.5, (count, 3))
    states[:, 7:13] = generator.uniform(-0.3, 0.3, (count, 6))
    duties, winds = generator.uniform(0.0, 0.4, (count, 4)), np.zeros((count, 3))
    winds[:, :2] = generator.uniform(-0.3, 0.3, (count, 2))
    return models, states, duties, winds


def single() -> float:
    """Return the pace of one vehicle, called in a loop inside. [1/s]"""
    return 1.0 / call(500_000)


def control_step() -> float:
    """Return the time of a call of 5 steps, 10 ms of flight. [us]"""
    return 1e6 * call(5, 20_000)


def call(steps: int, calls: int = 1) -> float:
    """Return the time of a step where there is one call, else that of a call. [s]"""
    model, start = vehicle(), pack((0.0, 0.0, 1.0), memory=initial_memory())
    begin = time.perf_counter()
    for _ in range(calls):
        advance(start, model, DUTY, CALM, STEP, steps)
    return (time.perf_counter() - begin) / (steps if calls == 1 else calls)


def batched(count: int = 10_000, steps: int = 1000) -> float:
    """Return the pace of many vehicles together, on all cores. [1/s]"""
    models, *arrays = scattered(1000)
    rows, few = np.arange(count) % len(models), Fleet.of(models)
    states, duties, winds = (array[rows] for array in arrays)
    fleet = Fleet(few.parameters[rows], few.body[rows], few.inverse[rows])
    begin = time.perf_counter()
    advance_many(states, fleet, duties, winds, STEP, steps)
    return count * steps / (time.perf_counter() - begin)


def first_step(cache: Path) -> float:
    """Return the time of a new process from import to its first step. [s]"""
    script = (
        'import time; begin = time.perf_counter()\n'
        'import kernel\n'
        'start = kernel.pack(memory=kernel.initial_memory())\n'
        'kernel.advance(start, kernel.vehicle(), kernel.DUTY, kernel.CALM, kernel.STEP, 1)\n'
        'import sys; sys.stdout.write(str(time.perf_counter() - begin))\n'
    )
    path = os.pathsep.join([str(Path(__file__).parent), *filter(None, sys.path)])
    environment = os.environ | {'PYTHONPATH': path, 'XDG_CACHE_HOME': str(cache)}
    command = [sys.executable, '-c', script]
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
    return [
        Figure('kernel.single', 'steps/s', single),
        Figure('kernel.batched', 'vehicle-steps/s', batched),
        Figure('kernel.control_step', 'us per 5 steps', control_step, choose=min),
        Figure('kernel.cold', 's', cold, rounds=1, choose=min),
        Figure('kernel.warm', 's', warm, rounds=1, choose=min),
    ]
