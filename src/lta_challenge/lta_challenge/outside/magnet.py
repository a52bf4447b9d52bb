"""
A magnet on board, on which the magnetic field of the room exerts a yaw moment.

    N_z = -size sin(heading - north)
"""

import math
from typing import Final

from lta_challenge.outside.shared.kind import OutsideKind
from lta_model.effects.protocol import EffectParameter, Values, VehicleMotion, Wrench, WrenchEffect

PARAMETERS: Final = (
    EffectParameter('size', 'N m', 0.0, 0.0, 1.0, 0.001, 'of a challenge'),
    EffectParameter('north', 'rad', 0.0, -4.0, 4.0, 1.0, 'of a challenge'),
)


def wrench(p: Values, memory: Values, motion: VehicleMotion, thrust: Values) -> Wrench:
    """Return the moment of the magnet."""
    size, north = p
    # First column of R: body x axis in the map
    heading = math.atan2(motion.rotation[3], motion.rotation[0])
    return (0.0, 0.0, 0.0, 0.0, 0.0, -size * math.sin(heading - north))


KIND: Final = OutsideKind(
    WrenchEffect('magnet', PARAMETERS, wrench),
    'a magnet on board, turned by the magnetic field of the room',
    {'size': (0.0005, 0.002), 'north': (-3.1, 3.1)},
)
