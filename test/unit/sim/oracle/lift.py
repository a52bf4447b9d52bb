# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""What lifts and what rights: weights, buoyancy and gas; wrench and rates of the memory."""

import numpy as np

from .parameters import at, at_centre, G, NONE, T_AIR


def weight_and_buoyancy(p, memory, scene, thrusts):
    weight = -scene.body.mass * p('gravity') * scene.up
    buoyancy = scene.body.displaced * p('gravity') * scene.up
    return at(scene.body.cg, weight) + at_centre(buoyancy), NONE


def net_lift(p, memory, scene, thrusts):
    return at_centre(p('force') * scene.up), NONE


def helium_leak(p, memory, scene, thrusts):
    return at_centre(-memory[0] * scene.up), np.array([p('rate')])


def superheat(p, memory, scene, thrusts):
    steady, lag = p('warming') * scene.irradiance, p('lag')
    warmer = memory[0] if lag else steady
    # What the gas gains in volume displaces air of the outer density.
    more_air = p('slack') * scene.body.displaced * warmer / T_AIR
    return at_centre(more_air * G * scene.up), np.array([(steady - warmer) / lag if lag else 0.0])


def moving_mass(p, memory, scene, thrusts):
    goal = scene.mass_place - p.vector('x', 'y', 'z')
    if p('lag') == 0.0:
        away, speed = goal, np.zeros(3)
    else:
        away, speed = memory, (goal - memory) / p('lag')
        fast = np.linalg.norm(speed)
        if p('speed') and fast > p('speed'):
            speed = p('speed') * speed / fast
    weight = -p('mass') * G * scene.up
    # The weight itself is the vehicle's: only its moment moves.
    return at(away, weight) - at_centre(weight), speed


LIFT = {
    'weight_and_buoyancy': weight_and_buoyancy,
    'net_lift': net_lift,
    'helium_leak': helium_leak,
    'superheat': superheat,
    'moving_mass': moving_mass,
}
