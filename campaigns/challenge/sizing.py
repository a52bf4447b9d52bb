"""Draw and scale the strength of disturbances outside the library."""

from collections.abc import Mapping
import math
from typing import Final

import numpy as np

from campaigns.challenge.flight import Array
from campaigns.challenge.unlisted import UNLISTED

Draw = np.random.Generator

# Noise floor of a wrench [N], [N m]: smaller disturbances are not detectable
FLOORS: Final = (4e-4, 4e-4, 4e-4, 8e-5, 8e-5, 4e-5)


# Parameters that are integers
WHOLE: Final = ('rotor', 'waves')


def draw_unlisted(draw: Draw) -> tuple[str, dict[str, float]]:
    """Draw a kind and its parameters."""
    name = str(draw.choice(sorted(UNLISTED)))
    numbers = {key: span.draw_value(draw) for key, span in UNLISTED[name].numbers.items()}
    for key in WHOLE:
        if key in numbers:
            # Ranges end above the largest integer, so all integers are equally likely
            numbers[key] = float(math.floor(numbers[key]))
    return name, numbers


def scale_unlisted(name: str, numbers: Mapping[str, float], factor: float) -> dict[str, float]:
    """Scale the size of a kind within its range."""
    span = UNLISTED[name].numbers['size']
    size = min(max(numbers['size'] * factor, span.least), span.most)
    return {**numbers, 'size': size}


def wrench_strength(*flights: Array) -> float:
    """
    Return the largest standard deviation of a wrench over its axes, in noise floors.

    Root mean square of flights, each of shape (n, 6).
    """
    variances = [np.var(wrench, axis=0) for wrench in flights]
    return float(np.max(np.sqrt(np.mean(variances, axis=0)) / np.array(FLOORS)))
