"""
Show what a simulator makes of the air that a hull has to push away.

`kernel.heave` is the acceleration with which a neutrally buoyant foil balloon of 1 m starts from
rest under a small upward force: F / (m + m_added) by Lamb's potential flow. A simulator without
the inertia of the air says F / m, nearly twice as much.
"""

from bench import Figure
from lta_model.effects import initial_memory
from lta_model.mass_properties import spheroid_added_mass
from lta_model.model import VehicleModel
from lta_model.state import pack_state, VELOCITY
from lta_sim.kernels.kernel import state_derivative
import numpy as np

MASS = 0.358  # parts and gas of GT-MAB [kg]
RADIUS, HALF_HEIGHT = 0.5, 0.2995  # of its hull as a spheroid [m]
AIR_DENSITY = 1.2  # [kg/m^3]
FORCE = 0.02  # as much as the 2 g that GT-MAB is heavy, upwards [N]
GRAVITY = 9.81  # [m/s^2]
ADDED = spheroid_added_mass(RADIUS, HALF_HEIGHT, AIR_DENSITY)


def lamb() -> float:
    """Return the acceleration by hand. [m/s^2]"""
    return FORCE / (MASS + ADDED[2])


def kernel() -> float:
    """Return the acceleration by LTA's kernel. [m/s^2]"""
    axes = ('surge', 'sway', 'heave')
    effects = {
        'weight_and_buoyancy': {'gravity': GRAVITY},
        'added_mass': dict(zip(axes, ADDED[:3], strict=True)),
    }
    model = VehicleModel.build(
        effects,
        mass=MASS,
        cg=np.zeros(3),
        inertia=np.diag([0.015, 0.015, 0.018]),
        displaced=MASS + FORCE / GRAVITY,
    )
    rate = state_derivative(pack_state(memory=initial_memory()), model, np.zeros(4))
    return float(rate[VELOCITY][2])


def figures() -> list[Figure]:
    """Return what is measured here."""
    name = 'kernel.heave'
    return [
        Figure(name, 'm/s2', kernel, rounds=1),
        Figure('lamb.heave', 'm/s2', lamb, rounds=1, of=name, peer='Lamb 1932'),
    ]
