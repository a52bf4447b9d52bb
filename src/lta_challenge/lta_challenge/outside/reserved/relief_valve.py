"""
A gas cell whose relief valve opens above a height: lift that is lost for good.

    F = -size g e_z,   g' = (1 - g) max(0, z - opens) / empties

The outside pressure falls by 12 Pa per metre, so a cell that is full at the height `opens` has a
pressure proportional to the excess of height; gas flows out in proportion (laminar valve), and to
what is left of the cell. g is the share that is lost and size the lift of the full cell.
"""

from typing import Final

from lta_challenge.outside.shared.axes import rotate_to_body
from lta_challenge.outside.shared.kind import OutsideKind
from lta_model.effects.protocol import EffectParameter, Values, VehicleMotion, Wrench, WrenchEffect

PARAMETERS: Final = (
    EffectParameter('size', 'N', 0.0, 0.0, 0.06, 0.01, 'of a challenge'),
    EffectParameter('opens', 'm', 0.0, 0.0, 100.0, 0.5, 'of a challenge'),
    EffectParameter('empties', 'm s', 0.0, 0.0, 1e4, 10.0, 'of a challenge'),
)


def wrench(p: Values, memory: Values, motion: VehicleMotion, thrust: Values) -> Wrench:
    """Return the lost lift."""
    size, opens, empties = p  # noqa: RUF059 (the kernel knows parameters by their order)
    x, y, z = rotate_to_body(motion.rotation, 0.0, 0.0, -size * memory[0])
    return (x, y, z, 0.0, 0.0, 0.0)


def rate(p: Values, memory: Values, motion: VehicleMotion) -> Values:
    """Return the rate of the loss."""
    size, opens, empties = p  # noqa: RUF059
    # The limit avoids a division by the null value of 0
    return ((1.0 - memory[0]) * max(0.0, motion.position[2] - opens) / max(empties, 0.1),)


KIND: Final = OutsideKind(
    WrenchEffect('relief_valve', PARAMETERS, wrench, memory=(('lost', 0.0),), rate=rate),
    'a gas cell that vents above a height',
    {'size': (0.01, 0.04), 'opens': (1.1, 1.5), 'empties': (3.0, 15.0)},
    late=True,
)
