# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Derive the stability figures: righting moment, pendulum modes, lean and tumbling speed.

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

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
import math
from typing import final, Literal

from lta_config.constants import STANDARD_GRAVITY
from lta_model import limits
from lta_model.effects.drag import STRIP_DAMPING
from lta_model.effects.protocol import AXES, VehicleMotion
from lta_model.vehicle import Vehicle
from lta_vehicle.figures.figure import DerivedFigure
from lta_vehicle.figures.mass_budget import ALL_BLOCKS, DEGREES
from lta_vehicle.figures.thrust_envelope import CARRIED_BLOCKS, compute_or_explain, find_push_limit
import numpy as np

AMPLITUDE = math.radians(5.0)  # quadratic drag is linearised at this amplitude
SWING_AXES = {'roll': (0, 1), 'pitch': (1, 0)}  # axis of rotation, coupled axis of translation


@final
@dataclass(frozen=True, slots=True)
class PendulumMode:
    """The pendulum mode about one axis."""

    stiffness: float  # righting moment per angle; negative if unstable [N m/rad]
    inertia: float  # effective inertia, added inertia included [kg m2]
    damping: float  # moment per rate at an amplitude of 5 degrees [N m s]

    @property
    def period(self) -> float | None:
        """Undamped period; None if unstable [s]."""
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
        """Time in which a swing of 5 degrees halves at constant damping [s]."""
        if self.stiffness <= 0.0 or self.damping <= 0.0:
            return None
        # The amplitude decays with exp(-D t / 2 I)
        return 2.0 * math.log(2.0) * self.inertia / self.damping


def compute_pendulum_mode(vehicle: Vehicle, about: Literal['roll', 'pitch']) -> PendulumMode:
    """Compute the pendulum mode about body x or y."""
    turn, along = SWING_AXES[about]
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
    """Return the damping moment of frame and panels per squared rate [N m s2]."""
    values = tuple(
        parameters.get(parameter.name, parameter.null) for parameter in STRIP_DAMPING.parameters
    )
    # Evaluate the effect at a unit rate: its moment is then the coefficient of the squared rate
    rates = (float(turn == 0), float(turn == 1), 0.0)
    still, level = (0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
    motion = VehicleMotion(still, level, still, rates, still, (), (), ())
    return -STRIP_DAMPING.wrench(values, (), motion, ())[3 + turn]


STABILITY = 'Stability'
SWING_NAMES: tuple[Literal['pitch', 'roll'], ...] = ('pitch', 'roll')


def derive_stability_figures(vehicle: Vehicle) -> Iterator[DerivedFigure]:
    """Yield the figures of the group 'Stability'."""
    pitch = compute_pendulum_mode(vehicle, 'pitch')
    # N m/rad to mN m per degree
    per_degree = 1e3 * pitch.stiffness / DEGREES
    rights = pitch.stiffness > 0.0
    yield DerivedFigure(
        'righting',
        STABILITY,
        'righting moment per degree',
        per_degree,
        'mN m',
        'weight times distance of the CG below the CB',
        ALL_BLOCKS,
        2,
        '' if rights else 'no righting moment; a controller must stabilise it',
    )
    # Periods and lean exist only with a positive righting moment
    if not rights:
        return
    for about in SWING_NAMES:
        yield from _derive_swing_figures(vehicle, about)
    yield from _derive_lean_figure(vehicle, pitch.stiffness)
    yield from _derive_tumble_figure(vehicle)


def _derive_swing_figures(
    vehicle: Vehicle, about: Literal['pitch', 'roll']
) -> Iterator[DerivedFigure]:
    mode = compute_pendulum_mode(vehicle, about)
    rule = 'righting moment, inertia and added mass of the free vehicle'
    words = f'period of the {about} oscillation'
    yield DerivedFigure(f'swing_{about}', STABILITY, words, mode.period, 's', rule, ALL_BLOCKS, 2)
    damping, note = mode.damping_ratio, 'no drag is given in the vehicle file'
    if mode.half_amplitude_time is not None:
        note = (
            'by steady drag alone, an oscillation of 5° halves in about '
            f'{mode.half_amplitude_time:.0f} s'
        )
    share = None if damping is None else 100.0 * damping
    rule, words = 'rotational drag, linearised at 5°', f'damping ratio in {about}'
    yield DerivedFigure(
        f'damping_{about}', STABILITY, words, share, '%', rule, (*ALL_BLOCKS, 'aero'), 1, note
    )


def _derive_lean_figure(vehicle: Vehicle, stiffness: float) -> Iterator[DerivedFigure]:
    push = find_push_limit(vehicle, 'forward')[0]
    if push is None or push.most <= 0.0:
        return
    # Balance of the pitching moment of the rotors: M = k sin(lean)
    share = abs(push.wrench[4]) / stiffness
    lean = DEGREES * math.asin(share) if share < 1.0 else None
    yield DerivedFigure(
        'push_lean',
        STABILITY,
        'tilt at full forward thrust',
        lean,
        '°',
        'pitching moment of the rotors against the righting moment',
        (*ALL_BLOCKS, *CARRIED_BLOCKS),
        note=''
        if lean is not None
        else f'the moment of the rotors is {share:.1f} times the largest righting moment',
    )


def _derive_tumble_figure(vehicle: Vehicle) -> Iterator[DerivedFigure]:
    tumble = limits.tumble_speed(vehicle)
    level, _ = compute_or_explain(lambda: limits.level_speed(vehicle))
    # The Munk moment destabilises only hulls whose added mass is larger across than along
    if math.isinf(tumble):
        note = 'the added mass across the hull is not larger than along it'
    elif level is None:
        note = 'above this speed, the Munk moment turns the hull sideways'
    elif level < tumble:
        note = (
            'above this speed, the Munk moment turns the hull sideways; its thrust allows '
            f'{level:.2f} m/s'
        )
    else:
        note = f'its thrust would allow {level:.2f} m/s; limit its speed'
    yield DerivedFigure(
        'tumble_speed',
        STABILITY,
        'tumbles above',
        tumble,
        'm/s',
        'Munk moment against the righting moment, without drag',
        ALL_BLOCKS,
        2,
        note,
    )
