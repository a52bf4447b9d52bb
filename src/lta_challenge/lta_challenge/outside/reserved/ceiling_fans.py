"""
Fans below the ceiling of a hall: swirling air that sinks below each.

    F_h = 2 size c e_up x d / (c^2 + |d|^2),   F_z = -size exp(-|d|^2 / c^2)

in the map; d is the horizontal displacement from the fan and c its core radius, where the swirl is
strongest (vortex of Kaufmann and Scully; a round jet is about Gaussian). There is a fan every 5 m:
d = sin(k x) / k in each direction and |d|^2 = 2 (2 - cos k x - cos k y) / k^2, k = 2 pi / 5 m,
which close to a fan are the distance from it.
"""

import math
from typing import Final

from lta_challenge.outside.shared.axes import rotate_to_body
from lta_challenge.outside.shared.kind import OutsideKind
from lta_model.effects.protocol import EffectParameter, Values, VehicleMotion, Wrench, WrenchEffect

PARAMETERS: Final = (
    EffectParameter('size', 'N', 0.0, 0.0, 0.02, 0.005, 'of a challenge'),
    EffectParameter('core', 'm', 0.0, 0.0, 20.0, 0.5, 'of a challenge'),
    EffectParameter('east', 'm', 0.0, -20.0, 20.0, 1.0, 'of a challenge'),
    EffectParameter('north', 'm', 0.0, -20.0, 20.0, 1.0, 'of a challenge'),
)
APART: Final = 5.0  # m; distance between fans


def wrench(p: Values, memory: Values, motion: VehicleMotion, thrust: Values) -> Wrench:
    """Return the force of the moving air."""
    size, core, east, north = p
    k, c = 2.0 * math.pi / APART, max(core, 0.1)
    x, y = k * (motion.position[0] - east), k * (motion.position[1] - north)
    far = 2.0 * (2.0 - math.cos(x) - math.cos(y)) / (k * k)
    swirl = 2.0 * size * c / (c * c + far) / k
    sink = -size * math.exp(-far / (c * c))
    f, g, h = rotate_to_body(motion.rotation, -swirl * math.sin(y), swirl * math.sin(x), sink)
    return (f, g, h, 0.0, 0.0, 0.0)


KIND: Final = OutsideKind(
    WrenchEffect('ceiling_fans', PARAMETERS, wrench),
    'swirling air below the fans of a hall',
    {'size': (0.003, 0.012), 'core': (0.5, 1.0), 'east': (-2.0, 2.0), 'north': (-2.0, 2.0)},
    late=True,
)
