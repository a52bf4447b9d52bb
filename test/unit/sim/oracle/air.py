# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Wind at the hull, its acceleration along its own way, and the memory of gusts and filters."""

import numpy as np

from .parameters import NONE

CALM = np.zeros(3)


def steady_wind(p, memory, scene):
    return p.vector('x', 'y', 'z'), CALM, NONE


def wind_profile(p, memory, scene):
    """Average the logarithm over the hull by quadrature; its slope is that between the ends."""
    z_0, reference, half = p('roughness'), p('height', 10.0), p('half_height')
    z = scene.position[2]

    def log_law(height):
        return np.log(height / z_0) / np.log(reference / z_0) if height > z_0 else 0.0

    if half == 0.0:
        share = log_law(z)
        slope = 1.0 / (z * np.log(reference / z_0)) if z > z_0 else 0.0
    else:
        low, high = max(z - half, z_0), max(z + half, z_0)
        nodes, weights = np.polynomial.legendre.leggauss(120)
        heights = 0.5 * (low + high) + 0.5 * (high - low) * nodes
        integral = 0.5 * (high - low) * weights @ np.array([log_law(h) for h in heights])
        share = integral / (2.0 * half)
        slope = (log_law(z + half) - log_law(z - half)) / (2.0 * half)
    there = p.vector('x', 'y') @ np.eye(2, 3)
    return share * there, slope * scene.wind[2] * there, NONE


def wind_gradient(p, memory, scene):
    gradient = np.array(
        [
            [p('x_x'), p('x_y'), p('x_z')],
            [p('y_x'), p('y_y'), p('y_z')],
            [p('z_x'), p('z_y'), 0.0],
        ]
    )
    gradient[2, 2] = -np.trace(gradient)
    current = gradient @ (scene.position - p.vector('x', 'y', 'z'))
    return current, gradient @ (scene.wind + current), NONE


def turbulence(p, memory, scene):
    """
    Write each filter as a state space.

    x_1 = sqrt(T) / (1 + T s) n and x_2 = x_1 / (1 + T s), so that x_2 + sqrt(3) T d/dt x_2 is
    (1 + sqrt(3) T s) sqrt(T) / (1 + T s)^2 n.
    """
    through = scene.turn @ scene.velocity - scene.wind
    blows, rates = [], []
    for name, kept, noise in zip(
        ('along', 'across', 'up'), np.split(memory, [1, 3]), scene.noise, strict=True
    ):
        sigma, length = p(name), p(f'{name}_length')
        if p('mean'):
            sigma *= min(np.hypot(*scene.wind[:2]) / p('mean'), 1.0)
        if p('height'):
            length *= np.clip(scene.position[2] / p('height'), 0.05, 1.0)
        time = length / max(np.linalg.norm(through), sigma) if length > 0.0 else np.inf
        if name == 'along':
            rates.append((np.sqrt(2.0 * time) * noise - kept[0]) / time if length else 0.0)
            blows.append(sigma * kept[0])
            continue
        first, second = kept
        slope = (first - second) / time
        rates += [(np.sqrt(time) * noise - first) / time if length else 0.0, slope]
        blows.append(sigma * (second + np.sqrt(3.0) * (first - second)))
    east, north = scene.wind[:2]
    heading = np.arctan2(north, east) if np.hypot(east, north) > 1e-3 else 0.0
    ahead = np.array([np.cos(heading), np.sin(heading), 0.0])
    left = np.array([-np.sin(heading), np.cos(heading), 0.0])
    blow = blows[0] * ahead + blows[1] * left + blows[2] * np.array([0.0, 0.0, 1.0])
    return blow, CALM, np.array(rates)


def gusts(p, memory, scene):
    since = memory[0] - p('begin')
    length, hold = p('length'), p('hold')
    until = (2.0 * length + hold) - since
    s = np.clip(min(since, until), 0.0, length)
    whole = p.vector('x', 'y', 'z')
    share = 0.5 * (1.0 - np.cos(np.pi * s / length))
    slope = 0.5 * np.pi / length * np.sin(np.pi * s / length) * (0.0 < s < length)
    return share * whole, (slope if since < until else -slope) * whole, np.ones(1)


AIR = {
    'steady_wind': steady_wind,
    'wind_profile': wind_profile,
    'wind_gradient': wind_gradient,
    'turbulence': turbulence,
    'gusts': gusts,
}
