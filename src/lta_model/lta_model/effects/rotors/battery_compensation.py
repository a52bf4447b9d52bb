"""
Firmware that corrects the duty for the battery voltage.

    u' = min(1, v / V),   v from   c_0 + c_1 v + c_2 v^2 + c_3 v^3 = full u

The commanded duty u is a share of the thrust `full`. The firmware inverts the cubic to get the
mean motor voltage v for this thrust, and divides by the battery voltage V. u' is 0 where full u is
below `least`, where V is below 2 V (a broken battery to the firmware), and for a negative u, which
this firmware cannot drive. V is the voltage under load from the surroundings; where that is
unknown (0), the nominal `voltage`. A nominal voltage of 0 switches the effect off.

It is the first actuator effect, as in the firmware. With the same nominal voltage in `battery_sag`
and `thrust_polynomial` and the same cubic, the thrust is full u at any voltage until u' reaches 1.
Not modelled: the 0.1 s low pass on V and the 16 bits of the PWM.

Firmware for the Crazyflie 2 platform, 2026.08, built with CONFIG_ENABLE_THRUST_BAT_COMPENSATED
(the default): motorsCompensateBatteryVoltage in src/drivers/src/motors.c, batteryCompensation in
src/modules/src/stabilizer.c, numbers in src/platform/interface/platform_defaults_cf2.h, N per
motor (cubics to more digits there; the same as in `thrust_polynomial`):

    propellers     full    least     c_0        c_1        c_2         c_3
    2.1+           0.12   0.012818  -0.024765   0.065238  -0.026793   0.0067768
    legacy         0.12   0.012818  -0.014831   0.047245  -0.018474   0.0059609
    upgrade kit    0.18   0.019226   0.0067281  0.0101156  0.0102632  0.0028359

The firmware solves the cubic in closed form. Here Newton's method avoids the cube root, so that
all implementations of the model agree to the last bit.
"""

from collections.abc import Mapping

from lta_model.effects.protocol import ActuatorEffect, EffectParameter, Values
from lta_model.state import VOLTAGE

_NOMINAL = (
    'a lithium cell has 3.0 to 4.2 V (Crazyflie firmware: critical at 3.0 V); limit: 14 cells'
)
_THRUST = 'crazyflie-firmware 54f31e24: 0.12 N, upgrade kit 0.18 N; limit as for thrust_curve'
_LEAST = 'crazyflie-firmware 54f31e24: 0.0128 N, upgrade kit 0.0192 N; limit as for thrust_curve'
_CUBIC = 'crazyflie-firmware 54f31e24; spread: its three sets of propellers differ by 10 to 20 mN'
BROKEN = 2.0  # V: below it the firmware stops the motors
NEWTON = 24  # steps; from 60 V down to 1 V takes 17
FLAT = 1e-9  # N/V: less slope than any motor has, against a division by zero

SHARED = (
    EffectParameter('voltage', 'V', 0.0, BROKEN, 60.0, 0.1, _NOMINAL),
    EffectParameter('full', 'N', 0.0, 0.0, 50.0, 0.01, _THRUST),
    EffectParameter('least', 'N', 0.0, 0.0, 50.0, 0.003, _LEAST),
    EffectParameter('c_0', 'N', 0.0, -10.0, 10.0, 0.01, _CUBIC),
    EffectParameter('c_1', 'N/V', 0.0, 0.0, 10.0, 0.02, _CUBIC),
    EffectParameter('c_2', 'N/V2', 0.0, -10.0, 10.0, 0.01, _CUBIC),
    EffectParameter('c_3', 'N/V3', 0.0, 0.0, 10.0, 0.003, _CUBIC),
)


def compute_output(p: Values, memory: Values, value: float, surroundings: Values) -> float:
    """Return the duty that the firmware applies to a motor."""
    voltage, full, least, c_0, c_1, c_2, c_3 = p
    if voltage <= 0.0:
        return value
    # 0 means that the voltage is unknown
    supply = surroundings[VOLTAGE] if surroundings[VOLTAGE] > 0.0 else voltage
    thrust = full * value
    # As in the firmware: nothing below the least thrust, and none in reverse
    if supply < BROKEN or thrust < least or thrust <= 0.0:
        return 0.0
    # Even the full battery voltage does not reach the thrust
    if c_0 + supply * (c_1 + supply * (c_2 + supply * c_3)) <= thrust:
        return 1.0
    # Newton's method starts at the supply voltage, right of the root
    mean = supply
    for _ in range(NEWTON):
        excess = c_0 + mean * (c_1 + mean * (c_2 + mean * c_3)) - thrust
        slope = c_1 + mean * (2.0 * c_2 + mean * (3.0 * c_3))
        # Clipped to 0 and the supply, where the root is known to be
        mean = min(max(mean - excess / max(slope, FLAT), 0.0), supply)
    return mean / supply


def find_conflict(values: Mapping[str, float]) -> str:
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


EFFECT = ActuatorEffect('battery_compensation', SHARED, (), compute_output, check=find_conflict)
