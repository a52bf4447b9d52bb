"""
crazyflow: many Crazyflies side by side on all cores, in single precision, steps of 2 ms.

Its physics from first principles: rotor speeds as states, thrust, linear drag; no hull, no added
mass, no wind. Once with Euler, its default integrator, and once with Runge-Kutta as LTA has. Its
fitted dynamics (`so_rpy`, the default) are slower than these on a CPU, having an attitude
controller's angles to go through.
"""

from collections.abc import Callable
from contextlib import redirect_stdout
from importlib.metadata import version
import io
import time
import warnings

from bench import Figure
import jax
import jax.numpy as jnp
import mujoco

with redirect_stdout(io.StringIO()):  # says what else it could import
    from crazyflow.control import Control
    from crazyflow.sim import Sim
    from crazyflow.sim.integration import Integrator
    from crazyflow.sim.sim import Dynamics

VEHICLES = 10_000
STEPS = 100
FREQUENCY = 500
ROTOR_SPEED = 20_000.0  # above hover, so that they fly and do not lie on the floor [1/min]


def simulation(integrator: Integrator) -> Sim:
    """Return the vehicles, their rotors commanded."""
    # It builds its scene in a way of which MuJoCo warns, into a file as well.
    mujoco.set_mju_user_warning(lambda text: None)
    with warnings.catch_warnings():
        warnings.simplefilter('ignore')
        sim = Sim(
            n_worlds=VEHICLES,
            dynamics=Dynamics.first_principles,
            integrator=integrator,
            control=Control.rotor_vel,
            freq=FREQUENCY,
            device='cpu',
        )
    mujoco.set_mju_user_warning(None)
    sim.rotor_vel_control(jnp.full((VEHICLES, 1, 4), ROTOR_SPEED))
    return sim


def pace(integrator: Integrator) -> Callable[[], float]:
    """Return how to measure the pace of all vehicles together. [1/s]"""
    made: list[Sim] = []  # once: it compiles for itself alone

    def measure() -> float:
        if not made:
            made.append(simulation(integrator))
        (sim,) = made
        begin = time.perf_counter()
        sim.step(STEPS)
        jax.block_until_ready(sim.data.states.pos)
        return VEHICLES * STEPS / (time.perf_counter() - begin)

    return measure


def figures() -> list[Figure]:
    """Return what is measured here."""
    program = f'crazyflow {version("crazyflow")}'
    unit, of = 'vehicle-steps/s', 'kernel.batched'
    euler, rk4 = pace(Integrator.euler), pace(Integrator.rk4)
    return [
        Figure('crazyflow.batched', unit, euler, of=of, peer=f'{program}, Euler, fp32'),
        Figure('crazyflow.batched_rk4', unit, rk4, of=of, peer=f'{program}, RK4, fp32'),
    ]
