# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
A flight of known truth, as files that laboratories write.

The vehicle flies a helix with 0.4 m/s along its x axis, pitches and rolls a little, and its
accelerometer feels gravity plus the turn. World z up, body x forward, y left, z up.
"""

import numpy as np
from scipy.spatial.transform import Rotation

RATE = 50.0  # Hz
G = 9.80665
DOWN = np.array([1.0, -1.0, -1.0])


def lab_flight(seconds=30.0, seed=0):
    """Return time, position, attitude (xyzw), body velocity, body rates and specific force."""
    rng = np.random.default_rng(seed)
    t = np.arange(0.0, seconds, 1.0 / RATE)
    yaw = 0.4 * t + 0.3 * np.sin(0.5 * t)
    pitch = 0.12 * np.sin(0.9 * t)
    roll = 0.10 * np.sin(1.3 * t + 1.0)
    turn = Rotation.from_euler('ZYX', np.stack([yaw, pitch, roll], axis=1))
    speed = np.stack([0.4 + 0.1 * np.sin(0.7 * t), 0.03 * np.sin(t), 0.08 * np.cos(0.6 * t)], 1)
    world = turn.apply(speed)
    place = np.cumsum(world, axis=0) / RATE + [0.5, -0.2, 1.5]
    step = (turn[:-1].inv() * turn[1:]).as_rotvec() * RATE
    rates = np.concatenate([step, step[-1:]])
    pull = np.gradient(world, t, axis=0) + np.array([0.0, 0.0, G])
    force = turn.inv().apply(pull)
    noise = [rng.normal(0.0, size, (len(t), 3)) for size in (1e-4, 2e-3, 3e-3, 0.02)]
    return {
        't': t, 'p': place + noise[0], 'q': turn.as_quat(), 'v': speed + noise[1],
        'w': rates + noise[2], 'a': force + noise[3],
        'rpy': np.stack([roll, pitch, np.arctan2(np.sin(yaw), np.cos(yaw))], axis=1),
    }  # fmt: skip


def write_csv(path, columns, delimiter=','):
    """Write columns with names."""
    names = list(columns)
    rows = np.stack([np.asarray(columns[name], dtype=float) for name in names], axis=1)
    lines = [delimiter.join(names)]
    lines += [delimiter.join(f'{value:.9g}' for value in row) for row in rows]
    path.write_text('\n'.join(lines) + '\n')
    return path


def three(name, values, axes='xyz'):
    return {f'{name}{axis}': values[:, index] for index, axis in enumerate(axes)}
