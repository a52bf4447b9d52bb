# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Define which parameters of the registry of effects are candidates, and which belong together.

A parameter that is not listed here is a candidate of its own, within its bounds, except for
companions of others (`Parameter.beside`).
"""

import math
from typing import Final

from lta_model.effects import EFFECTS
from lta_model.effects.protocol import EffectParameter
from lta_model.state import ACTUATORS

# Parameters that change together, as one candidate.
JOINT_PARAMETERS: Final[dict[str, tuple[str, ...]]] = {'motor_lag': ('up', 'down')}
# Components of a vector: selected and fitted together, each with its own value.
VECTORS: Final = (
    ('steady_wind.x', 'steady_wind.y'),
    # A horizontal wind that changes with the height
    ('wind_gradient.x_z', 'wind_gradient.y_z'),
    ('cg_offset.x', 'cg_offset.y'),
    ('tracker_misalignment.pitch', 'tracker_misalignment.roll'),
    *(
        (f'rotor_misalignment.first_{i}', f'rotor_misalignment.second_{i}')
        for i in range(1, ACTUATORS + 1)
    ),
)
# Initial values of absent effects, where they differ from the null value.
BEGINS: Final[dict[str, dict[str, float]]] = {'battery_sag': {'sensitivity': 0.0}}
# Effects that describe the design or the environment, not a defect of the vehicle file.
DESIGN: Final = frozenset(
    {
        'rotor_thrust', 'thrust_curve', 'thrust_polynomial', 'weight_and_buoyancy', 'walls',
        'floor_contact', 'hull_lift', 'strip_damping', 'moving_mass', 'gas_state', 'air_state',
        'turbulence', 'gusts', 'wind_profile', 'rotor_envelope_interaction', 'ceiling_effect',
        'battery_compensation', 'marker_offset', 'wrench_gain', 'oblique_lift',
    }
)  # fmt: skip
# Parameters of those that are uncertain if present, because they were fitted to flights.
FITTED: Final[dict[str, tuple[str, ...]]] = {
    'hull_lift': tuple(known.name for known in EFFECTS['hull_lift'].parameters[2:]),
    'moving_mass': ('mass', 'x', 'z'),
}
# Physical signs of coefficients: side force and lift act against the flow.
SIGNS: Final[dict[str, tuple[float, float]]] = {
    'hull_lift.side_beta': (-math.inf, 0.0),
    'hull_lift.lift_alpha': (0.0, math.inf),
    # A leak loses lift; a calibration also follows lift that grows
    'helium_leak.rate': (0.0, math.inf),
}
NO_CANDIDATE: Final = frozenset(
    {
        'cross_flow.surge', 'cross_flow.sway', 'cross_flow.heave',
        'ballast.x', 'ballast.y', 'ballast.z', 'payload.x', 'payload.y', 'payload.z',
        'wind_gradient.x', 'wind_gradient.y', 'wind_gradient.z',
    }
)  # fmt: skip
_VECTOR_OF: Final = {name: vector for vector in VECTORS for name in vector}
DIFF_STEP: Final = 1e-5  # of relative parameters
FINE: Final = 1e-4  # of the typical size of other parameters
# Larger steps for discontinuous effects, which small steps would miss.
LARGER_STEPS: Final[dict[str, float]] = {
    # Where motors begin to turn (`motor_deadband`); few commands are smaller than half of it. Of
    # simulated flights with 0.08, such a step tells 363 nats, one of 0.03 tells 2 nats
    'motor_deadband.threshold': 0.06,
    'command_delay.delay': 1e-3,
    'motor_lag': 1e-4,
    # Negative, towards a delay: held commands have another slope on the other side.
    'clock_offset.offset': -5e-6,
}
FINER: Final[dict[str, float]] = {**LARGER_STEPS, 'motor_deadband.threshold': 0.004}


def vector_components(name: str) -> tuple[str, ...]:
    """Return the components of a candidate's vector; most candidates have one component."""
    return _VECTOR_OF.get(name, (name,))


def companion_values(effect: str) -> dict[str, float]:
    """Return the assumed values of an absent effect's companion parameters, by name."""
    beside = {p.name: p.beside for p in EFFECTS[effect].parameters if p.beside is not None}
    return beside | BEGINS.get(effect, {})


def fine_step(name: str, parameter: EffectParameter) -> float:
    """Return the finite-difference step away from 0, in the unit of the parameter."""
    usual = (
        DIFF_STEP if parameter.unit == '1' and parameter.null == 1.0 else FINE * parameter.spread
    )
    return FINER.get(name, usual)


def first_step(name: str, parameter: EffectParameter) -> float:
    """Return the finite-difference step at 0, in the unit of the parameter."""
    return LARGER_STEPS.get(name, fine_step(name, parameter))
