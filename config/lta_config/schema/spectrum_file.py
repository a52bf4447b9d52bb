"""
Spectra of light, and the spectral responses of detectors: short tables with their sources.

Wavelengths are in nanometres and increase.
"""

from collections.abc import Sequence
from functools import cache
from itertools import pairwise
from typing import Annotated, Literal

from lta_config.files import (
    check_exactly_one,
    find_file,
    load_file,
    Name,
    SchemaVersion,
    StrictModel,
)
from pydantic import AfterValidator, Field, model_validator

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
