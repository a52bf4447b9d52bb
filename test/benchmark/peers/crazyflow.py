"""
crazyflow: many Crazyflies side by side on all cores, in single precision, steps of 2 ms.

Its physics from first principles: rotor speeds as states, thrust, linear drag; no hull, no added
mass, no wind. Once with Euler, its default integrator, and once with Runge-Kutta as LTA has. Its
fitted dynamics (`so_rpy`, the default) are slower than these on a CPU.

It runs in a process of its own: JAX has threads, and a process with threads should start no others
as the graph's benchmark does.
"""

from concurrent.futures import ProcessPoolExecutor
from contextlib import redirect_stdout
from functools import cache, partial
from importlib.metadata import version
import io
from multiprocessing import get_context
import time
from typing import Any
import warnings

from bench import Figure, pace

VEHICLES = 10_000
STEPS = 100
FREQUENCY = 500
ROTOR_SPEED = 20_000.0  # above hover, so that they fly and do not lie on the floor [1/min]


@cache
def simulation(integrator: str) -> Any:
    """Return the vehicles, their rotors commanded; made once, as each compiles for itself."""
    with redirect_stdout(io.StringIO()), warnings.catch_warnings():
        # It says which of its options it lacks, and builds its scene in a way that MuJoCo warns
        # of, into a file as well.
        warnings.simplefilter('ignore')
        from crazyflow.control import Control
        from crazyflow.sim import Sim
        from crazyflow.sim.sim import Dynamics
        import jax.numpy as jnp
        import mujoco

        mujoco.set_mju_user_warning(lambda text: None)
        sim = Sim(
            n_worlds=VEHICLES,
            dynamics=Dynamics.first_principles,
            integrator=integrator,
            control=Control.rotor_vel,
            freq=FREQUENCY,
            device='cpu',
        )
    sim.rotor_vel_control(jnp.full((VEHICLES, 1, 4), ROTOR_SPEED))
    return sim


def batched(integrator: str) -> float:
    """Return the pace of all vehicles together. [1/s]"""
    sim = simulation(integrator)
    begin = time.process_time()
    sim.step(STEPS)
    sim.data.states.pos.block_until_ready()
    return pace(VEHICLES * STEPS, begin)


@cache
def other_process() -> ProcessPoolExecutor:
    """Return the process, kept to the end: one let go of earlier may be in the way of exit."""
    return ProcessPoolExecutor(1, mp_context=get_context('spawn'))


def there(integrator: str) -> float:
    """Return the pace, measured in the other process. [1/s]"""
    return other_process().submit(batched, integrator).result()


def figures() -> list[Figure]:
    """Return what is measured here."""
    program = f'crazyflow {version("crazyflow")}'
    unit, of = 'vehicle-steps/s', 'kernel.batched'
    euler, rk4 = partial(there, 'euler'), partial(there, 'rk4')
    return [
        Figure('crazyflow.batched', unit, euler, of=of, peer=f'{program}, Euler, fp32'),
        Figure('crazyflow.batched_rk4', unit, rk4, of=of, peer=f'{program}, RK4, fp32'),
    ]
