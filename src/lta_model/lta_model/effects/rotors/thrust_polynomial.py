"""
Thrust by the mean voltage of a motor, a cubic as in the firmware of the Crazyflie.

    v = voltage |u|,   w = max(v, linear_to)
    T = sign(u) max(0, c_0 + c_1 w + c_2 w^2 + c_3 w^3) v / w

u is the duty, at the nominal `voltage` of the battery; with `battery_sag` before it and the same
nominal voltage v is that of the present battery times the duty. The published cubics were fitted
where a Crazyflie flies and miss the origin (T(0) = -25 mN, -15 mN or +7 mN), so below the voltage
`linear_to` the thrust is proportional to v instead; at the thrust where the firmware itself stops
using its cubic (12.8 mN) that gives 4.1 mN at 0.25 V for the 2.1+ propellers, where the bench has
3.9 mN and the cubic nothing. `linear_to` of 0 only clips what is negative.

Instead of `thrust_curve`, which passes newtons on at its null values; with a nominal voltage of 0
it passes the duty on to that. Reversed rotors push as hard as forward ones here.

N per motor, crazyflie-firmware 2a18fc29, src/platform/interface/platform_defaults_cf2.h:

    propellers     c_0        c_1        c_2         c_3         linear_to for 12.8 (kit 19.2) mN
    2.1+        -0.024765   0.065238  -0.026793   0.0067768   0.774 V
    legacy      -0.014831   0.047245  -0.018474   0.0059609   0.753 V
    upgrade kit  0.0067281  0.0101156  0.0102632  0.0028359   0.679 V

The 2.1+ and legacy cubics lie below the bench table of 2015 (four motors, cables with a resistance
of their own) by 12 and 9 mN rms; the firmware's older parabola differs from it by 3 mN, the cubic
of the stronger upgrade kit by 39 mN. They are not two forms of one measurement: take the one whose
motors and propellers are flown.
"""

from collections.abc import Mapping

from lta_model.effects.protocol import ActuatorEffect, EffectParameter, Values

_NOMINAL = (
    'a lithium cell has 3.0 to 4.2 V (Crazyflie firmware: critical at 3.0 V); limit: 14 cells'
)
_CUBIC = 'crazyflie-firmware 2a18fc29; spread: its three sets of propellers differ by 10 to 20 mN'
_START = (
    'voltage at which the cubic reaches the smallest thrust of the firmware: 0.7 to 0.8 V; '
    'spread assumed'
)

SHARED = (
    EffectParameter('voltage', 'V', 0.0, 0.0, 60.0, 0.1, _NOMINAL),
    EffectParameter('linear_to', 'V', 0.0, 0.0, 10.0, 0.1, _START),
    EffectParameter('c_0', 'N', 0.0, -10.0, 10.0, 0.01, _CUBIC),
    EffectParameter('c_1', 'N/V', 0.0, -10.0, 10.0, 0.02, _CUBIC),
    EffectParameter('c_2', 'N/V2', 0.0, -10.0, 10.0, 0.01, _CUBIC),
    EffectParameter('c_3', 'N/V3', 0.0, -10.0, 10.0, 0.003, _CUBIC),
)


def compute_output(p: Values, memory: Values, value: float, surroundings: Values) -> float:
    """Return the thrust at a duty. [N]"""
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


def find_conflict(values: Mapping[str, float]) -> str:
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


EFFECT = ActuatorEffect('thrust_polynomial', SHARED, (), compute_output, check=find_conflict)
