"""Draw and scale the strength of disturbances outside the library."""

from collections.abc import Mapping
import math
from typing import Final

from lta_challenge.other.flight import Array
from lta_challenge.other.unlisted import UNLISTED
import numpy as np

Draw = np.random.Generator

# Below which a wrench does not matter. [N], [N m]
FLOORS: Final = (4e-4, 4e-4, 4e-4, 8e-5, 8e-5, 4e-5)


# Numbers that are whole.
WHOLE: Final = ('rotor', 'waves')


def draw_unlisted(draw: Draw) -> tuple[str, dict[str, float]]:
    """Return a kind and its numbers."""
    name = str(draw.choice(sorted(UNLISTED)))
    numbers = {key: span.draw_value(draw) for key, span in UNLISTED[name].numbers.items()}
    for key in WHOLE:
        if key in numbers:
            numbers[key] = float(math.floor(numbers[key]))
    return name, numbers


def scale_unlisted(name: str, numbers: Mapping[str, float], factor: float) -> dict[str, float]:
    """Return a kind with another size, within what there can be of it."""
    span = UNLISTED[name].numbers['size']
    size = min(max(numbers['size'] * factor, span.least), span.most)
    return {**numbers, 'size': size}


def wrench_strength(wrench: Array) -> float:
    """Return how many floors a wrench comes to on its strongest axis, without its mean."""
    return float(np.max(np.std(wrench, axis=0) / np.array(FLOORS)))
