"""
How a hanging vehicle swings back.

Free in the air, a pitch q about y swings together with the surge u, for their momentum along x is
kept, (m + A_x) u + m c q = 0 with c the height of the centre of gravity above the hull centre (it
is below: c < 0). About the hull centre, where the buoyancy acts, that leaves

    I = I_yy + A_q - (m c)^2 / (m + A_x),   I w' = m g c p - D w

so the righting moment is k = -m g c per radian and the period 2 pi sqrt(I / k) (small angles,
undamped; Fossen 2011, section 12.2, for the restoring moment of a submerged body). Roll goes with
sway in the same way.

Quadratic drag at an amplitude P takes from a swing what a linear one of 8/(3 pi) D2 w0 P would
(harmonic balance); the surge that goes with the swing is damped as well.
"""

from collections.abc import Mapping
from dataclasses import dataclass
import math
from typing import final, Literal

from lta_config.constants import STANDARD_GRAVITY
from lta_model.effects.aerodynamics import strip_damping
from lta_model.effects.protocol import AXES, VehicleMotion
from lta_model.vehicle import Vehicle
import numpy as np

AMPLITUDE = math.radians(5.0)  # of the swing whose damping is told
ABOUT = {'roll': (0, 1), 'pitch': (1, 0)}  # axis of rotation, axis that goes with it


@final
@dataclass(frozen=True, slots=True)
class PendulumMode:
    """
    A swing about one axis.

    Attributes
    ----------
    stiffness : float
        Righting moment by angle; negative turns over. [N m/rad]
    inertia : float
        What swings, air included. [kg m2]
    damping : float
        Moment by rate at an amplitude of 5 degrees. [N m s]

    """

    stiffness: float
    inertia: float
    damping: float

    @property
    def period(self) -> float | None:
        """Undamped; None where nothing rights it. [s]."""
        if self.stiffness <= 0.0:
            return None
        return 2.0 * math.pi * math.sqrt(self.inertia / self.stiffness)

    @property
    def damping_ratio(self) -> float | None:
        """Of damping to critical damping."""
        if self.stiffness <= 0.0:
            return None
        return self.damping / (2.0 * math.sqrt(self.inertia * self.stiffness))

    @property
    def half_amplitude_time(self) -> float | None:
        """Time in which a swing of 5 degrees would lose half at its present damping. [s]."""
        if self.stiffness <= 0.0 or self.damping <= 0.0:
            return None
        return 2.0 * math.log(2.0) * self.inertia / self.damping


def compute_pendulum_mode(vehicle: Vehicle, about: Literal['roll', 'pitch']) -> PendulumMode:
    """Return how a vehicle swings about body x or y."""
    turn, along = ABOUT[about]
    mass, added, cg = vehicle.mass, vehicle.added_mass, vehicle.cg
    stiffness = -mass * STANDARD_GRAVITY * float(cg[2])
    moving = mass + added[along]
    lever = mass * float(cg[2]) / moving  # surge by rate, and roll's sway but for its sign
    off = np.delete(cg, turn)
    own = float(vehicle.inertia[turn, turn]) + mass * float(off @ off)
    inertia = own + added[3 + turn] - moving * lever * lever
    effects = vehicle.collect_effects()
    axis, way = AXES[3 + turn], AXES[along]
    linear = effects['rotational_drag'][axis] + effects['linear_drag'][way] * lever**2
    linear += effects.get('hull_lift', {}).get(f'{about}_rate', 0.0)
    square = (
        effects['rotational_drag'][f'{axis}_2'] + effects['quadratic_drag'][way] * abs(lever) ** 3
    )
    square += _strip_damping_moment(effects.get('strip_damping', {}), turn)
    rate = AMPLITUDE * math.sqrt(max(stiffness, 0.0) / inertia)
    return PendulumMode(stiffness, inertia, linear + 8.0 / (3.0 * math.pi) * square * rate)


def _strip_damping_moment(parameters: Mapping[str, float], turn: int) -> float:
    """Return the moment of frame and panels against a turn by its rate squared. [N m s2]"""
    values = tuple(parameters.get(known.name, known.null) for known in strip_damping.PARAMETERS)
    rates = (float(turn == 0), float(turn == 1), 0.0)
    still, level = (0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
    motion = VehicleMotion(still, level, still, rates, still, (), (), ())
    return -strip_damping.compute_wrench(values, (), motion, ())[3 + turn]
