# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Describe an arrangement of photodiodes as given by the vehicle file."""

from collections.abc import Sequence
from dataclasses import dataclass
import math
from typing import final

from lta_config.errors import BadInput
from lta_config.schema.vehicle_diodes import PhotodiodesBlock as DiodesEntry
from lta_model.sensors.photodiode import DiodeRing, spread_azimuths

Axis = tuple[float, float, float]
UNMEASURED_SPREAD = 0.04  # added to the spread of gains that were not measured


@final
@dataclass(frozen=True, slots=True)
class DiodeArray:
    """
    Place, axis and gain of each diode.

    Raise `BadInput` if there is no diode, the numbers do not match, or one is impossible.
    """

    # Unit axes, and places relative to the middle of all diodes [m], body frame
    axes: tuple[Axis, ...]
    places: tuple[Axis, ...]
    response: float  # exponent p of the response cos^p to the angle between light and axis
    gains: tuple[float, ...]  # relative to the nominal diode; 0 for one that is known to be dead
    spread: float  # relative standard deviation of the true gains
    response_deviation: float = 0.0  # standard deviation of the true exponent p

    def __post_init__(self) -> None:
        """Refuse an invalid array."""
        count = len(self.axes)
        if not count or not count == len(self.places) == len(self.gains):
            raise BadInput(
                f'The drone has {count} photodiode axes, {len(self.places)} positions and '
                f'{len(self.gains)} gains; give one of each for every diode.'
            )
        for axis in self.axes:
            # Written so that NaN fails too
            if not abs(math.hypot(*axis) - 1.0) < 1e-6:
                raise BadInput(
                    f'The photodiode axis {axis} must have length 1; divide it by its length.'
                )
        if not (math.isfinite(self.response) and self.response > 0.0):
            raise BadInput(
                f'The response exponent of the photodiodes is {self.response}; it must be above 0.'
            )
        if not all(math.isfinite(gain) and gain >= 0.0 for gain in self.gains):
            raise BadInput(f'The photodiode gains are {self.gains}; each must be 0 or more.')
        if not (math.isfinite(self.spread) and self.spread >= 0.0):
            raise BadInput(
                f'The relative spread of the photodiode gains is {self.spread}; it must be 0 '
                'or more.'
            )
        if not (math.isfinite(self.response_deviation) and self.response_deviation >= 0.0):
            raise BadInput(
                'The standard deviation of the response exponent is '
                f'{self.response_deviation}; it must be 0 or more.'
            )

    def check_diode_count(self, count: int) -> None:
        """Refuse readings of another number of diodes."""
        if count != len(self.axes):
            raise BadInput(
                f'The light message has samples of {count} photodiodes, but the vehicle '
                f'file has {len(self.axes)}; give the vehicle that carries these photodiodes '
                '(option --vehicle, or parameter vehicle of the demodulator).'
            )

    @property
    def ring(self) -> DiodeRing:
        """Return the horizontal axes, for the paper's weighted mean."""
        return DiodeRing(
            tuple(axis[0] for axis in self.axes), tuple(axis[1] for axis in self.axes)
        )


def build_even_ring(
    count: int, radius: float = 0.0, response: float = 1.0, spread: float = 0.0
) -> DiodeArray:
    """Return an even, level ring of equal diodes, the first forward; radius in m."""
    axes = _build_level_axes(count)
    return DiodeArray(axes, _place_on_sphere(axes, radius), response, (1.0,) * count, spread)


def build_diode_array(entry: DiodesEntry) -> DiodeArray:
    """Return the diodes of a vehicle file's `sensors.diodes`, as far as the drone knows them."""
    axes = (
        _build_level_axes(entry.count)
        if entry.axes is None
        else tuple(map(_normalize_axis, entry.axes.value))
    )
    measured = [1.0] * entry.count if entry.gains is None else entry.gains.value
    gains = tuple(0.0 if index in entry.dead else gain for index, gain in enumerate(measured))
    # How unequal diodes are is itself uncertain until they are measured
    spread = math.hypot(entry.gain_spread.si, UNMEASURED_SPREAD if entry.gains is None else 0.0)
    places = _place_on_sphere(axes, entry.radius.si)
    return DiodeArray(
        axes,
        places,
        entry.response.si,
        gains,
        spread,
        entry.response_deviation.si,
    )


def _build_level_axes(count: int) -> tuple[Axis, ...]:
    """Return the axes of an even ring, the first forward."""
    return tuple((math.cos(angle), math.sin(angle), 0.0) for angle in spread_azimuths(count))


def _normalize_axis(axis: Sequence[float]) -> Axis:
    """Return an axis, rounded in a file, at length 1."""
    x, y, z = axis
    length = math.hypot(x, y, z)
    return x / length, y / length, z / length


def _place_on_sphere(axes: Sequence[Axis], radius: float) -> tuple[Axis, ...]:
    """Return the places of diodes that look outwards from a sphere, less their mean [m]."""
    # The model's origin is the middle of the diodes
    means = [sum(axis[k] for axis in axes) / len(axes) for k in range(3)]
    return tuple(
        (
            radius * (axis[0] - means[0]),
            radius * (axis[1] - means[1]),
            radius * (axis[2] - means[2]),
        )
        for axis in axes
    )
