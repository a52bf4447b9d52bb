# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
BMP388 barometer in the standard atmosphere.

Noise (1.2 Pa rms unfiltered) and offset (8 Pa relative) are data sheet values read second-hand and
not checked against the original; the resolution is that of eightfold oversampling, the finest that
50 Hz allows. The drift is a straight line: 0.75 Pa/K while the board warms by 5 K in ten minutes.
"""

from dataclasses import dataclass
from typing import final, TypeVar

from lta_config.constants import STANDARD_GRAVITY
from lta_model.measurement_chain import apply_chain, Chain, round_to_step
import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

Height = TypeVar('Height', float, NDArray[np.float64])

# ICAO standard atmosphere (Doc 7488) below 11 km.
LAPSE = 0.0065  # K/m
SEA_TEMPERATURE = 288.15  # K
# g M / (R L): molar mass of air [kg/mol], gas constant [J/(mol K)]
EXPONENT = STANDARD_GRAVITY * 0.0289644 / (8.31446 * LAPSE)


@final
@dataclass(frozen=True, slots=True)
class PressureSettings:
    """The air at the floor, and the errors of the sensor; offset and drift are the largest."""

    floor: float = 101325.0  # air pressure [Pa]
    noise: float = 1.2  # standard deviation of a sample [Pa]
    # Uniform distributions, drawn for each flight [Pa, Pa/s]
    offset: float = 8.0
    drift: float = 0.006
    resolution: float = 0.33  # pressure per count [Pa]


@final
@dataclass(frozen=True, slots=True)
class PressureErrors:
    """Errors that stay constant during a flight: offset [Pa] and drift [Pa/s]."""

    offset: float
    drift: float


def draw_errors(settings: PressureSettings, rng: Generator) -> PressureErrors:
    """Return the errors of one flight."""
    # Uniform within the bounds of the data sheet
    offset, drift = rng.uniform(-1.0, 1.0, 2).tolist()
    return PressureErrors(offset=settings.offset * offset, drift=settings.drift * drift)


def air_pressure(floor: float, height: Height) -> Height:
    """
    Return the pressure [Pa] at heights above the floor [m] in the standard atmosphere.

    p = p_floor (1 - L h / T0)^(g M / (R L)), with the floor at the standard's 288.15 K.
    """
    share = (1.0 - LAPSE * height / SEA_TEMPERATURE) ** EXPONENT
    return floor * share  # type: ignore[no-any-return]  # a local annotation would not compile


def read_pressure(
    truth: float, offset: float, drift: float, noise: float, resolution: float
) -> float:
    """Return the reading of a pressure with its errors, rounded to counts; all in Pa."""
    return round_to_step(truth + offset + drift + noise, resolution)


def measure_pressure(
    settings: PressureSettings,
    errors: PressureErrors,
    height: float,
    elapsed: float,
    rng: Generator,
    chain: Chain = (),
) -> float:
    """Return one reading [Pa] at a sensor height above the floor [m] and a flight time [s]."""
    truth = air_pressure(settings.floor, height)
    if chain:
        truth = apply_chain(chain, (truth,), elapsed)[0]
    noise = settings.noise * float(rng.standard_normal())
    return read_pressure(truth, errors.offset, errors.drift * elapsed, noise, settings.resolution)
