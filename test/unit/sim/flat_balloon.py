# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""A flat foil balloon of 1 m with four rotors, to test the model on: numbers, not a claim."""

from lta_model.effects import initial_memory
from lta_model.model import VehicleModel
from lta_model.state import pack_state
from lta_sim.simulated_vehicle import SIM_LAYOUT
import numpy as np

G = 9.80665
MASS = 0.358
CG = (0.0, 0.0, -0.08)
INERTIA = np.diag([0.015, 0.015, 0.018])
HEIGHT = 0.36

# Columns V1 V2 H1 H2 of the thrust allocation, per newton, about the hull centre.
B = np.array(
    [
        [0.000, 0.000, 0.981, 0.981],
        [0.013, -0.013, 0.011, -0.011],
        [0.961, 0.961, -0.061, -0.061],
        [0.188, -0.188, -0.002, 0.002],
        [0.000, 0.000, -0.403, -0.403],
        [0.000, 0.000, -0.100, 0.100],
    ]
)
AXES = ('surge', 'sway', 'heave', 'roll', 'pitch', 'yaw')

DISPLACED = MASS - 0.002
WEIGHT = {'gravity': G}
NEUTRAL = {'weight_and_buoyancy': WEIGHT}  # with `displaced=MASS`
ADDED = {
    'added_mass': {'surge': 0.146, 'sway': 0.146, 'heave': 0.374},
    'added_inertia': {'roll': 4.7e-3, 'pitch': 4.7e-3},
}
CURVE = {f'{letter}_{i}': x for letter, x in (('a', 0.0915), ('b', 0.0677)) for i in range(1, 5)}
ROTORS = {
    **{f'{axis}_{i + 1}': B[k, i] for k, axis in enumerate(AXES) for i in range(4)},
}
EVERYTHING = {
    'weight_and_buoyancy': WEIGHT,
    **ADDED,
    'linear_drag': {'surge': 1e-3, 'sway': 1e-3, 'heave': 1e-3},
    'quadratic_drag': {'surge': 0.092, 'sway': 0.092, 'heave': 0.359},
    'rotational_drag': {
        'roll': 7e-4,
        'pitch': 6.2e-4,
        'yaw': 3.2e-4,
        'roll_2': 2.14e-3,
        'pitch_2': 2.14e-3,
        'yaw_2': 6.4e-4,
    },
    'motor_lag': {'up': 0.072, 'down': 0.1},
    'thrust_curve': CURVE,
    'rotor_thrust': ROTORS,
    'floor_contact': {'stiffness': 100.0, 'relaxation': 0.05, 'friction': 0.5, 'z': -HEIGHT},
}


LAG = slice(SIM_LAYOUT.remembers['motor_lag'], SIM_LAYOUT.remembers['motor_lag'] + 4)


def model(given, cg=CG, inertia=INERTIA, displaced=DISPLACED):
    """Return the balloon with the effects of `given`."""
    return VehicleModel.build(given, mass=MASS, cg=cg, inertia=inertia, displaced=displaced)


def at(position=(0.0, 0.0, 2.0), **motion):
    """Return a state with the motors off."""
    return pack_state(position, memory=initial_memory(), **motion)


def anywhere(generator, height=(-0.3, 0.3)):
    """Return a random state, its foot above or under the floor, and a random command and wind."""
    state = at()
    state[:2] = generator.normal(size=2)
    state[2] = generator.uniform(*height)
    state[3:7] = generator.normal(size=4)
    state[3:7] /= np.linalg.norm(state[3:7])
    state[7:13] = generator.normal(size=6)
    state[13:] = generator.uniform(-1.0, 1.0, size=state.size - 13)
    return state, generator.uniform(-1.0, 1.0, size=4), generator.normal(size=3)
