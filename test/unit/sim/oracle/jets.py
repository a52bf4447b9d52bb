# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""What the rotors do, and what hull, floor and ceiling make of their jets."""

import numpy as np

from .parameters import at, AXES, NONE

ROTORS = range(1, 9)


def matrix(p):
    """Return the 6 x 8 matrix of parameters `surge_1` to `yaw_8`."""
    return np.array([[p(f'{axis}_{i}') for i in ROTORS] for axis in AXES])


def rotor_thrust(p, memory, scene, thrusts):
    return matrix(p) @ thrusts, NONE


def rotor_misalignment(p, memory, scene, thrusts):
    total = np.zeros(6)
    for i, (place, axis) in enumerate(zip(scene.body.places, scene.body.axes, strict=True)):
        if not axis.any():
            continue
        steep = abs(axis[2]) > np.cos(np.radians(45.0))
        first = np.cross([0.0, 1.0, 0.0] if steep else [0.0, 0.0, 1.0], axis)
        first /= np.linalg.norm(first)
        second = np.cross(axis, first)
        theta = p(f'first_{i + 1}') * first + p(f'second_{i + 1}') * second
        total += at(place, thrusts[i] * np.cross(theta, axis))
    return total, NONE


def rotor_envelope_interaction(p, memory, scene, thrusts):
    reversed_ = matrix(p) @ np.minimum(thrusts, 0.0)
    together = p.vector(*(f'together_{axis}' for axis in AXES))
    shares = p.vector(*(f'share_{i}' for i in ROTORS))
    taking = (shares * thrusts)[shares != 0.0]
    weakest = max(0.0, taking.min()) if taking.size else 0.0
    return reversed_ + weakest * together, NONE


def lifting(scene, thrusts):
    """Yield place, axis, height, upward part of the axis and thrust of the rotors that lift."""
    for place, axis, thrust in zip(scene.body.places, scene.body.axes, thrusts, strict=True):
        upward = (scene.turn @ axis)[2]
        if upward * thrust > 0.0:
            yield place, axis, (scene.position + scene.turn @ place)[2], upward, thrust


def ground_effect(p, memory, scene, thrusts):
    total = np.zeros(6)
    for place, axis, height, upward, thrust in lifting(scene, thrusts):
        x = (p('radius') / (4.0 * max(height, 0.5 * p('radius')))) ** 2
        total += at(place, p('gain') * x / (1.0 - x) * abs(upward) * thrust * axis)
    return total, NONE


def ceiling_effect(p, memory, scene, thrusts):
    total = np.zeros(6)
    for place, axis, height, upward, thrust in lifting(scene, thrusts):
        gap = max(p('height') - height, 0.25 * p('radius'))
        # Less cancellation than in sqrt(1 + x) - 1.
        x = p('radius') ** 2 / (8.0 * gap**2)
        share = p('gain') * 0.5 * x / (np.sqrt(1.0 + x) + 1.0)
        total += at(place, share * abs(upward) * thrust * axis)
    return total, NONE


JETS = {
    'rotor_thrust': rotor_thrust,
    'rotor_misalignment': rotor_misalignment,
    'rotor_envelope_interaction': rotor_envelope_interaction,
    'ground_effect': ground_effect,
    'ceiling_effect': ceiling_effect,
}
