"""
Compute the pendulum modes of a vehicle in roll and pitch.

In free flight, pitch and surge are coupled. With the pitch rate q, the surge u and the height c
of the centre of gravity above the hull centre (usually c < 0), the momentum along x is constant:
(m + A_x) u + m c q = 0. About the hull centre, where the buoyancy acts, this leaves

    I = I_yy + A_q - (m c)^2 / (m + A_x),   I w' = m g c p - D w

so the righting moment is k = -m g c per radian and the period 2 pi sqrt(I / k) (small angles,
undamped; Fossen 2011, section 12.2, for the restoring moment of a submerged body). Roll couples
with sway in the same way.

At an amplitude P, quadratic drag damps like a linear drag of 8/(3 pi) D2 w0 P (harmonic balance).
The drag of the coupled surge is included.
"""

from collections.abc import Mapping
from dataclasses import dataclass
import math
from typing import final, Literal

from lta_config.constants import STANDARD_GRAVITY
from lta_model.effects.drag import STRIP_DAMPING
from lta_model.effects.protocol import AXES, VehicleMotion
from lta_model.vehicle import Vehicle
import numpy as np

AMPLITUDE = math.radians(5.0)  # quadratic drag is linearised at this amplitude
ABOUT = {'roll': (0, 1), 'pitch': (1, 0)}  # axis of rotation, coupled axis of translation


@final
@dataclass(frozen=True, slots=True)
class PendulumMode:
    """The pendulum mode about one axis."""

    stiffness: float  # righting moment per angle; negative if unstable [N m/rad]
    inertia: float  # effective inertia, added inertia included [kg m2]
    damping: float  # moment per rate at an amplitude of 5 degrees [N m s]

    @property
    def period(self) -> float | None:
        """Undamped period; None if unstable. [s]"""
        if self.stiffness <= 0.0:
            return None
        return 2.0 * math.pi * math.sqrt(self.inertia / self.stiffness)

    @property
    def damping_ratio(self) -> float | None:
        """Ratio of the damping to critical damping; None if unstable."""
        if self.stiffness <= 0.0:
            return None
        return self.damping / (2.0 * math.sqrt(self.inertia * self.stiffness))

    @property
    def half_amplitude_time(self) -> float | None:
        """Time in which a swing of 5 degrees halves at constant damping. [s]"""
        if self.stiffness <= 0.0 or self.damping <= 0.0:
            return None
        # The amplitude decays with exp(-D t / 2 I)
        return 2.0 * math.log(2.0) * self.inertia / self.damping


def compute_pendulum_mode(vehicle: Vehicle, about: Literal['roll', 'pitch']) -> PendulumMode:
    """Compute the pendulum mode about body x or y."""
    turn, along = ABOUT[about]
    mass, added, cg = vehicle.mass, vehicle.added_mass, vehicle.cg
    stiffness = -mass * STANDARD_GRAVITY * float(cg[2])
    moving = mass + added[along]
    lever = mass * float(cg[2]) / moving  # surge by rate, and roll's sway but for its sign
    # Steiner: only offsets across the axis of rotation contribute
    off = np.delete(cg, turn)
    own = float(vehicle.inertia[turn, turn]) + mass * float(off @ off)
    # The coupled translation reduces the effective inertia, see the module docstring
    effects = vehicle.collect_effects()
    axis, way = AXES[3 + turn], AXES[along]
    gas = effects.get('gas_rotation', {})
    own += gas.get('share', 0.0) * gas.get(axis, 0.0)
    inertia = own + added[3 + turn] - moving * lever * lever
    # The translation is `lever` times the rate: linear drag acts with lever^2, quadratic with its
    # cube
    linear = effects['rotational_drag'][axis] + effects['linear_drag'][way] * lever**2
    linear += effects.get('hull_lift', {}).get(f'{about}_rate', 0.0)
    square = (
        effects['rotational_drag'][f'{axis}_2'] + effects['quadratic_drag'][way] * abs(lever) ** 3
    )
    square += _strip_damping_moment(effects.get('strip_damping', {}), turn)
    # Peak rate of a harmonic swing: amplitude times angular frequency
    rate = AMPLITUDE * math.sqrt(max(stiffness, 0.0) / inertia)
    return PendulumMode(stiffness, inertia, linear + 8.0 / (3.0 * math.pi) * square * rate)


def _strip_damping_moment(parameters: Mapping[str, float], turn: int) -> float:
    """Return the damping moment of frame and panels per squared rate. [N m s2]"""
    values = tuple(
        parameters.get(parameter.name, parameter.null) for parameter in STRIP_DAMPING.parameters
    )
    # Evaluate the effect at a unit rate: its moment is then the coefficient of the squared rate
    rates = (float(turn == 0), float(turn == 1), 0.0)
    still, level = (0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
    motion = VehicleMotion(still, level, still, rates, still, (), (), ())
    return -STRIP_DAMPING.wrench(values, (), motion, ())[3 + turn]
