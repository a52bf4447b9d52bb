# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
What a detector makes of a light's spectrum.

The mean responsivity of a detector in a light is that of its wavelengths, weighted by their power.
The spectral factor is its ratio to that in sunlight: the current of a solar cell by irradiance,
relative to its data sheet, whose conditions are AM 1.5 sunlight. (The spectral mismatch factor of
IEC 60904-7 without a reference cell.)

A light is known by its luminous efficacy, in which spectra differ widely: halogen lamps have about
20 lm/W of radiation, the sun 109, white LEDs 280 to 350.
"""

from functools import cache
import math
from typing import Final

from lta_config.files import list_shipped_names
from lta_config.schema.spectrum_file import (
    interpolate_points,
    LightSpectrum,
    load_spectral_response,
    load_spectrum,
    luminous_efficacy,
    sample_spectrum,
    SpectralResponse,
    WAVELENGTHS,
)
import numpy as np

STANDARD_LIGHT: Final = 'sun'  # of standard conditions


def mean_responsivity(light: LightSpectrum, response: SpectralResponse) -> float:
    """Return the current of a detector by the power of a light, in the unit of the response."""
    current = interpolate_points(response.points)
    return float(np.trapezoid(sample_spectrum(light) * current, WAVELENGTHS))


@cache
def find_spectrum(efficacy: float) -> str:
    """Return the name of the shipped spectrum that is nearest in luminous efficacy [lm/W]."""
    names = list_shipped_names('spectra')
    return min(names, key=lambda name: abs(math.log(luminous_efficacy(name) / efficacy)))


@cache
def responsivity_in_light(efficacy: float, detector: str) -> float:
    """
    Return a detector's mean responsivity in a light, in the unit of its spectral response.

    `efficacy`: luminous efficacy of the light, which gives its spectrum [lm/W]. `detector`:
    spectral response: a technology of solar cells, or another shipped name.
    """
    light = load_spectrum(find_spectrum(efficacy))
    return mean_responsivity(light, load_spectral_response(detector))


@cache
def spectral_factor(efficacy: float, detector: str) -> float:
    """
    Return a detector's current by irradiance, relative to that in sunlight [1].

    Parameters as in `responsivity_in_light`.
    """
    sun = mean_responsivity(load_spectrum(STANDARD_LIGHT), load_spectral_response(detector))
    return responsivity_in_light(efficacy, detector) / sun
