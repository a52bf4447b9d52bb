"""Directions of the photodiodes around a vehicle, in the horizontal plane of the body."""

from dataclasses import dataclass
import math
from typing import final


@final
@dataclass(frozen=True, slots=True)
class DiodeRing:
    """Horizontal diode axes in the body frame: components along x (forward) and y (left)."""

    cosines: tuple[float, ...]
    sines: tuple[float, ...]


def spread_azimuths(count: int) -> tuple[float, ...]:
    """Return the azimuths of `count` diodes spread evenly, the first forward. [rad]"""
    return tuple(2.0 * math.pi * i / count for i in range(count))
