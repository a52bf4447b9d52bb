# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The published law of a hull with wings, in axes forward, right, down."""

import numpy as np

from .parameters import NONE

FRD = np.diag([1.0, -1.0, -1.0])
SLOW = 1e-3


def hull_lift(p, memory, scene, thrusts):
    place = np.array([p('x'), 0.0, p('z')])
    v, w = FRD @ (scene.airspeed + np.cross(scene.rates, place)), FRD @ scene.rates
    level = np.array([v[0], 0.0, v[2]])
    flat = np.linalg.norm([*level, SLOW])
    fast = np.linalg.norm([*v, SLOW])
    ahead = np.linalg.norm([v[0], SLOW])
    alpha, beta = np.arctan2(v[2], ahead), np.arctan2(v[1], flat)
    ca, sa, cb, sb = v[0] / flat, v[2] / flat, flat / fast, v[1] / fast
    turn = np.array([[ca * cb, -ca * sb, -sa], [sb, cb, 0.0], [sa * cb, -sa * sb, ca]])
    q = 0.5 * p('density') * p('area') * (v @ v)
    drag = p('drag') + p('drag_alpha2') * alpha**2 + p('drag_beta2') * beta**2
    side = p('side') + p('side_alpha2') * alpha**2 + p('side_beta') * beta
    lift = p('lift') + p('lift_alpha') * alpha + p('lift_beta2') * beta**2
    roll = p('roll') + p('roll_alpha') * alpha + p('roll_beta') * beta
    pitch = p('pitch') + p('pitch_alpha') * alpha + p('pitch_beta4') * beta**4
    yaw = p('yaw') + p('yaw_alpha') * alpha + p('yaw_beta') * beta
    damping = -p.vector('roll_rate', 'pitch_rate', 'yaw_rate') * w
    steep = np.clip(2.0 * turn[0, 0] * abs(turn[0, 0]), -1.0, 1.0)
    ends = 1.5 * steep - 0.5 * steep**3
    wind = abs(ends) * (level @ level) / flat**2
    mirror = np.array([np.sign(ends), 1.0, np.sign(ends)])
    force = turn @ (q * np.array([-drag, side, -ends * lift]))
    moment = turn @ (q * np.array([ends * roll, ends * pitch, yaw]))
    moment = moment + wind * (turn @ (mirror * damping)) + (1.0 - wind) * damping
    push = FRD @ force
    return np.concatenate([push, FRD @ moment + np.cross(place, push)]), NONE


WINGS = {'hull_lift': hull_lift}
