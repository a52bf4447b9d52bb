# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Readings of a vehicle at one control step, and the outcome of its flight."""

from dataclasses import dataclass, field
from enum import StrEnum
from typing import final

import numpy as np
from numpy.typing import NDArray

Vector = tuple[float, float, float]


class FlightOutcome(StrEnum):
    """State or outcome of a flight."""

    FLYING = 'flying'
    REACHED = 'reached its goal'
    TIMEOUT = 'ran out of time'
    ESCAPED = 'left the room'


@final
@dataclass(slots=True)
class SensorReadings:
    """Sensor readings of one control step; None where nothing is due."""

    stamp_ns: int
    # Measured specific force [m/s2] and angular rates [rad/s], body frame
    force: Vector = (0.0, 0.0, 0.0)
    rates: Vector = (0.0, 0.0, 0.0)
    # Stamps [ns] and distances [m] since the last control step
    ranges: list[tuple[int, float]] = field(default_factory=list)
    pressure: float | None = None  # [Pa]
    # Stamp of the first sample [ns] and the ADC block, shape (samples, diodes)
    block: tuple[int, NDArray[np.uint16]] | None = None
    illuminance: float | None = None  # at the panel [lx]
    # Voltage [V] and current [A]; negative discharges
    battery: tuple[float, float] | None = None
    panel: tuple[float, float] | None = None
    # Motion reported by the tracker: position [m] and quaternion x y z w, velocity [m/s] and rates
    # [rad/s] in the body frame; equal to the true motion unless an effect acts on the tracker
    truth: tuple[float, ...] | None = None
