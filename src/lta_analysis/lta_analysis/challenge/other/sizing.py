"""How strong something is that is in no library, and how it is drawn and scaled."""

from collections.abc import Mapping
import math
from typing import Final, final, NamedTuple

from lta_analysis.challenge.other.flight import Array
from lta_analysis.challenge.other.unlisted import UNLISTED
import numpy as np

Draw = np.random.Generator

# Below which a wrench does not matter. [N], [N m]
FLOORS: Final = (4e-4, 4e-4, 4e-4, 8e-5, 8e-5, 4e-5)


@final
class Range(NamedTuple):
    """Between which a number is drawn, by its logarithm where it says so."""

    least: float
    most: float
    logarithmic: bool = False

    def drawn(self, draw: Draw) -> float:
        """Draw it."""
        if self.logarithmic:
            return float(self.least * (self.most / self.least) ** draw.random())
        return float(draw.uniform(self.least, self.most))


ROUND: Final = Range(-math.pi, math.pi)
# Of each kind: numbers, and the bounds of its size.
NUMBERS: Final[Mapping[str, Mapping[str, Range]]] = {
    'other_pendulum': {
        'size': Range(2e-3, 0.04, True), 'length': Range(0.25, 0.6), 'depth': Range(0.38, 0.42),
        'damping': Range(0.05, 0.4),
    },
    'other_sticking_rotor': {'size': Range(0.01, 0.3, True), 'rotor': Range(0.0, 4.0)},
    'other_skewed_drag': {
        'size': Range(5e-3, 0.4, True), 'angle': ROUND, 'rise': Range(-0.5, 0.5),
    },
    'other_cross_wind': {
        'size': Range(5e-3, 0.3, True), 'frequency': Range(0.1, 0.4, True), 'way': ROUND,
        'phase': ROUND,
    },
    'other_tether': {
        'size': Range(1e-4, 0.05, True), 'x': Range(-2.0, 2.0), 'y': Range(-2.0, 2.0),
        'rest': Range(0.5, 2.0), 'depth': Range(0.35, 0.4),
    },
    'other_fan': {
        'size': Range(0.1, 3.0, True), 'x': Range(-3.0, 3.0), 'y': Range(-3.0, 3.0),
        'z': Range(1.2, 1.9), 'way': ROUND, 'radius': Range(0.2, 0.4),
    },
    'other_sloshing': {
        'size': Range(1e-3, 0.06, True), 'frequency': Range(0.7, 1.5), 'damping': Range(0.02, 0.1),
        'height': Range(-0.1, 0.15),
    },
    'other_tiring_rotors': {'size': Range(0.2, 4.0, True), 'memory': Range(8.0, 30.0)},
    'other_heading_force': {
        'size': Range(5e-4, 0.05, True), 'waves': Range(1.0, 4.0), 'phase': ROUND,
    },
    'other_shedding': {
        'size': Range(5e-3, 0.3, True), 'strouhal': Range(0.25, 0.6), 'phase': ROUND,
    },
}  # fmt: skip
# Numbers that are whole.
WHOLE: Final = ('rotor', 'waves')


def draw_unlisted(draw: Draw) -> tuple[str, dict[str, float]]:
    """Return a kind and its numbers."""
    name = str(draw.choice(sorted(UNLISTED)))
    numbers = {key: span.drawn(draw) for key, span in NUMBERS[name].items()}
    for key in WHOLE:
        if key in numbers:
            numbers[key] = float(math.floor(numbers[key]))
    return name, numbers


def scaled(name: str, numbers: Mapping[str, float], factor: float) -> dict[str, float]:
    """Return a kind with another size, within what there can be of it."""
    span = NUMBERS[name]['size']
    size = min(max(numbers['size'] * factor, span.least), span.most)
    return {**numbers, 'size': size}


def strength(wrench: Array) -> float:
    """Return how many floors a wrench comes to on its strongest axis, without its mean."""
    return float(np.max(np.std(wrench, axis=0) / np.array(FLOORS)))
