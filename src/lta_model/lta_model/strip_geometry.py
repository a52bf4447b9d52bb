"""
Compute the strips of `strip_damping` from the boxes of a vehicle's frame and panels.

A slim box is one strip along its longest side. A box whose second side is more than half of the
longest is two strips, at the two Gauss points across it (b / sqrt(12) either side of the middle),
each with half of the drag, so a panel is also damped about its long axis. The third side only adds
area.

    D_x = rho C_D (size_y size_z) / 2,   and so on

C_D is 1.17 for a square plate across the flow, 1.98 for a long one (Aeronautical Engineer's Data
Book, figure 5.13(b)). For a box drawn around an open frame, reduce C_D by the solid share.
"""

from collections.abc import Sequence
from dataclasses import dataclass
import math
from typing import final

from lta_config.errors import BadInput
from lta_model.effects.drag import STRIP_DAMPING, STRIPS
from lta_model.effects.protocol import Vector

# Drag coefficient; same source as in the module docstring
SQUARE_PLATE = 1.17


@final
@dataclass(frozen=True, slots=True)
class DragBox:
    """A part in the flow, its sides along the body axes."""

    # Centre from the hull centre, and full lengths of the sides, body frame [m]
    place: Vector
    size: Vector
    coefficient: float = SQUARE_PLATE  # drag coefficient on the area of each side [1]


def _split_box(box: DragBox, density: float) -> list[tuple[float, ...]]:
    """Return the strips of a box, each in the order of the parameters of a strip."""
    x, y, z = box.size
    short, across, along = sorted(range(3), key=lambda axis: box.size[axis])
    del short
    wide = box.size[across] > 0.5 * box.size[along]
    # Gauss points of a uniform width: the same second moment of area
    offset = box.size[across] / math.sqrt(12.0)
    half = [0.0, 0.0, 0.0]
    half[along] = 0.5 * box.size[along]
    sides = (-1.0, 1.0) if wide else (0.0,)
    scale = 0.5 * density * box.coefficient / len(sides)
    strips = []
    for side in sides:
        centre = list(box.place)
        centre[across] += side * offset
        strips.append((*centre, *half, scale * y * z, scale * x * z, scale * x * y))
    return strips


def build_strips(boxes: Sequence[DragBox], density: float) -> dict[str, float]:
    """
    Return all parameters of `strip_damping` for boxes (not the hull), unused strips at zero.

    Raise `BadInput` if they need more strips than the effect has.
    """
    strips = [strip for box in boxes for strip in _split_box(box, density)]
    if len(strips) > STRIPS:
        raise BadInput(
            f'The {len(boxes)} parts with drag need {len(strips)} strips for their rotational '
            f'damping (a wide part needs two), but the model has only {STRIPS}; in the vehicle '
            'file, remove drag from some parts, or combine several into one box.'
        )
    # The first parameter is `translation`, 0
    numbers = [0.0, *(number for strip in strips for number in strip)]
    # Unused strips
    numbers += [0.0] * (len(STRIP_DAMPING.parameters) - len(numbers))
    names = (parameter.name for parameter in STRIP_DAMPING.parameters)
    return dict(zip(names, numbers, strict=True))
