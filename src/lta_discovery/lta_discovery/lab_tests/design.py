# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Design the tests of an afternoon for a vehicle: what is commanded, how large, and how long.

Everything follows from the vehicle file: steps from the thrust limits and the room, swings from
the period and the damping of the pendulum, a spin-down from the damping in yaw.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
import math
from typing import Final, final, Literal, NamedTuple

from lta_config.constants import STANDARD_GRAVITY
from lta_config.errors import BadInput
from lta_model.effects.protocol import AXES
from lta_model.propulsion import select_lifting_rotors
from lta_model.vehicle import Vehicle
from lta_vehicle.figures.stability import compute_pendulum_mode
from lta_vehicle.figures.thrust_envelope import find_push_limit, find_turn_limit, hover_thrust
from lta_vehicle.figures.wrench_limit import terminal_speed
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Kind = Literal['float', 'swing', 'step', 'spin_down', 'free_flight']
Variant = Literal['', 'smaller', 'reverse']  # of a step: beside it, it shows the law of the thrust

TILT: Final = math.radians(20.0)  # rad; release of a swing
ENDED: Final = math.radians(2.0)  # rad; a swing that is smaller teaches nothing more
LEAST_SWING: Final = 4.0  # periods; shortest swing
LONGEST_SWING: Final = 40.0  # s; longest swing, unless its periods are longer
FLOAT: Final = 8.0  # s
STEP_LENGTHS: Final = (6.0, 10.0)  # s; range of the length of a step
SETTLING_CONSTANTS: Final = 3.0  # time constants after which a step or spin-down has ended
FIRST_STEP_SHARE: Final = 0.5  # of the largest force or moment; first try of a step
SMALLER_STEP_SHARE: Final = 0.4  # of a step; size of the smaller one on the same axis
SMALLER: Final = 0.75  # factor on the step until it fits the room
LEAST_STEP: Final = 0.03  # of the largest force; a smaller step drowns in draughts
RATE: Final = math.radians(90.0)  # rad/s; fastest turn of a step, and start of a spin-down
SPIN: Final = (8.0, 25.0)  # s; range of the length of a spin-down
FREE_FLIGHT_TIME: Final = 60.0  # s; a free flight
LONGEST_WAY: Final = 4.0  # m; longest way of a test
STEP_REST: Final = 1.0  # s; before a step
HEAVIEST: Final = 0.1  # of the weight; a heavier vehicle falls rather than floats
WEAKEST: Final = 0.02  # of the largest force; a weaker one is no axis of command
NEGLIGIBLE_WRENCH: Final = 1e-6  # N, N m
# Directions in which a step of an axis is looked for, in order, with their signs
STEP_WAYS: Final = {
    'surge': (('forward', 1.0), ('backward', -1.0)),
    'sway': (('left', 1.0), ('right', -1.0)),
    'heave': (('up', 1.0), ('down', -1.0)),
    'yaw': (('turn_left', 1.0), ('turn_right', -1.0)),
}


class _Push(NamedTuple):
    """The largest push along an axis: its sign, its size [N, N m], and the thrusts [N]."""

    sign: float
    most: float
    thrusts: tuple[float, ...]


@final
@dataclass(frozen=True, slots=True)
class LabTest:
    """A test, as it is flown."""

    kind: Kind
    axis: str  # of `AXES`; '' for tests of the whole vehicle
    seconds: float  # [s]
    # Tilt about the axis, or yaw rate, when it is let go [rad], [rad/s]
    tilt: float = 0.0
    rate: float = 0.0
    share: float = 0.0  # of the largest force or moment of the axis that is commanded
    size: float = 0.0  # that force or moment [N], [N m]
    thrusts: tuple[float, ...] = ()  # of each rotor during a step [N]
    parts: 'tuple[LabTest, ...]' = ()  # steps that a free flight mixes
    variant: Variant = ''
    is_neutral: bool = False  # whether ballast has to carry the vehicle, since nothing else does

    @property
    def name(self) -> str:
        """Name in words."""
        return {
            'float': 'float',
            'swing': f'swing in {self.axis}',
            'step': f'{self.variant} step in {self.axis}'.strip(),
            'spin_down': 'spin-down',
            'free_flight': 'free flight',
        }[self.kind]


def list_designed_tests(vehicle: Vehicle, room: float = LONGEST_WAY) -> list[LabTest]:
    """
    Return the tests that this vehicle can do, one of each kind and axis.

    `room`: longest way of a test [m]. Raise `BadInput` if the vehicle falls without its rotors, or
    none of its rotors can push it.
    """
    if abs(vehicle.heaviness) > HEAVIEST * vehicle.mass:
        share = 100.0 * vehicle.heaviness / vehicle.mass
        raise BadInput(
            f"The gas of '{vehicle.file.name}' does not carry {share:.0f} % of its weight; "
            'the list is for vehicles that float, so choose one.'
        )
    steps = list(_design_steps(vehicle, room))
    if not steps:
        raise BadInput(
            f"The rotors of '{vehicle.file.name}' push it along no axis; check its rotors with "
            'lta vehicle show.'
        )
    return [
        LabTest('float', '', FLOAT, is_neutral=True),
        *_design_swings(vehicle),
        *steps,
        *_design_spin_down(vehicle),
        LabTest('free_flight', '', FREE_FLIGHT_TIME, parts=tuple(steps)),
    ]


def _design_swings(vehicle: Vehicle) -> Iterator[LabTest]:
    """Yield the swings: until the pendulum has come to rest."""
    for about in ('roll', 'pitch'):
        mode = compute_pendulum_mode(vehicle, about)
        if mode.period is None:
            continue
        halving = mode.half_amplitude_time or math.inf
        duration = halving * math.log2(TILT / ENDED)
        seconds = float(math.ceil(max(min(duration, LONGEST_SWING), LEAST_SWING * mode.period)))
        yield LabTest('swing', about, seconds, tilt=TILT, is_neutral=True)


def _design_steps(vehicle: Vehicle, room: float) -> Iterator[LabTest]:
    """Yield a step on each axis on which the rotors push, in the first direction that they can."""
    pushes = {axis: _largest_push(vehicle, axis) for axis in STEP_WAYS}
    strongest = max(
        (push.most for axis, push in pushes.items() if push and axis != 'yaw'), default=0.0
    )
    for axis, push in pushes.items():
        # A side force of a hundredth is a tilt of the rotors, no axis of command
        if push is not None and (axis == 'yaw' or push.most > WEAKEST * strongest):
            yield _design_step(vehicle, axis, push, room)


def list_step_variants(vehicle: Vehicle, step: LabTest) -> Iterator[LabTest]:
    """
    Yield a smaller step than a given one, and one the other way if the rotors push there.

    One size of a command shows the force at this size alone: a thrust that goes by its square
    looks like one with another gain. Propellers push less in reverse.
    """
    smaller = replace(step, variant='smaller')
    yield scale_step(vehicle, smaller, SMALLER_STEP_SHARE)
    sign = math.copysign(1.0, step.size)
    push = _largest_push(
        vehicle, step.axis, [one for one in STEP_WAYS[step.axis] if one[1] != sign]
    )
    if push is not None:
        share = min(abs(step.size) / push.most, 1.0)
        size, thrusts = push.sign * share * push.most, _mix_thrusts(vehicle, push, share)
        yield replace(step, variant='reverse', share=share, size=size, thrusts=thrusts)


def _largest_push(
    vehicle: Vehicle, axis: str, directions: Sequence[tuple[str, float]] = ()
) -> _Push | None:
    """
    Return the limit of an axis beyond hover, in the first of some directions that the rotors have.

    None if they cannot push along it.
    """
    weight = vehicle.heaviness * STANDARD_GRAVITY
    for direction, sign in directions or STEP_WAYS[axis]:
        find = find_turn_limit if axis == 'yaw' else find_push_limit
        limit, _ = find(vehicle, direction)
        if limit is None:
            continue
        # Upwards, the limit is the total force, which contains the carried weight
        most = limit.most - (max(weight, 0.0) if direction == 'up' else 0.0)
        if most > NEGLIGIBLE_WRENCH:
            return _Push(sign, most, limit.thrusts)
    return None


def _design_step(vehicle: Vehicle, axis: str, push: _Push, room: float) -> LabTest:
    """Return the largest step of an axis that fits the room."""
    k, share = AXES.index(axis), FIRST_STEP_SHARE
    seconds, way = _follow_step(vehicle, k, share * push.most)
    # A turn needs no room, but should not be faster than a tracker follows
    limit = 1.0 if axis == 'yaw' else room
    while way > limit and share > LEAST_STEP:
        share *= SMALLER
        seconds, way = _follow_step(vehicle, k, share * push.most)
    thrusts, size = _mix_thrusts(vehicle, push, share), push.sign * share * push.most
    return LabTest('step', axis, STEP_REST + seconds, share=share, size=size, thrusts=thrusts)


def _mix_thrusts(vehicle: Vehicle, push: _Push, share: float) -> tuple[float, ...]:
    """Return the thrust of each rotor in a step of a share of the largest push [N]."""
    return tuple(
        (1.0 - share) * hover + share * full
        for hover, full in zip(_rest_thrusts(vehicle), push.thrusts, strict=True)
    )


def scale_step(vehicle: Vehicle, step: LabTest, factor: float = SMALLER) -> LabTest:
    """Return a step that is smaller by a factor."""
    thrusts = tuple(
        hover + factor * (thrust - hover)
        for hover, thrust in zip(_rest_thrusts(vehicle), step.thrusts, strict=True)
    )
    return replace(step, share=factor * step.share, size=factor * step.size, thrusts=thrusts)


def _follow_step(vehicle: Vehicle, k: int, force: float) -> tuple[float, float]:
    """Return the length of a step [s], and its way [m] or, in yaw, its share of `RATE`."""
    axis, inertia = AXES[k], _total_inertia(vehicle, k)
    linear, square = _drag_of_axis(vehicle, axis)
    fastest = terminal_speed(force, linear, square) or math.inf
    # Of the first order about the terminal speed
    constant = inertia * fastest / force if math.isfinite(fastest) else STEP_LENGTHS[1]
    seconds = min(max(math.ceil(SETTLING_CONSTANTS * constant), STEP_LENGTHS[0]), STEP_LENGTHS[1])
    speed, way, dt = 0.0, 0.0, 0.05
    for _ in range(round(seconds / dt)):
        speed += dt * (force - (linear + square * abs(speed)) * speed) / inertia
        way += dt * speed
    return seconds, speed / RATE if axis == 'yaw' else way


def _drag_of_axis(vehicle: Vehicle, axis: str) -> tuple[float, float]:
    """Return linear and quadratic drag or damping of an axis."""
    effects = vehicle.collect_effects()
    if axis in ('roll', 'pitch', 'yaw'):
        turning = effects['rotational_drag']
        more = effects.get('hull_lift', {}).get(f'{axis}_rate', 0.0)
        return turning[axis] + more, turning[f'{axis}_2']
    return effects['linear_drag'][axis], effects['quadratic_drag'][axis]


def _total_inertia(vehicle: Vehicle, k: int) -> float:
    """Return mass or inertia of an axis with its added part [kg], [kg m2]."""
    added = float(vehicle.added_mass[k])
    return vehicle.mass + added if k < 3 else float(vehicle.inertia[k - 3, k - 3]) + added


def _rest_thrusts(vehicle: Vehicle) -> list[float]:
    """Return the thrust of each rotor that carries the weight [N]."""
    each, _ = hover_thrust(vehicle)
    lifting, _ = select_lifting_rotors(vehicle.rotors, vehicle.file.aero.coupling)
    names = [rotor.name for rotor in lifting]
    return [each if rotor.name in names else 0.0 for rotor in vehicle.rotors]


def _design_spin_down(vehicle: Vehicle) -> Iterator[LabTest]:
    """Yield the spin-down: until the damping in yaw has slowed it to a tenth."""
    linear, square = _drag_of_axis(vehicle, 'yaw')
    damping = linear + square * 0.3 * RATE
    constant = _total_inertia(vehicle, 5) / damping if damping > 0.0 else SPIN[1]
    seconds = float(min(max(math.ceil(2.0 * constant), SPIN[0]), SPIN[1]))
    yield LabTest('spin_down', 'yaw', seconds, rate=RATE, is_neutral=True)


def rest_duties(vehicle: Vehicle) -> list[float]:
    """Return the duty of each rotor that carries the weight."""
    return _thrusts_to_duties(vehicle, _rest_thrusts(vehicle))


def step_duties(vehicle: Vehicle, step: LabTest) -> list[float]:
    """Return the duty of each rotor in a step; negative for a reversed one."""
    return _thrusts_to_duties(vehicle, step.thrusts)


def _thrusts_to_duties(vehicle: Vehicle, thrusts: Sequence[float]) -> list[float]:
    return [
        math.copysign(rotor.duty_for_thrust(abs(thrust)), thrust)
        for rotor, thrust in zip(vehicle.rotors, thrusts, strict=True)
    ]
