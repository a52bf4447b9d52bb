# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""What the air does to the hull and to what hangs on it."""

import numpy as np

from .parameters import at_centre, AXES, NONE

SLOW = 1e-3


def linear_drag(p, memory, scene, thrusts):
    return at_centre(-p.vector(*AXES[:3]) * scene.airspeed), NONE


def quadratic_drag(p, memory, scene, thrusts):
    v = scene.airspeed
    return at_centre(-p.vector(*AXES[:3]) * v**2 * np.sign(v)), NONE


def rotational_drag(p, memory, scene, thrusts):
    w = scene.rates
    linear = p.vector(*AXES[3:])
    quadratic = p.vector(*(f'{axis}_2' for axis in AXES[3:]))
    return np.concatenate([np.zeros(3), -linear * w - quadratic * w**2 * np.sign(w)]), NONE


def cross_flow(p, memory, scene, thrusts):
    v = scene.airspeed
    speed, flat = np.linalg.norm(v), np.linalg.norm(v[:2])
    seen = abs(v) + p('total') * (speed - np.array([flat, flat, abs(v[2])]))
    seen[:2] += p('horizontal') * (flat - abs(v[:2]))
    return at_centre(-p.vector(*AXES[:3]) * (seen - abs(v)) * v), NONE


def oblique_lift(p, memory, scene, thrusts):
    x, y, z = scene.airspeed
    incidence = np.arctan2(z, np.hypot(x, y))
    # sin(2 a) / 2 = sin(a) cos(a)
    force = -p('lift') * 0.5 * np.sin(2.0 * incidence) * (x * x + y * y + z * z)
    force /= 1.0 + p('stall') * np.sin(incidence) ** 2
    return at_centre(np.array([0.0, 0.0, force])), NONE


def munk_moment(p, memory, scene, thrusts):
    v = scene.airspeed
    moment = p('lost') * np.cross(v, scene.body.added[:3] * v)
    return np.concatenate([np.zeros(3), moment]), NONE


def strip_damping(p, memory, scene, thrusts):
    nodes, weights = np.polynomial.legendre.leggauss(3)
    total = np.zeros(6)
    for i in range(1, 5):
        middle = p.vector(*(f'{axis}_{i}' for axis in 'xyz'))
        half = p.vector(*(f'half_{axis}_{i}' for axis in 'xyz'))
        drag = p.vector(*(f'{axis}_{i}' for axis in AXES[:3]))
        for s, weight in zip(nodes, weights, strict=True):
            place = middle + s * half
            u = p('translation') * scene.airspeed + np.cross(scene.rates, place)
            force = -drag * abs(u) * u * 0.5 * weight
            total += np.concatenate([p('translation') * force, np.cross(place, force)])
    return total, NONE


HULL = {
    'linear_drag': linear_drag,
    'quadratic_drag': quadratic_drag,
    'rotational_drag': rotational_drag,
    'cross_flow': cross_flow,
    'munk_moment': munk_moment,
    'oblique_lift': oblique_lift,
    'strip_damping': strip_damping,
}
