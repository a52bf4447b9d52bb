# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Random vehicles with every effect of the model on, and random states in which each effect works.

Numbers to test with and no claim: a vehicle of eight rotors in a small windy room, low and large
enough that floor, walls, ceiling and their rotors' wakes are met.
"""

from lta_model.effects import EFFECTS
from lta_model.effects.protocol import BodyEffect, InertiaEffect, KernelEffect
from lta_model.model import VehicleModel
from lta_model.state import ACTUATORS
from lta_sim.simulated_vehicle import SIM_LAYOUT
import numpy as np

AXES = ('surge', 'sway', 'heave', 'roll', 'pitch', 'yaw')
KINDS = (KernelEffect, InertiaEffect, BodyEffect)
MASS, DISPLACED = 0.36, 0.35

# Values that must stay as they are for the effect to be itself, or to be met in the room.
FIXED = {
    'wind_profile': {'x': 2.0, 'y': -1.0, 'height': 10.0, 'roughness': 0.03, 'half_height': 0.3},
    'turbulence': {'along': 0.3, 'across': 0.2, 'up': 0.1}
    | {'along_length': 1.0, 'across_length': 0.8, 'up_length': 0.5, 'mean': 3.0, 'height': 3.0},
    'gusts': {'x': 0.5, 'y': 0.2, 'z': -0.1, 'begin': 0.2, 'length': 0.3, 'hold': 0.1},
    'gas_state': {'gas': 0.08, 'temperature': 4.0, 'overpressure': 200.0},
    'gas_rotation': {'share': 0.3, 'roll': 4e-3, 'pitch': 5e-3, 'yaw': 8e-3},
    'weight_and_buoyancy': {'gravity': 9.8},
    'superheat': {'warming': 0.017, 'lag': 70.0, 'slack': 0.7},
    'moving_mass': {'mass': 0.05, 'x': 0.07, 'y': 0.01, 'z': -0.24, 'lag': 0.3, 'speed': 0.4},
    'added_mass': {'surge': 0.14, 'sway': 0.15, 'heave': 0.37},
    'added_inertia': {'roll': 4e-3, 'pitch': 5e-3, 'yaw': 1e-3},
    'battery_compensation': {'voltage': 4.0, 'full': 0.12, 'least': 0.0128}
    | {'c_0': -0.0248, 'c_1': 0.0652, 'c_2': -0.0268, 'c_3': 0.00678},
    'battery_sag': {'voltage': 4.0, 'sensitivity': 0.8},
    'motor_deadband': {'threshold': 0.15},
    'motor_lag': {'up': 0.07, 'down': 0.1},
    'thrust_polynomial': {'voltage': 4.2, 'linear_to': 0.8}
    | {'c_0': -0.025, 'c_1': 0.065, 'c_2': -0.027, 'c_3': 0.0068},
    'hull_lift': {'density': 1.2, 'area': 0.25},
    'ground_effect': {'gain': 1.0, 'radius': 0.1},
    'ceiling_effect': {'gain': 1.0, 'radius': 0.1, 'height': 1.5},
    'walls': {'x_low': -0.8, 'x_high': 0.9, 'y_low': -0.7, 'y_high': 1.0, 'ceiling': 1.5}
    | {'radius': 0.5, 'half_height': 0.3}
    | {'stiffness': 80.0, 'relaxation': 0.05, 'friction': 0.3},
    'floor_contact': {'stiffness': 60.0, 'relaxation': 0.05, 'friction': 0.5}
    | {'x': 0.04, 'y': -0.03, 'z': -0.36},
}
# Parameters that mean another law at zero, and are so in some of the vehicles.
ABSENT = {
    'wind_profile': [('half_height',)],
    'superheat': [('lag',)],
    'moving_mass': [('speed',), ('lag', 'speed')],
    'thrust_polynomial': [('linear_to',)],
    'gusts': [('hold',)],
}
SHARES = (1.0, 1.0, -1.0, 0.5, 0.0, 0.0, 0.0, 0.0)


def parameters(effect, generator):
    """Return values of all parameters of an effect, none of them at null if that can be."""
    given = {}
    for known in effect.parameters:
        fixed = FIXED.get(effect.name, {}).get(known.name)
        sign = (-1, 1)[generator.integers(2)]
        value = known.null + known.spread * sign * generator.uniform(0.5, 1.5)
        if fixed is not None:
            value = fixed * generator.uniform(0.95, 1.05)
        elif not known.low <= value <= known.high:
            value = known.null + known.spread * generator.uniform(0.5, 1.5)
        given[known.name] = float(min(max(value, known.low), known.high))
    for group in ABSENT.get(effect.name, ()):
        if generator.random() < 0.2:
            given |= dict.fromkeys(group, 0.0)
    if effect.name == 'rotor_envelope_interaction':
        given |= {f'share_{i + 1}': share for i, share in enumerate(SHARES)}
    return given


def everything(generator, names=None):
    """Return the parameters of these effects, or of all that shape a flight."""
    return {
        name: parameters(effect, generator)
        for name, effect in EFFECTS.items()
        if isinstance(effect, KINDS) and (names is None or name in names)
    }


def body(generator):
    """Return what the effects are added to: no axis is a principal one, no two rotors alike."""
    cg = generator.normal(0.0, 0.03, 3) - (0.0, 0.0, 0.08)
    inertia = np.array([[0.02, 1e-3, -2e-3], [1e-3, 0.021, 5e-4], [-2e-3, 5e-4, 0.025]])
    axes = generator.normal(size=(ACTUATORS, 3))
    axes[:4, 2] = abs(axes[:4, 2]) + 1.0
    axes /= np.linalg.norm(axes, axis=1)[:, None]
    places = generator.normal(0.0, 0.2, (ACTUATORS, 3)) - (0.0, 0.0, 0.2)
    return {
        'mass': MASS,
        'cg': cg,
        'inertia': inertia,
        'displaced': DISPLACED,
        'rotors': list(zip(places, axes, strict=True)),
    }


def vehicle(generator, names=None):
    """Return the parameters, the body and the model of a random vehicle."""
    given, own = everything(generator, names), body(generator)
    return given, own, VehicleModel.build(given, **own)


def anywhere(generator):
    """Return a random state in the room and beyond its faces, a command and surroundings."""
    state = np.zeros(SIM_LAYOUT.size)
    state[:3] = generator.uniform((-0.5, -0.4, -0.2), (0.6, 0.7, 1.4))
    tilt = 0.2 if generator.random() < 0.7 else 1.0
    state[3:7] = (*generator.normal(0.0, tilt, 2), *generator.normal(size=2))
    state[3:7] /= np.linalg.norm(state[3:7])
    state[7:13] = generator.normal(size=6)
    state[13:] = generator.uniform(-1.0, 1.0, state.size - 13)
    # The clock of the gust is in it, and more often than not within the gust.
    state[SIM_LAYOUT.remembers['gusts']] += 0.6
    command = np.r_[generator.uniform(-1.0, 1.0, 8), generator.normal(0.0, 0.05, 3)]
    voltage = generator.uniform(3.3, 4.2) * (generator.random() > 0.1)
    wind, noise, change = generator.normal(0.0, [[0.5], [10.0], [0.3]], (3, 3))
    return state, command, np.r_[wind, noise, 400.0, voltage, change]


def memory_places():
    """Return where in the state the memory of each effect is."""
    return {
        name: slice(first, first + SIM_LAYOUT.memory_size(name))
        for name, first in SIM_LAYOUT.remembers.items()
    }
