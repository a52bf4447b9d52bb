"""
Ballast that slides in its tray against a spring.

    F = size (f^2 d + 2 damping f (V - V_0)),   d' = V - V_0,   V' = -F / size

d is its horizontal displacement from the middle of the tray and V its velocity in the map; V_0 is
that of the tray, 0.4 m below the hull centre. Its weight is trimmed.
"""

from typing import Final

from lta_challenge.outside.shared.axes import horizontal_components, rotate_to_body
from lta_challenge.outside.shared.kind import OutsideKind
from lta_model.effects.protocol import EffectParameter, Values, VehicleMotion, Wrench, WrenchEffect

PARAMETERS: Final = (
    EffectParameter('size', 'kg', 0.0, 0.0, 1.0, 0.01, 'of a challenge'),
    EffectParameter('f', 'rad/s', 0.0, 0.0, 50.0, 3.0, 'of a challenge'),
    EffectParameter('damping', '1', 0.0, 0.0, 1.0, 0.1, 'of a challenge'),
)
DEEP: Final = 0.4  # m; of the tray below the hull centre


def ballast_force(
    p: Values, memory: Values, motion: VehicleMotion
) -> tuple[float, float, float, float]:
    """Return the force on the tray and its velocity, in the map."""
    size, f, damping = p
    r, v, w = motion.rotation, motion.velocity, motion.rates
    # Velocity of the tray: v + w x (0, 0, -DEEP)
    a, b, c = v[0] - DEEP * w[1], v[1] + DEEP * w[0], v[2]
    east, north = horizontal_components(r, a, b, c)
    x = size * (f * f * memory[0] + 2.0 * damping * f * (memory[2] - east))
    y = size * (f * f * memory[1] + 2.0 * damping * f * (memory[3] - north))
    return (x, y, east, north)


def wrench(p: Values, memory: Values, motion: VehicleMotion, thrust: Values) -> Wrench:
    """Return the wrench of the ballast."""
    size, f, damping = p
    x, y, _, _ = ballast_force((size, f, damping), memory, motion)
    a, b, c = rotate_to_body(motion.rotation, x, y, 0.0)
    return (a, b, c, DEEP * b, -DEEP * a, 0.0)


def rate(p: Values, memory: Values, motion: VehicleMotion) -> Values:
    """Return the rates of displacement and velocity."""
    size, f, damping = p
    x, y, east, north = ballast_force((size, f, damping), memory, motion)
    # The null value of the mass is 0
    heavy = max(size, 1e-9)
    return (memory[2] - east, memory[3] - north, -x / heavy, -y / heavy)


KIND: Final = OutsideKind(
    WrenchEffect(
        'sloshing',
        PARAMETERS,
        wrench,
        memory=(('x', 0.0), ('y', 0.0), ('u', 0.0), ('v', 0.0)),
        rate=rate,
    ),
    'ballast that slides in its tray against a spring',
    {'size': (0.01, 0.03), 'f': (2.0, 6.0), 'damping': (0.03, 0.15)},
)
