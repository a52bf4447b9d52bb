# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Floor, walls and ceiling: soft, one-sided, with smooth friction."""

import numpy as np

from .parameters import NONE

SLIP = 0.05


def contact(p, scene, normal, depth, place):
    """Return the wrench of a soft face at a place of the body, from its outward normal in map."""
    if depth <= 0.0:
        return np.zeros(6)
    speed = scene.turn @ (scene.velocity + np.cross(scene.rates, place))
    push = p('stiffness') * max(0.0, depth + p('relaxation') * (speed @ normal))
    slip = speed - (speed @ normal) * normal
    grip = -p('friction') * push * slip / np.sqrt(slip @ slip + SLIP**2)
    force = scene.turn.T @ (grip - push * normal)
    return np.concatenate([force, np.cross(place, force)])


def floor_contact(p, memory, scene, thrusts):
    foot = p.vector('x', 'y', 'z')
    depth = -(scene.position + scene.turn @ foot)[2]
    return contact(p, scene, np.array([0.0, 0.0, -1.0]), depth, foot), NONE


def walls(p, memory, scene, thrusts):
    squares = np.array([p('radius'), p('radius'), p('half_height')]) ** 2
    total = np.zeros(6)
    for axis, side, face in (
        (0, -1.0, -p('x_low')), (0, 1.0, p('x_high')), (1, -1.0, -p('y_low')),
        (1, 1.0, p('y_high')), (2, 1.0, p('ceiling')),
    ):  # fmt: skip
        normal = side * np.eye(3)[axis]
        seen = scene.turn.T @ normal
        reach = np.sqrt(squares @ seen**2)
        place = squares * seen / reach
        total += contact(p, scene, normal, scene.position @ normal + reach - face, place)
    return total, NONE


CONTACTS = {'walls': walls, 'floor_contact': floor_contact}
