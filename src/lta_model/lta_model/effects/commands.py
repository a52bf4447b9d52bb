# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""What becomes of a command: its delay, and the force and moment that act for it."""

from lta_model.effects.protocol import (
    AXES,
    declare_each,
    EffectParameter,
    MeasurementEffect,
    Values,
)


def command_delay(p: Values, values: Values, time: float) -> Values:
    """
    Dead time between a command and the rotors.

        t' = t - delay

    Radio, scheduler and motor driver together: at flight time t the rotors execute the command for
    t - delay. `motor_lag`, a first-order lag, comes after it.
    """
    (delay,) = p
    return (values[0] - delay,)


_COMMAND_DELAY_SOURCE = (
    'spread (assumed): one control period at 100 Hz; limit: a second is a lost link'
)
COMMAND_DELAY = MeasurementEffect(
    'command_delay',
    (EffectParameter('delay', 's', 0.0, 0.0, 1.0, 0.01, _COMMAND_DELAY_SOURCE),),
    'command_time',
    command_delay,
)


def wrench_gain(p: Values, values: Values, time: float) -> Values:
    """
    Force and moment that act on the vehicle for a commanded wrench, on each axis.

        F = gain F_r sign(F_c) |F_c / F_r| ^ exponent, times `reverse` for F_c < 0

    F_c is the command and F_r (`reference`) the size of the command at which the gain holds. Of
    vehicles whose record has commanded forces and moments in place of duties (`wrench_command`). A
    gain below 1 is a loss between command and air, such as a weak battery or a wrong thrust law; a
    negative one is a command in other axes than those of the body. The exponent is 1 where thrust
    follows the command, and up to 2 where the command sets the rate of a propeller. Propellers
    push weaker in reverse. In simulation the rotors obey duties, and it has no influence.

    A command also acts on other axes: rotors below the hull push at a lever arm
    (`pitch_from_surge`, `roll_from_sway`), and their jets lift or press the hull.
    `heave_from_sway` times the command is a heave force that changes sign with it;
    `heave_from_sway_size` times its size is one that does not.
    """
    gain, exponent, reverse, reference = p[0:6], p[6:12], p[12:18], p[18:24]
    (
        heave_from_surge,
        heave_from_sway,
        heave_from_yaw,
        heave_from_surge_size,
        heave_from_sway_size,
        heave_from_yaw_size,
        pitch_from_surge,
        roll_from_sway,
    ) = p[24:32]
    x, y, z, k, m, n = values
    jets = heave_from_surge * x + heave_from_sway * y + heave_from_yaw * n
    jets += (
        heave_from_surge_size * abs(x)
        + heave_from_sway_size * abs(y)
        + heave_from_yaw_size * abs(n)
    )
    return (
        gain[0] * _act(x, exponent[0], reverse[0], reference[0]),
        gain[1] * _act(y, exponent[1], reverse[1], reference[1]),
        gain[2] * _act(z, exponent[2], reverse[2], reference[2]) + jets,
        gain[3] * _act(k, exponent[3], reverse[3], reference[3]) + roll_from_sway * y,
        gain[4] * _act(m, exponent[4], reverse[4], reference[4]) + pitch_from_surge * x,
        gain[5] * _act(n, exponent[5], reverse[5], reference[5]),
    )


def find_command(p: Values, wrench: Values) -> Values:
    """
    Return the command that causes a wrench; a gain of 0, which causes none, counts as 1.

    Without what a command does on other axes.
    """
    out = []
    for i, force in enumerate(wrench):
        gain, exponent, reverse, reference = p[i : 4 * len(AXES) : len(AXES)]
        full = _weaken(force / (gain or 1.0), 1.0 / (reverse or 1.0))
        out.append(_raise_to(full, 1.0 / exponent, reference))
    return tuple(out)


# All for numbers and arrays alike: a replay computes the commands of a flight at once
def _act(command: float, exponent: float, reverse: float, reference: float) -> float:
    return _weaken(_raise_to(command, exponent, reference), reverse)


def _raise_to(command: float, exponent: float, reference: float) -> float:
    if exponent == 1.0:  # exact
        return command
    sign = (command > 0.0) * 1.0 - (command < 0.0) * 1.0
    size: float = abs(command / reference) ** exponent
    return reference * sign * size


def _weaken(force: float, reverse: float) -> float:
    return force * (1.0 + (reverse - 1.0) * (force < 0.0))


_WRENCH_GAIN_SOURCE = 'spread (assumed): the thrust law of a lab that never measured its rotors'
_JETS = 'spread (assumed): half of what a command does on its own axis'
_ARMS = 'spread (assumed): rotors a hull radius below the centre'
WRENCH_GAIN = MeasurementEffect(
    'wrench_gain',
    (
        *declare_each(AXES, '1', 1.0, -20.0, 20.0, 0.2, _WRENCH_GAIN_SOURCE),
        *(
            EffectParameter(f'exponent_{axis}', '1', 1.0, 0.3, 4.0, 0.2, _WRENCH_GAIN_SOURCE)
            for axis in AXES
        ),
        *(
            EffectParameter(f'reverse_{axis}', '1', 1.0, 0.0, 5.0, 0.2, _WRENCH_GAIN_SOURCE)
            for axis in AXES
        ),
        *(
            EffectParameter(f'reference_{axis}', unit, 1.0, 1e-6, 1e3, 0.1, _WRENCH_GAIN_SOURCE)
            for axis, unit in zip(AXES, 3 * ('N',) + 3 * ('N m',), strict=True)
        ),
        *(
            EffectParameter(f'heave_from_{source}{end}', unit, 0.0, -1e5, 1e5, 0.5 * size, _JETS)
            for end in ('', '_size')
            for source, unit, size in (
                ('surge', '1', 1.0),
                ('sway', '1', 1.0),
                ('yaw', '1/m', 100.0),
            )
        ),
        *declare_each(('pitch_from_surge', 'roll_from_sway'), 'm', 0.0, -10.0, 10.0, 0.3, _ARMS),
    ),
    'command_wrench',
    wrench_gain,
)
