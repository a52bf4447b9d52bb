# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""From a command to the thrust of a rotor: firmware, battery, motor and propeller."""

from collections.abc import Mapping

from lta_model.effects.protocol import ActuatorEffect, declare_each, EffectParameter, Values
from lta_model.state import VOLTAGE

BROKEN_VOLTAGE = 2.0  # V: below it the firmware stops the motors
NEWTON_STEPS = 24  # steps; from 60 V down to 1 V takes 17
LEAST_SLOPE = 1e-9  # N/V: less slope than any motor has, against a division by zero


def battery_compensation(p: Values, memory: Values, value: float, surroundings: Values) -> float:
    """
    Firmware that corrects the duty for the battery voltage.

        u' = min(1, v / V),   v from   c_0 + c_1 v + c_2 v^2 + c_3 v^3 = full u

    The commanded duty u is a share of the thrust `full`. The firmware inverts the cubic to get the
    mean motor voltage v for this thrust, and divides by the battery voltage V. u' is 0 where full
    u is below `least`, where V is below 2 V (a broken battery to the firmware), and for a negative
    u, which this firmware cannot drive. V is the voltage under load from the surroundings; where
    that is unknown (0), the nominal `voltage`. A nominal voltage of 0 switches the effect off.

    It is the first actuator effect, as in the firmware. With the same nominal voltage in
    `battery_sag` and `thrust_polynomial` and the same cubic, the thrust is full u at any voltage
    until u' reaches 1. Not modelled: the 0.1 s low pass on V and the 16 bits of the PWM.

    Firmware for the Crazyflie 2 platform, 2026.08, built with CONFIG_ENABLE_THRUST_BAT_COMPENSATED
    (the default): motorsCompensateBatteryVoltage in src/drivers/src/motors.c, batteryCompensation
    in src/modules/src/stabilizer.c, numbers in src/platform/interface/platform_defaults_cf2.h, N
    per motor (cubics to more digits there; the same as in `thrust_polynomial`):

        propellers     full    least     c_0        c_1        c_2         c_3
        2.1+           0.12   0.012818  -0.024765   0.065238  -0.026793   0.0067768
        legacy         0.12   0.012818  -0.014831   0.047245  -0.018474   0.0059609
        upgrade kit    0.18   0.019226   0.0067281  0.0101156  0.0102632  0.0028359

    The firmware solves the cubic in closed form. Here Newton's method avoids the cube root, so
    that all implementations of the model agree to the last bit.
    """
    voltage, full, least, c_0, c_1, c_2, c_3 = p
    if voltage <= 0.0:
        return value
    # 0 means that the voltage is unknown
    supply = surroundings[VOLTAGE] if surroundings[VOLTAGE] > 0.0 else voltage
    thrust = full * value
    # As in the firmware: nothing below the least thrust, and none in reverse
    if supply < BROKEN_VOLTAGE or thrust < least or thrust <= 0.0:
        return 0.0
    # Even the full battery voltage does not reach the thrust
    if c_0 + supply * (c_1 + supply * (c_2 + supply * c_3)) <= thrust:
        return 1.0
    # Newton's method starts at the supply voltage, right of the root
    mean = supply
    for _ in range(NEWTON_STEPS):
        excess = c_0 + mean * (c_1 + mean * (c_2 + mean * c_3)) - thrust
        slope = c_1 + mean * (2.0 * c_2 + mean * (3.0 * c_3))
        # Clipped to 0 and the supply, where the root is known to be
        mean = min(max(mean - excess / max(slope, LEAST_SLOPE), 0.0), supply)
    return mean / supply


def check_battery_compensation(values: Mapping[str, float]) -> str:
    """Return an objection to a cubic that cannot be inverted, or ''."""
    others = [values[name] for name in ('full', 'least', 'c_0', 'c_1', 'c_2', 'c_3')]
    if values['voltage'] == 0.0:
        return (
            'set voltage to the nominal battery voltage, or all other parameters to zero'
            if any(others)
            else ''
        )
    full, least, _, c_1, c_2, c_3 = others
    if full <= least:
        return 'full (the largest thrust) must be larger than least (the smallest thrust)'
    # The derivative c_1 + 2 c_2 v + 3 c_3 v^2 must have no real root
    if max(c_1, c_3) == 0.0 or (c_2 < 0.0 and c_2 * c_2 >= 3.0 * c_1 * c_3):
        return (
            'the thrust by c_0 to c_3 must increase with the voltage everywhere, so that it '
            'can be inverted; correct c_1 to c_3'
        )
    return ''


_NOMINAL = (
    'a lithium cell has 3.0 to 4.2 V (Crazyflie firmware: critical at 3.0 V); limit: 14 cells'
)
_THRUST = 'crazyflie-firmware 54f31e24: 0.12 N, upgrade kit 0.18 N; limit as for thrust_curve'
_LEAST = 'crazyflie-firmware 54f31e24: 0.0128 N, upgrade kit 0.0192 N; limit as for thrust_curve'
_BATTERY_COMPENSATION_CUBIC = (
    'crazyflie-firmware 54f31e24; spread: its three sets of propellers differ by 10 to 20 mN'
)

BATTERY_COMPENSATION = ActuatorEffect(
    'battery_compensation',
    (
        EffectParameter('voltage', 'V', 0.0, BROKEN_VOLTAGE, 60.0, 0.1, _NOMINAL),
        EffectParameter('full', 'N', 0.0, 0.0, 50.0, 0.01, _THRUST),
        EffectParameter('least', 'N', 0.0, 0.0, 50.0, 0.003, _LEAST),
        EffectParameter('c_0', 'N', 0.0, -10.0, 10.0, 0.01, _BATTERY_COMPENSATION_CUBIC),
        EffectParameter('c_1', 'N/V', 0.0, 0.0, 10.0, 0.02, _BATTERY_COMPENSATION_CUBIC),
        EffectParameter('c_2', 'N/V2', 0.0, -10.0, 10.0, 0.01, _BATTERY_COMPENSATION_CUBIC),
        EffectParameter('c_3', 'N/V3', 0.0, 0.0, 10.0, 0.003, _BATTERY_COMPENSATION_CUBIC),
    ),
    (),
    battery_compensation,
    check=check_battery_compensation,
)


def battery_sag(p: Values, memory: Values, value: float, surroundings: Values) -> float:
    """
    Thrust that decreases with the battery voltage.

        u' = u max(0, 1 + sensitivity (V / voltage - 1))

    A brushed motor under pulse-width modulation sees the mean voltage V u, so a thrust curve
    measured against duty at one battery voltage holds at another with u' = u V / voltage: a
    sensitivity of 1. V is the voltage under load from the surroundings; if it is unknown (0), or
    the nominal `voltage` is 0, nothing changes.

    The sensitivity is d ln u' / d ln V at the nominal voltage. In Crazyflie flights force per duty
    goes with V^0.7; with a thrust curve of T ~ u^1.45 near hover that is a sensitivity of 0.5.
    Linear instead of a power: within 20 % of the nominal voltage and for sensitivities up to 1
    they differ by at most 0.7 %, and no call of pow is needed.

    Applied before the lag: a rotor follows the voltage as slowly as the duty.
    """
    voltage, sensitivity = p
    present = surroundings[VOLTAGE]
    # A voltage of 0 means unknown, a nominal one of 0 means off
    if voltage > 0.0 and present > 0.0:
        return value * max(0.0, 1.0 + sensitivity * (present / voltage - 1.0))
    return value


_SENSITIVITY = (
    '1: thrust by the mean voltage; in Crazyflie flights, force per duty goes with V^0.6 to V^0.7'
)

BATTERY_SAG = ActuatorEffect(
    'battery_sag',
    (
        EffectParameter('voltage', 'V', 0.0, 0.0, 60.0, 0.1, _NOMINAL, beside=3.7),
        EffectParameter('sensitivity', '1', 1.0, 0.0, 2.0, 0.3, _SENSITIVITY),
    ),
    (),
    battery_sag,
)


def motor_deadband(p: Values, memory: Values, value: float, surroundings: Values) -> float:
    """
    Deadband of a brushed motor at small duty.

        u' = u   if |u| >= threshold,   else 0

    At rest the current is u V / R, and below some duty its torque does not overcome brushes,
    bearings and cogging. Above it the whole duty acts: the thrust curve was measured against the
    commanded duty and passes the origin (four Crazyflie motors turn at 4485 rpm at 6.25 % duty,
    9374 rpm at 18.75 %), so it includes running friction; hence a jump and no shift. The command
    is constant during a step, so the jump does not disturb the integrator. Not modelled:
    hysteresis between start and stop, and the full-duty pulse with which some drivers start the
    motor.

    Table: Bitcraze, crazyflie-firmware, docs/functional-areas/pwm-to-thrust.md (2015).
    """
    (threshold,) = p
    # The deadband is symmetric for reversible rotors
    return value if abs(value) >= threshold else 0.0


_MOTOR_DEADBAND_SOURCE = 'Bitcraze 2015: 7 mm motors turn at 6.25 % duty; limit and spread assumed'

MOTOR_DEADBAND = ActuatorEffect(
    'motor_deadband',
    (EffectParameter('threshold', '1', 0.0, 0.0, 0.5, 0.03, _MOTOR_DEADBAND_SOURCE),),
    (),
    motor_deadband,
)


def motor_lag(p: Values, memory: Values, duty: float, surroundings: Values) -> float:
    """
    First-order lag of each motor, with separate time constants up and down.

        d/dt m = (u - m) / tau,   tau = `up` while |u| > |m| and u m >= 0, else `down`

    u is the commanded duty, m (memory) the one at which the rotor turns; a reversing rotor brakes
    first. With both time constants zero the rotor turns at u. 72 ms fits a 7 mm motor with a 45 mm
    propeller (Eschmann, Albani and Loianno 2024, arXiv:2404.07837).
    """
    up, down = p
    # Without a lag the memory is not integrated and must not be used
    return duty if up + down == 0.0 else memory[0]


def motor_lag_rate(p: Values, memory: Values, duty: float, surroundings: Values) -> Values:
    """Return d/dt of the lagged duty."""
    up, down = p
    # Opposite signs: the rotor brakes first, with the time constant down
    tau = up if abs(duty) > abs(memory[0]) and duty * memory[0] >= 0.0 else down
    return ((duty - memory[0]) / tau if tau > 0.0 else 0.0,)


def check_motor_lag(values: Mapping[str, float]) -> str:
    """Return an objection to a lag in one direction only: its memory would jump."""
    if (values['up'] == 0.0) != (values['down'] == 0.0):
        return 'the time constants up and down must both be zero (no lag) or both be positive'
    return ''


_MOTOR_LAG_SOURCE = 'Eschmann 2024: 72 ms for a 7 mm motor; spread: scatter of published motors'

MOTOR_LAG = ActuatorEffect(
    'motor_lag',
    declare_each(('up', 'down'), 's', 0.0, 1e-3, 10.0, 0.03, _MOTOR_LAG_SOURCE),
    (),
    motor_lag,
    (('duty', 0.0),),
    motor_lag_rate,
    check_motor_lag,
)


def thrust_polynomial(p: Values, memory: Values, value: float, surroundings: Values) -> float:
    """
    Thrust by the mean voltage of a motor, a cubic as in the firmware of the Crazyflie.

        v = voltage |u|,   w = max(v, linear_to)
        T = sign(u) max(0, c_0 + c_1 w + c_2 w^2 + c_3 w^3) v / w

    u is the duty, at the nominal `voltage` of the battery; with `battery_sag` before it and the
    same nominal voltage v is that of the present battery times the duty. The published cubics were
    fitted where a Crazyflie flies and miss the origin (T(0) = -25 mN, -15 mN or +7 mN), so below
    the voltage `linear_to` the thrust is proportional to v instead; at the thrust where the
    firmware itself stops using its cubic (12.8 mN) that gives 4.1 mN at 0.25 V for the 2.1+
    propellers, where the bench has 3.9 mN and the cubic nothing. `linear_to` of 0 only clips what
    is negative.

    Instead of `thrust_curve`, which passes newtons on at its null values; with a nominal voltage
    of 0 it passes the duty on to that. Reversed rotors push as hard as forward ones here.

    N per motor, crazyflie-firmware 2a18fc29, src/platform/interface/platform_defaults_cf2.h:

        propellers     c_0        c_1        c_2         c_3        linear_to, 12.8 (kit 19.2) mN
        2.1+        -0.024765   0.065238  -0.026793   0.0067768   0.774 V
        legacy      -0.014831   0.047245  -0.018474   0.0059609   0.753 V
        upgrade kit  0.0067281  0.0101156  0.0102632  0.0028359   0.679 V

    The 2.1+ and legacy cubics lie below the bench table of 2015 (four motors, cables with a
    resistance of their own) by 12 and 9 mN rms; the firmware's older parabola differs from it by 3
    mN, the cubic of the stronger upgrade kit by 39 mN. They are not two forms of one measurement:
    take the one whose motors and propellers are flown.
    """
    voltage, linear_to, c_0, c_1, c_2, c_3 = p
    # Effect off: the duty goes on to `thrust_curve`
    if voltage <= 0.0:
        return value
    mean = voltage * abs(value)
    # Below `linear_to` the thrust is proportional to the voltage
    at = max(mean, linear_to)
    # No voltage and no linear range: avoids 0 / 0
    if at <= 0.0:
        return 0.0
    # The published cubics are negative near the origin
    thrust = max(0.0, c_0 + at * (c_1 + at * (c_2 + at * c_3))) * (mean / at)
    return thrust if value > 0.0 else -thrust


def check_thrust_polynomial(values: Mapping[str, float]) -> str:
    """Return an objection to a cubic that cannot describe a motor, or ''."""
    has_polynomial = any(values[name] != 0.0 for name in ('linear_to', 'c_0', 'c_1', 'c_2', 'c_3'))
    if has_polynomial and values['voltage'] == 0.0:
        return (
            'set voltage to the nominal battery voltage, at which the duty is 1, or all other '
            'parameters to zero'
        )
    if values['voltage'] > 0.0 and values['c_0'] > 0.0 and values['linear_to'] == 0.0:
        return (
            'c_0 is positive, which would mean thrust without voltage; set linear_to to a '
            'positive voltage'
        )
    return ''


_THRUST_POLYNOMIAL_CUBIC = (
    'crazyflie-firmware 2a18fc29; spread: its three sets of propellers differ by 10 to 20 mN'
)
_START = (
    'voltage at which the cubic reaches the smallest thrust of the firmware: 0.7 to 0.8 V; '
    'spread assumed'
)

THRUST_POLYNOMIAL = ActuatorEffect(
    'thrust_polynomial',
    (
        EffectParameter('voltage', 'V', 0.0, 0.0, 60.0, 0.1, _NOMINAL),
        EffectParameter('linear_to', 'V', 0.0, 0.0, 10.0, 0.1, _START),
        EffectParameter('c_0', 'N', 0.0, -10.0, 10.0, 0.01, _THRUST_POLYNOMIAL_CUBIC),
        EffectParameter('c_1', 'N/V', 0.0, -10.0, 10.0, 0.02, _THRUST_POLYNOMIAL_CUBIC),
        EffectParameter('c_2', 'N/V2', 0.0, -10.0, 10.0, 0.01, _THRUST_POLYNOMIAL_CUBIC),
        EffectParameter('c_3', 'N/V3', 0.0, -10.0, 10.0, 0.003, _THRUST_POLYNOMIAL_CUBIC),
    ),
    (),
    thrust_polynomial,
    check=check_thrust_polynomial,
)


def thrust_curve(p: Values, memory: Values, duty: float, surroundings: Values) -> float:
    """
    Rotor thrust by duty.

        T = a u |u| + b u

    u is the duty at which the rotor turns, -1 to 1. The parabola is that of 7 mm brushed motors in
    the Crazyflie firmware (a = 0.0915 N, b = 0.0677 N), as an odd function for reversible rotors.
    At the null values, a = 0 and b = 1 N, a command is the thrust in newtons. Not modelled:
    inflow.
    """
    a, b = p
    # a u |u| + b u, an odd function
    return (a * abs(duty) + b) * duty


_THRUST_CURVE_SOURCE = (
    'bench tables of 7 mm motors deviate by 3 mN rms from the firmware curve; limit: 50 N'
)

THRUST_CURVE = ActuatorEffect(
    'thrust_curve',
    (),
    (
        EffectParameter('a', 'N', 0.0, -50.0, 50.0, 0.003, _THRUST_CURVE_SOURCE),
        EffectParameter('b', 'N', 1.0, -50.0, 50.0, 0.003, _THRUST_CURVE_SOURCE),
    ),
    thrust_curve,
)


def thrust_scale(p: Values, memory: Values, value: float, surroundings: Values) -> float:
    """
    One factor on the thrust of all rotors.

        T' = factor T

    It covers another batch of motors or another air density: at a given rotor speed thrust goes
    with the density, 6 % less at 600 m above the sea (standard atmosphere) or in air 20 K warmer
    (293 K / 313 K).
    """
    (factor,) = p
    return factor * value


_THRUST_SCALE_SOURCE = (
    'Bitcraze 2015: its bench data deviate by 3 mN rms (of up to 142 mN) from the firmware curve'
)

THRUST_SCALE = ActuatorEffect(
    'thrust_scale',
    (EffectParameter('factor', '1', 1.0, 0.0, 5.0, 0.03, _THRUST_SCALE_SOURCE),),
    (),
    thrust_scale,
)


def rotor_fault(p: Values, memory: Values, value: float, surroundings: Values) -> float:
    """
    Rotors that have lost part of their thrust.

        T_i' = (1 - lost_i) T_i

    A chipped propeller, a worn motor, a hair around the shaft; lost_i = 1 is a stopped rotor. Not
    modelled: vibration and the changed power of a damaged propeller.
    """
    (lost,) = p
    return (1.0 - lost) * value


_ROTOR_FAULT_SOURCE = (
    'limits: intact (0) and standing still (1); spread: two motors of one batch differ by 2 % '
    '(assumed)'
)

ROTOR_FAULT = ActuatorEffect(
    'rotor_fault',
    (),
    (EffectParameter('lost', '1', 0.0, 0.0, 1.0, 0.02, _ROTOR_FAULT_SOURCE),),
    rotor_fault,
)
