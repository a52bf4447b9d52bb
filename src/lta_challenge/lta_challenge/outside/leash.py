"""
A leash on a reel: slack near its stand, and pulled by the reel's spring beyond its length.

    F = -size (1 - exp(-(d - length) / 0.1 m)) (1 + 0.3 tanh(d' / 0.05 m/s)) e   where d > length

at the gondola; d is its distance from the stand on the floor and e the direction. By friction, the
reel pulls harder while it pays out line than while it takes it in.
"""

import math
from typing import Final

from lta_challenge.outside.shared.axes import rotate_to_body
from lta_challenge.outside.shared.kind import OutsideKind
from lta_model.effects.protocol import EffectParameter, Values, VehicleMotion, Wrench, WrenchEffect

PARAMETERS: Final = (
    EffectParameter('size', 'N', 0.0, 0.0, 0.1, 0.01, 'of a challenge'),
    EffectParameter('length', 'm', 0.0, 0.0, 20.0, 1.0, 'of a challenge'),
    EffectParameter('east', 'm', 0.0, -20.0, 20.0, 0.5, 'of a challenge'),
    EffectParameter('north', 'm', 0.0, -20.0, 20.0, 0.5, 'of a challenge'),
)
DEEP: Final = 0.4  # m; of the gondola below the hull centre
GIVES: Final = 0.1  # m; over which the line comes taut
RUBS: Final = 0.3  # friction relative to the pull
SLOW: Final = 0.05  # m/s; smooths the change of sign of the friction


def wrench(p: Values, memory: Values, motion: VehicleMotion, thrust: Values) -> Wrench:
    """Return the pull of the leash."""
    size, length, east, north = p
    r, v, w = motion.rotation, motion.velocity, motion.rates
    # Vector from the stand to the gondola in the map
    x = motion.position[0] - DEEP * r[2] - east
    y = motion.position[1] - DEEP * r[5] - north
    z = motion.position[2] - DEEP * r[8]
    far = math.sqrt(x * x + y * y + z * z)
    if far <= length or far <= 0.0:
        return (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    # Direction in body axes, the axes of the gondola's velocity
    a, b, c = rotate_to_body(r, x / far, y / far, z / far)
    # Speed at which line is paid out: v + w x r along the direction
    out = a * (v[0] - DEEP * w[1]) + b * (v[1] + DEEP * w[0]) + c * v[2]
    pull = size * (1.0 - math.exp((length - far) / GIVES)) * (1.0 + RUBS * math.tanh(out / SLOW))
    # The force acts DEEP below the hull centre, hence the moments
    return (-pull * a, -pull * b, -pull * c, -DEEP * pull * b, DEEP * pull * a, 0.0)


KIND: Final = OutsideKind(
    WrenchEffect('leash', PARAMETERS, wrench),
    'a leash on a reel that pulls when it is taut',
    {'size': (0.005, 0.02), 'length': (0.9, 1.5), 'east': (-0.6, 0.6), 'north': (-0.6, 0.6)},
    late=True,
)
