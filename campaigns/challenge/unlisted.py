# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""List all disturbances outside the library with the ranges of their parameters."""

from collections.abc import Callable, Mapping
import math
from typing import Final, final, NamedTuple

import numpy as np

from campaigns.challenge.disturbances import (
    CrossWind,
    FanJet,
    HangingWeight,
    HeadingForce,
    NullDisturbance,
    Numbers,
    SkewedDrag,
    SloshingGas,
    StickingRotor,
    Tether,
    TiringRotors,
    VortexShedding,
)
from campaigns.challenge.flight import Array


@final
class ParameterRange(NamedTuple):
    """The range of a random parameter, uniform or log-uniform."""

    least: float
    most: float
    logarithmic: bool = False

    def draw_value(self, draw: np.random.Generator) -> float:
        """Draw a value."""
        if self.logarithmic:
            return float(self.least * (self.most / self.least) ** draw.random())
        return float(draw.uniform(self.least, self.most))


ROUND: Final = ParameterRange(-math.pi, math.pi)


@final
class UnlistedKind(NamedTuple):
    """A kind: description, constructor and ranges of its parameters."""

    about: str
    make: Callable[[Numbers], NullDisturbance]
    numbers: Mapping[str, ParameterRange]


UNLISTED: Final[Mapping[str, UnlistedKind]] = {
    'other_pendulum': UnlistedKind(
        'a weight that swings on a thread below the gondola',
        HangingWeight,
        {
            'size': ParameterRange(2e-4, 0.04, True),
            'length': ParameterRange(0.25, 0.6),
            'depth': ParameterRange(0.38, 0.42),
            'damping': ParameterRange(0.05, 0.4),
        },
    ),
    'other_sticking_rotor': UnlistedKind(
        'a rotor that follows its command with backlash',
        StickingRotor,
        {'size': ParameterRange(0.01, 0.3, True), 'rotor': ParameterRange(0.0, 4.0)},
    ),
    'other_skewed_drag': UnlistedKind(
        'drag along an oblique direction, proportional to speed^1.5',
        SkewedDrag,
        {
            'size': ParameterRange(5e-3, 0.4, True),
            'angle': ROUND,
            'rise': ParameterRange(-0.5, 0.5),
        },
    ),
    'other_cross_wind': UnlistedKind(
        'wind across the room that oscillates',
        CrossWind,
        {
            'size': ParameterRange(5e-3, 0.3, True),
            'frequency': ParameterRange(0.1, 0.4, True),
            'way': ROUND,
            'phase': ROUND,
        },
    ),
    'other_tether': UnlistedKind(
        'an elastic thread from the gondola to the floor',
        Tether,
        {
            'size': ParameterRange(1e-4, 0.05, True),
            'x': ParameterRange(-2.0, 2.0),
            'y': ParameterRange(-2.0, 2.0),
            'rest': ParameterRange(0.5, 2.0),
            'depth': ParameterRange(0.35, 0.4),
        },
    ),
    'other_fan': UnlistedKind(
        'the air jet of a fan in the room',
        FanJet,
        {
            'size': ParameterRange(0.1, 3.0, True),
            'x': ParameterRange(-3.0, 3.0),
            'y': ParameterRange(-3.0, 3.0),
            'z': ParameterRange(1.2, 1.9),
            'way': ROUND,
            'radius': ParameterRange(0.2, 0.4),
        },
    ),
    'other_sloshing': UnlistedKind(
        'a gas bag that sloshes in the hull',
        SloshingGas,
        {
            'size': ParameterRange(2e-4, 0.06, True),
            'frequency': ParameterRange(0.7, 1.5),
            'damping': ParameterRange(0.02, 0.1),
            'height': ParameterRange(-0.1, 0.15),
        },
    ),
    'other_tiring_rotors': UnlistedKind(
        'rotors that lose thrust as they heat up',
        TiringRotors,
        {'size': ParameterRange(0.2, 4.0, True), 'memory': ParameterRange(8.0, 30.0)},
    ),
    'other_heading_force': UnlistedKind(
        'a side force that depends on the heading',
        HeadingForce,
        {
            'size': ParameterRange(5e-4, 0.05, True),
            'waves': ParameterRange(1.0, 4.0),
            'phase': ROUND,
        },
    ),
    'other_shedding': UnlistedKind(
        'an alternating side force from vortex shedding',
        VortexShedding,
        {
            'size': ParameterRange(5e-3, 0.3, True),
            'strouhal': ParameterRange(0.25, 0.6),
            'phase': ROUND,
        },
    ),
}


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
