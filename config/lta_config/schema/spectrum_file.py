# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Spectra of light, and the spectral responses of detectors: short tables with their sources.

Wavelengths are in nanometres and increase. The luminous efficacy of a light follows from its
spectrum, and files that have a light name its spectrum.
"""

from collections.abc import Sequence
from functools import cache
from itertools import pairwise
import math
from typing import Annotated, Any, Final, Literal

from lta_config.files import (
    check_exactly_one,
    find_file,
    list_shipped_names,
    load_file,
    Name,
    SchemaVersion,
    StrictModel,
)
from lta_config.quantity import Quantity, si_quantity
import numpy as np
from numpy.typing import NDArray
from pydantic import AfterValidator, BeforeValidator, Field, model_validator

Array = NDArray[np.float64]
PEAK_EFFICACY: Final = 683.0  # lm/W at 555 nm, by definition
SECOND_RADIATION: Final = 1.438777e7  # nm K, h c / k
WAVELENGTHS: Final[Array] = np.arange(280.0, 4000.5)  # nm
FULL_WIDTH_FACTOR: Final = 4.0 * math.log(2.0)

Wavelength = Annotated[float, Field(ge=100.0, le=10_000.0, strict=False)]
Positive = Annotated[float, Field(gt=0.0, allow_inf_nan=False, strict=False)]
Ordinate = Annotated[float, Field(ge=0.0, allow_inf_nan=False, strict=False)]
Point = Annotated[tuple[Wavelength, Ordinate], Field(strict=False)]


def _check_rising(points: Sequence[Point]) -> Sequence[Point]:
    if any(b[0] <= a[0] for a, b in pairwise(points)):
        raise ValueError('has wavelengths that do not increase; sort its points')
    return points


Points = Annotated[list[Point], Field(min_length=2), AfterValidator(_check_rising)]


class EmissionPeak(StrictModel):
    """A peak with a Gaussian on each side: widths at half maximum [nm], relative height."""

    at: Wavelength
    below: Positive
    above: Positive
    height: Positive


class EfficacyRange(StrictModel):
    """Range of the luminous efficacy of lights of a kind; the spectrum itself has one value."""

    range: Annotated[tuple[Positive, Positive], Field(strict=False)]
    unit: Literal['lm/W']
    range_source: str


class LightSpectrum(StrictModel):
    """
    Spectral power of a light, by exactly one of a table, peaks, or a black body's temperature.

    `total` is the integral of a table over all wavelengths, also those that it leaves out. The
    luminous efficacy follows from the spectrum; `efficacy` is the range of lights of this kind.
    """

    schema_version: SchemaVersion
    name: Name
    about: str
    source: str
    points: Points | None = None
    total: Positive | None = None  # in the unit of the points, times nm
    peaks: list[EmissionPeak] | None = None
    temperature: Annotated[float, Field(ge=500.0, le=20_000.0, strict=False)] | None = None  # K
    efficacy: EfficacyRange | None = None

    @model_validator(mode='after')
    def _check_kind(self) -> 'LightSpectrum':
        check_exactly_one(self, 'points', 'peaks', 'temperature')
        if (self.points is None) != (self.total is None):
            raise ValueError('needs "total" with "points", and only with them')
        return self


class SpectralResponse(StrictModel):
    """Current of a detector by the power of light on it; zero outside its points."""

    schema_version: SchemaVersion
    name: Name
    about: str
    source: str
    points: Points


@cache
def load_spectrum(name: str) -> LightSpectrum:
    """Return a spectrum by shipped name or path; raise `BadInput` if it is invalid."""
    return load_file(LightSpectrum, find_file('spectrum', name))


@cache
def load_spectral_response(name: str) -> SpectralResponse:
    """Return a spectral response by shipped name or path; raise `BadInput` if it is invalid."""
    return load_file(SpectralResponse, find_file('spectral response', name))


def sample_spectrum(light: LightSpectrum) -> Array:
    """Return the share of the power by wavelength at `WAVELENGTHS` [1/nm]."""
    nm = WAVELENGTHS
    if light.points is not None and light.total is not None:
        # The total includes what lies outside of the table
        return interpolate_points(light.points) / light.total
    if light.temperature is not None:
        power: Array = nm**-5 / np.expm1(SECOND_RADIATION / (nm * light.temperature))
    else:
        power = np.zeros(len(nm))
        for peak in light.peaks or ():
            width = np.where(nm < peak.at, peak.below, peak.above)
            power += peak.height * np.exp(-FULL_WIDTH_FACTOR * ((nm - peak.at) / width) ** 2)
    share: Array = power / np.trapezoid(power, nm)
    return share


def interpolate_points(points: Sequence[tuple[float, float]]) -> Array:
    """Return a table of wavelengths [nm] and values at `WAVELENGTHS`, 0 outside of it."""
    at, values = np.array(points).T
    interpolated: Array = np.interp(WAVELENGTHS, at, values, left=0.0, right=0.0)
    return interpolated


def photopic_sensitivity(wavelength: Array) -> Array:
    """
    Return the sensitivity of the eye by wavelength [nm], 1 at most.

    CIE 1931 by the two-lobe fit of Wyman, Sloan and Shirley (2013, Simple analytic approximations
    to the CIE XYZ color matching functions, JCGT 2(2)).
    """

    def lobe(height: float, middle: float, below: float, above: float) -> Array:
        width = np.where(wavelength < middle, below, above)
        return height * np.exp(-0.5 * ((wavelength - middle) / width) ** 2)

    return lobe(0.821, 568.8, 46.9, 40.5) + lobe(0.286, 530.9, 16.3, 31.1)


@cache
def luminous_efficacy(light: str) -> float:
    """Return the luminous efficacy of the radiation of a shipped spectrum [lm/W]."""
    power = sample_spectrum(load_spectrum(light))
    return PEAK_EFFICACY * float(
        np.trapezoid(power * photopic_sensitivity(WAVELENGTHS), WAVELENGTHS)
    )


def read_light(value: Any) -> Any:
    """Return the efficacy of a shipped spectrum, by its name; another value as it is."""
    if not isinstance(value, str) or value not in list_shipped_names('spectra'):
        return value
    number = luminous_efficacy(value)
    return {'value': number, 'unit': 'lm/W', 'source': f'spectrum {value}'}


# Luminous efficacy of a light [lm/W]: of a named spectrum, or a number
Efficacy = Annotated[
    Quantity,
    si_quantity('lm/W', above=0.0, high=PEAK_EFFICACY),
    BeforeValidator(read_light),
]
