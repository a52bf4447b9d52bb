"""Measure the kernel: one vehicle on one core. The vehicle is GT-MAB."""

from functools import cache
import os
from pathlib import Path
import subprocess
import sys
import tempfile
import time

from lta_model.effects import initial_memory
from lta_model.model import VehicleModel
from lta_model.state import pack_state
from lta_model.vehicle import load_vehicle
from lta_sim.kernels.kernel import advance
import numpy as np

from campaigns.bench import Figure

STEP = 2e-3
DUTY = np.array([0.145, 0.145, 0.2, 0.2])  # forward, and slowly up
# Wind, noise, sunlight and a cell that is not full
SURROUNDED = np.array([0.1, 0.05, 0.0, 0.3, -0.2, 0.1, 300.0, 3.8, 0.02, 0.01, 0.0])
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


@cache
def build_vehicle() -> VehicleModel:
    """Return the model of GT-MAB."""
    return load_vehicle('gtmab').build_model()


def build_start() -> np.ndarray:
    """Return the state of the vehicle at rest in the air."""
    return pack_state((0.0, 0.0, 1.0), memory=initial_memory())


def check_flight(states: np.ndarray) -> None:
    """Raise `FloatingPointError` where what was measured is no flight."""
    if not np.isfinite(states).all():
        raise FloatingPointError('the vehicle left the numbers')


def measure_single(steps: int = 300_000) -> float:
    """Return the pace of one vehicle. [steps/s]"""
    model, state = build_vehicle(), build_start()
    begin = time.process_time()
    last = advance(state, model, DUTY, SURROUNDED, STEP, steps)
    taken = time.process_time() - begin
    check_flight(last)
    return steps / taken


def measure_first_step() -> float:
    """Return the time of a new process from import to its first step, with no cache. [s]"""
    path = os.pathsep.join(filter(None, sys.path))
    with tempfile.TemporaryDirectory() as cache_folder:
        environment = os.environ | {'PYTHONPATH': path, 'XDG_CACHE_HOME': str(Path(cache_folder))}
        command = [sys.executable, '-c', FIRST]
        return float(subprocess.check_output(command, env=environment, text=True))


def list_kernel() -> list[Figure]:
    """Return the figures of the kernel."""
    return [
        Figure('kernel.single', 'steps/s', measure_single,
               "one vehicle on one core, RK4 in double precision, with GT-MAB's effects on"),
        Figure('kernel.cold', 's', measure_first_step,
               'from the first import to the first step with an empty cache', min),
    ]  # fmt: skip
