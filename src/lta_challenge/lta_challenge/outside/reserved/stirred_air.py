"""
Air of a small room that the jets of the forward rotors set in motion.

    F = -size a,   a' = (R e_x (d_3^2 + d_4^2) / 2 - a) / settles   for both horizontal components

in the map; d_3 and d_4 are the duties, and thrust grows with about their square. A jet keeps its
momentum, which is the thrust, while it draws in the air of the room (turbulent jet; Pope,
Turbulent Flows, section 5.1); the walls take it up within `settles`. The air moves against the
thrust and keeps its direction when the vehicle turns. size is the drag in the air that both rotors
stir at full duty.
"""

from typing import Final

from lta_challenge.outside.shared.axes import rotate_to_body
from lta_challenge.outside.shared.kind import OutsideKind
from lta_model.effects.protocol import EffectParameter, Values, VehicleMotion, Wrench, WrenchEffect

PARAMETERS: Final = (
    EffectParameter('size', 'N', 0.0, 0.0, 1.0, 0.05, 'of a challenge'),
    EffectParameter('settles', 's', 0.0, 0.0, 1e4, 10.0, 'of a challenge'),
)


def wrench(p: Values, memory: Values, motion: VehicleMotion, thrust: Values) -> Wrench:
    """Return the drag in the stirred air."""
    size, settles = p  # noqa: RUF059 (the kernel knows parameters by their order)
    x, y, z = rotate_to_body(motion.rotation, -size * memory[0], -size * memory[1], 0.0)
    return (x, y, z, 0.0, 0.0, 0.0)


def rate(p: Values, memory: Values, motion: VehicleMotion) -> Values:
    """Return the rates of the stirred air."""
    size, settles = p  # noqa: RUF059
    r, d = motion.rotation, motion.command
    jet = 0.5 * (d[2] * d[2] + d[3] * d[3])
    # The limit avoids a division by the null value of 0
    takes = max(settles, 0.5)
    return ((r[0] * jet - memory[0]) / takes, (r[3] * jet - memory[1]) / takes)


KIND: Final = OutsideKind(
    WrenchEffect('stirred_air', PARAMETERS, wrench, memory=(('x', 0.0), ('y', 0.0)), rate=rate),
    'air of the room that the rotors set in motion',
    {'size': (0.03, 0.1), 'settles': (5.0, 20.0)},
    late=True,
)
