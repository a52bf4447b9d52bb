"""
Rotor axes that deviate from the vehicle file.

The thrust axis a of a rotor turns by two small angles about two axes perpendicular to it,

    theta = first e_1 + second e_2,   dF = T (theta x a),   dM = r x dF

with r the place of the rotor in the body. e_1 is along h x a and e_2 = a x e_1, where h is the
body's z, or its y for a rotor within 45 degrees of the vertical. An upward rotor has e_1 = x,
e_2 = y; a forward one e_1 = y, e_2 = z (first > 0 tilts it down, second > 0 turns it left). dF
adds to B T; the effect of the turned jet on the hull is not modelled.

Linear in the angles, as identification needs it, and without sines. Compared with the exact
rotation the force errs by T theta^2 / 2 along the axis and T |theta|^3 / 6 across it. The bounds
of 0.2 rad (11 degrees) keep that within 2 % and 0.14 % of the thrust for one angle, 4 % and 0.4 %
for both; correct larger deviations in the vehicle file.
"""

import math

from lta_model.effects.protocol import EffectParameter, Values, VehicleMotion, Wrench, WrenchEffect
from lta_model.state import ACTUATORS, ROTOR, ROTOR_PLACE

_SOURCE = 'spread (assumed): half a degree of error on a printed or glued frame'
_NAMES = tuple(f'{turn}_{i}' for turn in ('first', 'second') for i in range(1, ACTUATORS + 1))

PARAMETERS = tuple(EffectParameter(name, 'rad', 0.0, -0.2, 0.2, 0.009, _SOURCE) for name in _NAMES)


def tilt_wrench(first: float, second: float, thrust: float, body: Values, o: int) -> Wrench:
    """Return the additional wrench of one tilted rotor, whose numbers begin at o of the body."""
    # Single numbers, because a slice of the body would be copied, at the cost of everything else.
    x, y, z = body[o], body[o + 1], body[o + 2]
    a, b, c = body[o + 3], body[o + 4], body[o + 5]
    # h x a, not yet of length one: z x a, or y x a near the vertical.
    # Within 45 degrees of the vertical, z x a would be short and ill-defined
    upright = c * c > 0.5
    e = c if upright else -b
    f = 0.0 if upright else a
    g = -a if upright else 0.0
    length = math.sqrt(e * e + f * f + g * g)
    # Length 0: a rotor that does not exist
    scale = thrust / length if length > 0.0 else 0.0
    # e_1 x a = -e_2 and e_2 x a = e_1, so theta x a = second e_1 - first e_2.
    f_x = scale * (second * e - first * (b * g - c * f))
    f_y = scale * (second * f - first * (c * e - a * g))
    f_z = scale * (second * g - first * (a * f - b * e))
    return (f_x, f_y, f_z, y * f_z - z * f_y, z * f_x - x * f_z, x * f_y - y * f_x)


def add_wrenches(a: Wrench, b: Wrench) -> Wrench:
    """Return the sum of two wrenches."""
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2], a[3] + b[3], a[4] + b[4], a[5] + b[5])


def compute_wrench(p: Values, memory: Values, motion: VehicleMotion, thrust: Values) -> Wrench:
    """Return the additional wrench of all tilted rotors."""
    (
        first_1, first_2, first_3, first_4, first_5, first_6, first_7, first_8,
        second_1, second_2, second_3, second_4, second_5, second_6, second_7, second_8,
    ) = p  # fmt: skip
    body = motion.body
    front = add_wrenches(
        add_wrenches(
            tilt_wrench(first_1, second_1, thrust[0], body, ROTOR_PLACE),
            tilt_wrench(first_2, second_2, thrust[1], body, ROTOR_PLACE + ROTOR),
        ),
        add_wrenches(
            tilt_wrench(first_3, second_3, thrust[2], body, ROTOR_PLACE + 2 * ROTOR),
            tilt_wrench(first_4, second_4, thrust[3], body, ROTOR_PLACE + 3 * ROTOR),
        ),
    )
    back = add_wrenches(
        add_wrenches(
            tilt_wrench(first_5, second_5, thrust[4], body, ROTOR_PLACE + 4 * ROTOR),
            tilt_wrench(first_6, second_6, thrust[5], body, ROTOR_PLACE + 5 * ROTOR),
        ),
        add_wrenches(
            tilt_wrench(first_7, second_7, thrust[6], body, ROTOR_PLACE + 6 * ROTOR),
            tilt_wrench(first_8, second_8, thrust[7], body, ROTOR_PLACE + 7 * ROTOR),
        ),
    )
    return add_wrenches(front, back)


EFFECT = WrenchEffect('rotor_misalignment', PARAMETERS, compute_wrench, _NAMES)
