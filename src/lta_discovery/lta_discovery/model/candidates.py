"""
Define which parameters of the registry of effects are candidates, and which belong together.

A parameter that is not listed here is a candidate of its own, within its bounds, except for
companions of others (`Parameter.beside`).
"""

import math
from typing import Final

from lta_model.effects import EFFECTS
from lta_model.state import ACTUATORS

# Parameters that change together, as one candidate.
TOGETHER: Final[dict[str, tuple[str, ...]]] = {'motor_lag': ('up', 'down')}
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


def vector_components(name: str) -> tuple[str, ...]:
    """Return the components of a candidate's vector; most candidates have one component."""
    return _VECTOR_OF.get(name, (name,))


def companion_values(effect: str) -> dict[str, float]:
    """Return the assumed values of an absent effect's companion parameters, by name."""
    beside = {p.name: p.beside for p in EFFECTS[effect].parameters if p.beside is not None}
    return beside | BEGINS.get(effect, {})
