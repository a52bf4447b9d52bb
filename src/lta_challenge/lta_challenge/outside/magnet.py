"""
A magnet aboard, which the field of the room turns to one side.

    N_z = -size sin(heading - north)
"""

import math
from typing import Final

from lta_challenge.outside.shared.kind import Outside
from lta_model.effects.protocol import Motion, Parameter, Values, Wrench, WrenchEffect

PARAMETERS: Final = (
    Parameter('size', 'N m', 0.0, 0.0, 1.0, 0.001, 'of a challenge'),
    Parameter('north', 'rad', 0.0, -4.0, 4.0, 1.0, 'of a challenge'),
)


def wrench(p: Values, memory: Values, motion: Motion, thrust: Values) -> Wrench:
    """Return the moment of the magnet."""
    size, north = p
    heading = math.atan2(motion.rotation[3], motion.rotation[0])
    return (0.0, 0.0, 0.0, 0.0, 0.0, -size * math.sin(heading - north))


KIND: Final = Outside(
    WrenchEffect('magnet', PARAMETERS, wrench),
    'a magnet aboard',
    {'size': (0.0005, 0.002), 'north': (-3.1, 3.1)},
)
