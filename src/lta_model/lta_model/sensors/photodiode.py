# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
A ring of photodiodes with amplifiers (OPT101): directions, and voltage by light.

Irradiance on a diode's plane times area and responsivity is the photocurrent; times the feedback
resistor, volts. The responsivity is averaged over the spectrum of the light: 0.37 A/W in white LED
light and 0.32 in sunlight, where the data sheet prints 0.45 for 650 nm.

Noise is that of amplifier and converter and the shot noise sqrt(2 q I B), B = pi/2 f_3dB of the
amplifier's pole. The data sheet's 300 uV rms (0.1 Hz to 20 kHz, 1 Mohm) is taken as all of the
amplifier's noise and scaled with the root of the resistor, as thermal noise: an assumption.

A reading falls off as a power of the cosine between light and axis, out to the edge of the field
of view: 1 is a flat plane, 1.2 the package of the OPT101. Gains differ from diode to diode.

Source: OPT101 data sheet, Texas Instruments SBBS002; the exponent is from memory of its plot of
responsivity by angle, to be measured. The amplifier's output ends below its supply; with 5 V the
converter saturates first, at 3.3 V; with 3.3 V the amplifier does, at 65 % of that.

The resistor is mounted with the diode, so it is part of the vehicle and the same in every scene.
"""

from dataclasses import dataclass
from functools import cached_property
import math
from typing import Annotated, final

from lta_config.files import StrictModel
from lta_config.schema.vehicle_diodes import largest_reading
from lta_model.light.spectral_factor import responsivity_in_light
import numpy as np
from numpy.typing import NDArray
from pydantic import Field


@final
@dataclass(frozen=True, slots=True)
class DiodeRing:
    """Horizontal diode axes in the body frame: components along x (forward) and y (left)."""

    cosines: tuple[float, ...]
    sines: tuple[float, ...]


def spread_azimuths(count: int) -> tuple[float, ...]:
    """Return the azimuths of `count` diodes spread evenly, the first forward [rad]."""
    return tuple(2.0 * math.pi * i / count for i in range(count))


Array = NDArray[np.float64]
ELEMENTARY_CHARGE = 1.602176634e-19  # C, exact in SI
REFERENCE_RESISTANCE = 1e5  # ohm, to which the strength of a lamp is scaled
NOISE_RESISTANCE = 1e6  # ohm, at which the data sheet gives the noise

Finite = Annotated[float, Field(allow_inf_nan=False)]
Positive = Annotated[Finite, Field(gt=0.0)]
NotNegative = Annotated[Finite, Field(ge=0.0)]


@final
class PhotodiodeArray(StrictModel):
    """
    A ring of photodiodes under the hull.

    The vehicle file describes the ring; defaults are data sheet values of the part, or neutral.
    """

    count: Annotated[int, Field(ge=1, le=64)]
    depth: Finite  # ring below the hull centre [m]
    radius: NotNegative  # distance of each diode along its axis [m]
    # Unit axes in the body frame; by default horizontal, evenly spread, the first forward
    axes: tuple[tuple[Finite, Finite, Finite], ...] = ()
    response: Positive = 1.0  # exponent of the cosine
    field_of_view: Annotated[Positive, Field(le=math.pi)] = math.pi  # full angle [rad]
    gain_spread: NotNegative = 0.0  # relative standard deviation of the gains
    gains: tuple[NotNegative, ...] = ()  # of each diode, relative to the nominal; all 1 by default
    dead: tuple[Annotated[int, Field(ge=0)], ...] = ()  # indices of dead diodes, from 0
    feedback_resistance: Positive  # feedback resistor [ohm]
    area: Positive = 5.2e-6  # sensitive area of a diode [m2]
    detector: str = 'opt101'  # spectral response: a shipped name
    dark_offset: NotNegative = 7.5e-3  # output in the dark [V]
    bandwidth: Positive = 14e3  # 3 dB frequency [Hz]
    # Amplifier's standard deviation with a feedback resistor of 1 Mohm [V]
    noise: NotNegative = 300e-6
    # The converter of the Teensy 4.1.
    adc_bits: Annotated[int, Field(ge=1, le=16)] = 12
    adc_range: Positive = 3.3  # voltage at full scale [V]
    output_limit: Positive = 3.85  # highest output of the amplifier [V]
    adc_noise: NotNegative = 0.0  # standard deviation of the converter's own noise, in its steps
    clock_error: Finite = 0.0  # relative error of the sampling rate, positive if too fast
    # Standard deviation of the sampling instants, the same for all diodes [s]
    jitter: NotNegative = 0.0

    @cached_property
    def planes(self) -> Array:
        """Places [m] and unit axes of the diodes in the body frame, shape (count, 6)."""
        if self.axes:
            axes = np.array(self.axes)
        else:
            angles = np.array(spread_azimuths(self.count))
            axes = np.stack([np.cos(angles), np.sin(angles), np.zeros(self.count)], axis=-1)
        # Each diode sits along its axis, below the hull centre
        points = self.radius * axes - np.array([0.0, 0.0, self.depth])
        return np.concatenate([points, axes], axis=1)

    @property
    def edge_cosine(self) -> float:
        """Cosine at the edge of the field of view."""
        # A full half space: nothing is cut off but the back
        return math.cos(0.5 * self.field_of_view) if self.field_of_view < math.pi else 0.0

    @property
    def largest_reading(self) -> float:
        """Largest reading, at which converter or amplifier saturate [counts]."""
        return largest_reading(self.adc_bits, self.adc_range, self.output_limit)

    @property
    def diode_gains(self) -> Array:
        """Gain of each diode, shape (count,); 0 where it is dead."""
        factors = np.array(self.gains) if self.gains else np.ones(self.count)
        # A dead diode reads nothing, whatever its gain
        factors[list(self.dead)] = 0.0
        return factors

    @property
    def gain_scale(self) -> float:
        """Return the reading with this resistor over that with `REFERENCE_RESISTANCE` [1]."""
        return self.feedback_resistance / REFERENCE_RESISTANCE

    def draw_gains(self, chance: np.random.Generator) -> 'PhotodiodeArray':
        """Return these diodes with gains drawn about their own by the spread, none below zero."""
        # A normal distribution has no lower bound, a gain does
        gains = np.maximum(1.0 + self.gain_spread * chance.standard_normal(self.count), 0.0)
        if self.gains:
            gains *= self.gains
        return self.model_copy(update={'gains': tuple(gains.tolist())})

    def transform_to_map(self, position: Array, rotation: Array) -> tuple[Array, Array]:
        """
        Return positions [m] and unit axes of the diodes in `map`, shape (..., count, 3).

        `position` is the hull centre [m, map], shape (..., 3); `rotation` body -> map, shape (...,
        3, 3).
        """
        points, axes = self.planes[:, :3], self.planes[:, 3:]
        turn = np.swapaxes(rotation, -1, -2)
        return position[..., None, :] + points @ turn, axes @ turn


def voltage_sensitivity(array: PhotodiodeArray, efficacy: float) -> float:
    """Return the volts by illuminance in light of a luminous efficacy [lm/W] [V/lx]."""
    current = array.area * responsivity_in_light(efficacy, array.detector) / efficacy
    return current * array.feedback_resistance


def noise_variances(array: PhotodiodeArray) -> tuple[float, float]:
    """Return the variance of noise without light [V2] and that of the shot noise by volt [V]."""
    step = array.adc_range / 2**array.adc_bits
    # Noise power is taken as proportional to the resistor
    amplifier = array.noise**2 * array.feedback_resistance / NOISE_RESISTANCE
    amplifier += (array.adc_noise * step) ** 2
    # Equivalent noise bandwidth of a single pole
    noise_bandwidth = math.pi / 2.0 * array.bandwidth
    return amplifier, 2.0 * ELEMENTARY_CHARGE * noise_bandwidth * array.feedback_resistance
