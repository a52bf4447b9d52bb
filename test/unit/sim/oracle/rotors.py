# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""From a duty to newtons, rotor by rotor: the value and the rates of its memory."""

import numpy as np

from .parameters import NONE


def battery_compensation(p, i, memory, duty, scene):
    if p('voltage') == 0.0:
        return duty, NONE
    supply = scene.voltage or p('voltage')
    newtons = p('full') * duty
    if supply < 2.0 or newtons <= 0.0 or newtons < p('least'):
        return 0.0, NONE
    roots = np.roots([p('c_3'), p('c_2'), p('c_1'), p('c_0') - newtons])
    mean = roots.real[np.argmin(abs(roots.imag))]
    return min(mean / supply, 1.0), NONE


def battery_sag(p, i, memory, duty, scene):
    if p('voltage') == 0.0 or scene.voltage == 0.0:
        return duty, NONE
    below = scene.voltage / p('voltage') - 1.0
    return duty * max(0.0, 1.0 + p('sensitivity', 1.0) * below), NONE


def motor_deadband(p, i, memory, duty, scene):
    return (0.0 if abs(duty) < p('threshold') else duty), NONE


def motor_lag(p, i, memory, duty, scene):
    turning = memory[0]
    faster = abs(duty) > abs(turning) and np.sign(duty) * np.sign(turning) >= 0.0
    return turning, np.array([(duty - turning) / p('up' if faster else 'down')])


def thrust_polynomial(p, i, memory, duty, scene):
    if p('voltage') == 0.0:
        return duty, NONE
    volts = p('voltage') * abs(duty)
    least = max(volts, p('linear_to'))
    if least == 0.0:
        return 0.0, NONE
    cubic = np.polyval([p('c_3'), p('c_2'), p('c_1'), p('c_0')], least)
    return np.sign(duty) * max(0.0, cubic) * volts / least, NONE


def thrust_curve(p, i, memory, duty, scene):
    square = p(f'a_{i}') * duty**2 * np.sign(duty)
    return square + p(f'b_{i}', 1.0) * duty, NONE


def thrust_scale(p, i, memory, newtons, scene):
    return p('factor', 1.0) * newtons, NONE


def rotor_fault(p, i, memory, newtons, scene):
    return newtons - p(f'lost_{i}') * newtons, NONE


ROTORS = {
    'battery_compensation': battery_compensation,
    'battery_sag': battery_sag,
    'motor_deadband': motor_deadband,
    'motor_lag': motor_lag,
    'thrust_polynomial': thrust_polynomial,
    'thrust_curve': thrust_curve,
    'thrust_scale': thrust_scale,
    'rotor_fault': rotor_fault,
}
