"""
A tail fin that stalls beyond an angle of the flow.

    F_y = -size V^2 c,   N_z = 0.4 m size V^2 c
    c = (1 - s) 1.6 b + 2 s sin b |sin b|,   s = 1 / (1 + exp(-20 (|b| - stall)))

at the fin, 0.4 m behind the hull centre; V is its horizontal speed through the air and b the angle
of the flow from ahead. Attached flow with the slope of a fin of aspect ratio 1 (pi / 2), blended
into a flat plate (Beard and McLain, Small Unmanned Aircraft, section 4.2.1). size is half the air
density times the area: 6 g/m is 0.01 m2.
"""

import math
from typing import Final

from lta_challenge.outside.shared.kind import OutsideKind
from lta_model.effects.protocol import EffectParameter, Values, VehicleMotion, Wrench, WrenchEffect

PARAMETERS: Final = (
    EffectParameter('size', 'N s2/m2', 0.0, 0.0, 0.2, 0.01, 'of a challenge'),
    EffectParameter('stall', 'rad', 0.0, 0.0, 3.0, 0.1, 'of a challenge'),
)
BEHIND: Final = 0.4  # m; of the fin from the hull centre
SLOPE: Final = 1.6  # per rad; attached flow
SHARP: Final = 20.0  # per rad; of the stall


def wrench(p: Values, memory: Values, motion: VehicleMotion, thrust: Values) -> Wrench:
    """Return force and moment of the fin."""
    size, stall = p
    ahead, across = motion.airspeed[0], motion.airspeed[1] - BEHIND * motion.rates[2]
    angle = math.atan2(across, ahead)
    stalled = 1.0 / (1.0 + math.exp(SHARP * (stall - abs(angle))))
    plate = 2.0 * math.sin(angle) * abs(math.sin(angle))
    slope = (1.0 - stalled) * SLOPE * angle + stalled * plate
    force = -size * (ahead * ahead + across * across) * slope
    return (0.0, force, 0.0, 0.0, 0.0, -BEHIND * force)


KIND: Final = OutsideKind(
    WrenchEffect('fin_stall', PARAMETERS, wrench),
    'a tail fin that stalls',
    {'size': (0.003, 0.015), 'stall': (0.2, 0.5)},
    late=True,
)
