"""RotorPy: one Crazyflie, its own aerodynamics and its own integrator, steps of 2 ms."""

from importlib.metadata import version
import time

from bench import Figure
import numpy as np
from rotorpy.vehicles.crazyflie_params import quad_params
from rotorpy.vehicles.multirotor import Multirotor

STEP = 2e-3
STEPS = 500


def steps_per_second() -> float:
    """Return the pace of one vehicle that hovers. [1/s]"""
    vehicle = Multirotor(quad_params)
    state = vehicle.initial_state
    command = {'cmd_motor_speeds': np.array(state['rotor_speeds'])}
    begin = time.process_time()
    for _ in range(STEPS):
        state = vehicle.step(state, command, STEP)
    return STEPS / (time.process_time() - begin)


def figures() -> list[Figure]:
    """Return what is measured here."""
    program = f'RotorPy {version("rotorpy")}, RK45'
    name = 'rotorpy.single'
    return [Figure(name, 'steps/s', steps_per_second, of='kernel.single', peer=program)]
