"""All things that are outside the library, and between which their numbers are drawn."""

from collections.abc import Callable, Mapping
import math
from typing import Final, final, NamedTuple

from lta_challenge.other.harmless import Harmless, Numbers
from lta_challenge.other.unlisted_pushes import (
    HangingWeight,
    HeadingForce,
    SkewedDrag,
    SloshingGas,
    Tether,
    VortexShedding,
)
from lta_challenge.other.unlisted_rest import CrossWind, FanJet, StickingRotor, TiringRotors
import numpy as np


@final
class Range(NamedTuple):
    """Between which a number is drawn, by its logarithm where it says so."""

    least: float
    most: float
    logarithmic: bool = False

    def drawn(self, draw: np.random.Generator) -> float:
        """Draw it."""
        if self.logarithmic:
            return float(self.least * (self.most / self.least) ** draw.random())
        return float(draw.uniform(self.least, self.most))


ROUND: Final = Range(-math.pi, math.pi)


@final
class OtherKind(NamedTuple):
    """A kind in words, what makes it of its numbers, and what they are drawn from."""

    about: str
    make: Callable[[Numbers], Harmless]
    numbers: Mapping[str, Range]


UNLISTED: Final[Mapping[str, OtherKind]] = {
    'other_pendulum': OtherKind(
        'a weight on a thread below the gondola',
        HangingWeight,
        {
            'size': Range(2e-4, 0.04, True),
            'length': Range(0.25, 0.6),
            'depth': Range(0.38, 0.42),
            'damping': Range(0.05, 0.4),
        },
    ),
    'other_sticking_rotor': OtherKind(
        'a rotor that lags behind by a play',
        StickingRotor,
        {'size': Range(0.01, 0.3, True), 'rotor': Range(0.0, 4.0)},
    ),
    'other_skewed_drag': OtherKind(
        'drag with exponent 1.5, askew of the axes',
        SkewedDrag,
        {'size': Range(5e-3, 0.4, True), 'angle': ROUND, 'rise': Range(-0.5, 0.5)},
    ),
    'other_cross_wind': OtherKind(
        'wind across the room, to and fro',
        CrossWind,
        {
            'size': Range(5e-3, 0.3, True),
            'frequency': Range(0.1, 0.4, True),
            'way': ROUND,
            'phase': ROUND,
        },
    ),
    'other_tether': OtherKind(
        'a rubber thread to the floor',
        Tether,
        {
            'size': Range(1e-4, 0.05, True),
            'x': Range(-2.0, 2.0),
            'y': Range(-2.0, 2.0),
            'rest': Range(0.5, 2.0),
            'depth': Range(0.35, 0.4),
        },
    ),
    'other_fan': OtherKind(
        'the jet of a fan',
        FanJet,
        {
            'size': Range(0.1, 3.0, True),
            'x': Range(-3.0, 3.0),
            'y': Range(-3.0, 3.0),
            'z': Range(1.2, 1.9),
            'way': ROUND,
            'radius': Range(0.2, 0.4),
        },
    ),
    'other_sloshing': OtherKind(
        'a gas bag that sloshes',
        SloshingGas,
        {
            'size': Range(2e-4, 0.06, True),
            'frequency': Range(0.7, 1.5),
            'damping': Range(0.02, 0.1),
            'height': Range(-0.1, 0.15),
        },
    ),
    'other_tiring_rotors': OtherKind(
        'rotors that grow weaker with use',
        TiringRotors,
        {'size': Range(0.2, 4.0, True), 'memory': Range(8.0, 30.0)},
    ),
    'other_heading_force': OtherKind(
        'a side force that goes with the heading',
        HeadingForce,
        {'size': Range(5e-4, 0.05, True), 'waves': Range(1.0, 4.0), 'phase': ROUND},
    ),
    'other_shedding': OtherKind(
        'a side force that alternates with the way',
        VortexShedding,
        {'size': Range(5e-3, 0.3, True), 'strouhal': Range(0.25, 0.6), 'phase': ROUND},
    ),
}
