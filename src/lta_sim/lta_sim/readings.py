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
    """
    Sensor readings of one control step; None where nothing is due.

    Attributes
    ----------
    force, rates : tuple of float
        Measured specific force [m/s2] and angular rates [rad/s], body frame.
    ranges : list of (int, float)
        Stamps [ns] and distances [m] since the last control step.
    pressure : float or None
        [Pa]
    block : (int, ndarray of uint16) or None
        Stamp of the first sample [ns] and the ADC block, shape (samples, diodes).
    illuminance : float or None
        At the panel. [lx]
    battery, panel : (float, float) or None
        Voltage [V] and current [A]; negative discharges.
    truth : tuple of 13 floats or None
        Motion reported by the tracker: position [m] and quaternion x y z w, velocity [m/s] and
        rates [rad/s] in the body frame; equal to the true motion unless an effect acts on the
        tracker.

    """

    stamp_ns: int
    force: Vector = (0.0, 0.0, 0.0)
    rates: Vector = (0.0, 0.0, 0.0)
    ranges: list[tuple[int, float]] = field(default_factory=list)
    pressure: float | None = None
    block: tuple[int, NDArray[np.uint16]] | None = None
    illuminance: float | None = None
    battery: tuple[float, float] | None = None
    panel: tuple[float, float] | None = None
    truth: tuple[float, ...] | None = None
