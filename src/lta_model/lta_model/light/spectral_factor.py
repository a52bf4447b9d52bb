"""
What a detector makes of a light's spectrum.

The mean responsivity of a detector in a light is that of its wavelengths, weighted by their power.
The spectral factor is its ratio to that in sunlight: the current of a solar cell by irradiance,
relative to its data sheet, whose conditions are AM 1.5 sunlight. (The spectral mismatch factor of
IEC 60904-7 without a reference cell.)

A light is known by its luminous efficacy, in which spectra differ widely: halogen lamps have about
20 lm/W of radiation, the sun 110, white LEDs 280 to 350.
"""

from collections.abc import Sequence
from functools import cache
import math
from typing import Final

from lta_config.files import list_shipped_names
from lta_config.schema.spectrum_file import (
    LightSpectrum,
    load_spectral_response,
    load_spectrum,
    SpectralResponse,
)
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
STANDARD_LIGHT: Final = 'sun'  # of standard conditions
PEAK_EFFICACY: Final = 683.0  # lm/W at 555 nm, by definition
SECOND_RADIATION: Final = 1.438777e7  # nm K, h c / k
WAVELENGTHS: Final[Array] = np.arange(280.0, 4000.5)  # nm
FULL_WIDTH_FACTOR: Final = 4.0 * math.log(2.0)


def sample_spectrum(light: LightSpectrum) -> Array:
    """Return the share of the power by wavelength at `WAVELENGTHS`. [1/nm]"""
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


def mean_responsivity(light: LightSpectrum, response: SpectralResponse) -> float:
    """Return the current of a detector by the power of a light, in the unit of the response."""
    current = interpolate_points(response.points)
    return float(np.trapezoid(sample_spectrum(light) * current, WAVELENGTHS))


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
    """Return the luminous efficacy of the radiation of a shipped spectrum. [lm/W]"""
    power = sample_spectrum(load_spectrum(light))
    return PEAK_EFFICACY * float(
        np.trapezoid(power * photopic_sensitivity(WAVELENGTHS), WAVELENGTHS)
    )


@cache
def find_spectrum(efficacy: float) -> str:
    """Return the name of the shipped spectrum that is nearest in luminous efficacy. [lm/W]"""
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
    Return a detector's current by irradiance, relative to that in sunlight. [1]

    Parameters as in `responsivity_in_light`.
    """
    sun = mean_responsivity(load_spectrum(STANDARD_LIGHT), load_spectral_response(detector))
    return responsivity_in_light(efficacy, detector) / sun
