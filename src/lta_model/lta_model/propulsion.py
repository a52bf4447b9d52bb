# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
The rotors of a vehicle: position, thrust curve and wrench of each.

A rotor without a column from the wind tunnel has the one of its geometry. With a its axis, r its
place and k the torque of the air per thrust:

    force = a,   moment = r x a + s k a,   s = 1 clockwise, -1 anticlockwise

seen with the thrust coming towards the eye: the air turns the rotor back, and the motor the body.
A column holds what jets do; the motor's torque s k a comes on top, since they are solved without
swirl.
"""

from collections.abc import Iterable
from dataclasses import dataclass
import math
from typing import final, Self

from lta_config.errors import BadInput
from lta_config.schema.vehicle_aero import RotorColumn, RotorCoupling
from lta_config.schema.vehicle_file import RotorBlock, ThrustCurve, VehicleFile

Three = tuple[float, float, float]
Six = tuple[float, float, float, float, float, float]


@final
@dataclass(frozen=True, slots=True)
class RotorModel:
    """One rotor as the model takes it."""

    name: str  # as in `motors`
    reversible: bool  # whether it accepts negative duty
    # From the hull centre [m], and unit direction of its thrust
    place: Three
    axis: Three
    # T = a u^2 + b u [N]
    a: float
    b: float
    # Wrench about the hull centre per newton of a + b, forward and, for the same duty reversed,
    # backward (times -T) [1, m]
    column: Six
    reverse: Six

    @property
    def full_thrust(self) -> float:
        """Thrust at full duty. [N]."""
        return self.a + self.b

    def duty_for_thrust(self, thrust: float) -> float:
        """Return the duty for a forward thrust of 0 or more. [1]."""
        # Inverse of T = a u^2 + b u in the form that also holds for a = 0
        return 2.0 * thrust / (self.b + math.sqrt(self.b * self.b + 4.0 * self.a * thrust))

    @classmethod
    def from_entry(
        cls, name: str, rotor: RotorBlock, column: RotorColumn | None, curve: ThrustCurve
    ) -> Self:
        """Return a rotor from what the file says of it."""
        x, y, z, *_ = forward = backward = geometric_column(rotor)
        # The force part of a geometric column is the unit axis
        axis, (p, q, r) = (x, y, z), rotor.position.vector
        if column:
            forward = backward = _to_six_tuple((*column.force.vector, *column.moment.vector))
            if column.reverse:
                backward = _to_six_tuple(
                    (*column.reverse.force.vector, *column.reverse.moment.vector)
                )
        forward, backward = (_add_motor_torque(each, rotor, axis) for each in (forward, backward))
        a, b = curve.a.si, curve.b.si
        if curve.reverse:  # the column includes it, because the model's curve is an odd function
            backward = _to_six_tuple(curve.reverse.si / (a + b) * number for number in backward)
        return cls(name, rotor.reversible, (p, q, r), axis, a, b, forward, backward)


def geometric_column(rotor: RotorBlock) -> Six:
    """Return the column of a rotor's place and axis alone, without its motor's torque. [1, m]."""
    length = math.hypot(*rotor.axis.vector)
    x, y, z = (number / length for number in rotor.axis.vector)
    p, q, r = rotor.position.vector
    # Force a, moment r x a
    return (x, y, z, q * z - r * y, r * x - p * z, p * y - q * x)


def build_rotors(file: VehicleFile) -> tuple[RotorModel, ...]:
    """Return the rotors of a vehicle in the order of its file."""
    return tuple(
        RotorModel.from_entry(
            name, rotor, file.aero.thrust_allocation.get(name), _select_thrust_curve(file, rotor)
        )
        for name, rotor in file.rotors.items()
    )


def interaction_parameters(
    rotors: tuple[RotorModel, ...], coupling: RotorCoupling | None
) -> dict[str, float]:
    """Return the parameters of `rotor_envelope_interaction`; empty if B suffices."""
    axes = ('surge', 'sway', 'heave', 'roll', 'pitch', 'yaw')
    parameters = {}
    for i, rotor in enumerate(rotors, start=1):
        for axis, forward, backward in zip(axes, rotor.column, rotor.reverse, strict=True):
            if rotor.reversible and backward != forward:
                # What reversed thrust adds to B T
                parameters[f'{axis}_{i}'] = backward - forward
    if coupling:
        for axis, number in zip(axes, coupling.force.vector + coupling.moment.vector, strict=True):
            parameters[f'together_{axis}'] = number
        for i, rotor in enumerate(rotors, start=1):
            if rotor.name in coupling.rotors:
                parameters[f'share_{i}'] = -1.0 if coupling.reversed else 1.0
    return parameters


def _select_thrust_curve(file: VehicleFile, rotor: RotorBlock) -> ThrustCurve:
    curve = rotor.thrust_curve or file.thrust_curve
    if curve is None:
        raise BadInput(
            f'{file.name} has a rotor without a thrust curve; add thrust_curve to the rotor or '
            'to the vehicle file.'
        )
    return curve


def _add_motor_torque(jet: Six, rotor: RotorBlock, axis: Three) -> Six:
    """Return a column with the torque of the motor; per newton it is the same in reverse."""
    a, b, c, d, e, f = jet
    x, y, z = axis
    turn = 0.0
    if rotor.torque:
        # s k: positive for a clockwise rotor
        turn = rotor.torque.per_thrust.si * (1.0 if rotor.torque.spin == 'clockwise' else -1.0)
    return (a, b, c, d + turn * x, e + turn * y, f + turn * z)


def _to_six_tuple(numbers: Iterable[float]) -> Six:
    a, b, c, d, e, f = numbers
    return (a, b, c, d, e, f)


HEAVE_AXIS = 2
LEAST_LIFT = 0.5  # newtons upwards per newton of thrust that make a rotor one that lifts


def select_lifting_rotors(
    rotors: tuple[RotorModel, ...], coupling: RotorCoupling | None
) -> tuple[list[RotorModel], float]:
    """
    Return the lifting rotors, run alike, and their lift per newton of each.

    Rotors whose own column points up (or, reversed, does); if there are none, those that lift
    together by colliding jets.
    """
    own = []
    total = 0.0
    for rotor in rotors:
        # A reversible rotor may lift with either direction
        up = max(rotor.column[HEAVE_AXIS], -rotor.reverse[HEAVE_AXIS] if rotor.reversible else 0.0)
        if up > LEAST_LIFT:
            own.append(rotor)
            total += up
    if own or coupling is None:
        return own, total
    together = [rotor for rotor in rotors if rotor.name in coupling.rotors]
    for rotor in together:
        # The column for reversed thrust is per newton of negative thrust
        total += -rotor.reverse[HEAVE_AXIS] if coupling.reversed else rotor.column[HEAVE_AXIS]
    return together, total + coupling.force.vector[HEAVE_AXIS]


def hover_duty(
    name: str,
    rotors: tuple[RotorModel, ...],
    coupling: RotorCoupling | None,
    weight: float,
    gravity: float,
) -> float:
    """
    Return the largest duty among the rotors that carry a weight, all with the same thrust [1].

    `weight` is less buoyancy [N], nothing to carry if not positive; `gravity` [m/s2] is for the
    message.

    Raise `BadInput` if nothing lifts, or not enough.
    """
    if weight <= 0.0:
        return 0.0
    own, per_newton = select_lifting_rotors(rotors, coupling)
    if not own or per_newton <= 0.0:
        raise BadInput(
            f'{name} has no rotor that pushes upwards, so it cannot hover; in the '
            'vehicle file, change the axis of a rotor.'
        )
    # The weakest rotor limits, since all run alike
    thrust, full = weight / per_newton, min(rotor.full_thrust for rotor in own)
    if thrust > full:
        raise BadInput(
            f'{name} needs {thrust:.3f} N from each lifting rotor to hover, but a rotor '
            f'has at most {full:.3f} N; make the vehicle at least '
            f'{1e3 * (thrust - full) * per_newton / gravity:.1f} g lighter.'
        )
    return max(rotor.duty_for_thrust(thrust) for rotor in own)
