"""
A ring of photodiodes with amplifiers (OPT101): where they look, and their volts from light.

Lux on a diode's plane over the luminous efficacy of the source (about 300 lm/W for a white LED,
105 for the sun; the mains' lamps count as LEDs) is irradiance; times area and responsivity, the
photocurrent; times the feedback resistor, volts. The responsivity is the data sheet's at 650 nm:
white light holds shorter waves that count for less, so real currents are lower.

Noise is the amplifier's and the shot noise sqrt(2 q I B), B = pi/2 f_3dB of the amplifier's pole.
The data sheet's 300 uV rms (0.1 Hz to 20 kHz, 1 Mohm) is taken as all of the amplifier's noise
and scaled with the root of the resistor, as a resistor's own noise does: an assumption.

Source: OPT101 data sheet, Texas Instruments SBBS002. The angular response is the ideal clipped
cosine, which the illuminance of the diode's plane already holds; the package's measured one is
left out, and so are unequal gains and the amplifier's own limits of swing.
"""

import math
from typing import final

from lta_config.settings import setting, Settings
from lta_vlc.array import azimuths
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
ELEMENTARY_CHARGE = 1.602176634e-19  # C, exact in SI
NOISE_RESISTANCE = 1e6  # ohm, at which the data sheet gives the noise


@final
class PhotodiodeArray(Settings):
    """A ring of horizontal photodiodes under the hull, the first facing forward."""

    count: int = setting(8, 'Diodes, evenly spread', unit='1', low=1, high=64, fixed=True)
    depth: float = setting(
        0.33, 'Height of the ring below the hull centre', unit='m', low=-5.0, high=5.0, fixed=True
    )
    radius: float = setting(0.05, 'Radius of the ring', unit='m', low=0.0, high=5.0, fixed=True)
    sample_rate: float = setting(
        10_000.0, 'Samples a second of each diode', unit='Hz', low=100.0, high=1e6, fixed=True
    )
    area: float = setting(
        5.2e-6, 'Sensitive area of a diode', unit='m2', low=1e-9, high=1e-2, fixed=True
    )
    responsivity: float = setting(
        0.45, 'Photocurrent per optical power', unit='A/W', low=1e-3, high=1.5, fixed=True
    )
    lamp_efficacy: float = setting(
        300.0,
        "Luminous efficacy of the radiation of the beacon and the mains' lamps",
        unit='lm/W',
        low=10.0,
        high=683.0,
        fixed=True,
    )
    ambient_efficacy: float = setting(
        105.0,
        'Luminous efficacy of the radiation of steady ambient light',
        unit='lm/W',
        low=10.0,
        high=683.0,
        fixed=True,
    )
    feedback_resistance: float = setting(
        100e3, 'Feedback resistor of the amplifiers', unit='ohm', low=1.0, high=1e9, fixed=True
    )
    dark_offset: float = setting(
        7.5e-3, 'Output in the dark', unit='V', low=0.0, high=1.0, fixed=True
    )
    bandwidth: float = setting(
        14e3,
        'Frequency at which the output has lost 3 dB',
        unit='Hz',
        low=1.0,
        high=1e9,
        fixed=True,
    )
    noise: float = setting(
        300e-6,
        "Standard deviation of the amplifier's noise with a feedback resistor of 1 Mohm",
        unit='V',
        low=0.0,
        high=1.0,
        fixed=True,
    )
    adc_bits: int = setting(
        12, 'Resolution of the converter', unit='1', low=1, high=16, fixed=True
    )
    adc_range: float = setting(
        3.3, 'Voltage of the converter at full scale', unit='V', low=0.1, high=10.0, fixed=True
    )

    def place(self, position: Array, rotation: Array) -> tuple[Array, Array]:
        """
        Return where the diodes are and where they look.

        Parameters
        ----------
        position : ndarray of float64, shape (..., 3)
            Hull centre. [m, map]
        rotation : ndarray of float64, shape (..., 3, 3)
            Body to map.

        Returns
        -------
        points, axes : ndarray of float64, shape (..., count, 3)
            Positions [m, map] and unit axes [map].

        """
        angles = np.array(azimuths(self.count))
        axes = np.stack([np.cos(angles), np.sin(angles), np.zeros(self.count)], axis=-1)
        points = self.radius * axes - np.array([0.0, 0.0, self.depth])
        turn = np.swapaxes(rotation, -1, -2)
        return position[..., None, :] + points @ turn, axes @ turn


def lamp_volts(array: PhotodiodeArray) -> float:
    """Return the volts of a steady lux of LED light. [V/lx]"""
    current = array.area * array.responsivity / array.lamp_efficacy
    return current * array.feedback_resistance


def ambient_volts(array: PhotodiodeArray) -> float:
    """Return the volts of a steady lux of ambient light. [V/lx]"""
    return lamp_volts(array) * array.lamp_efficacy / array.ambient_efficacy


def noise_volts(array: PhotodiodeArray, volts: Array | float) -> Array:
    """
    Return the standard deviation of the noise at an output.

    Parameters
    ----------
    array : PhotodiodeArray
        The diodes.
    volts : ndarray of float64 or float
        Output by light, without the offset in the dark. [V]

    Returns
    -------
    ndarray of float64
        Amplifier's and shot noise together. [V]

    """
    amplifier = array.noise**2 * array.feedback_resistance / NOISE_RESISTANCE
    noise_bandwidth = math.pi / 2.0 * array.bandwidth
    shot = 2.0 * ELEMENTARY_CHARGE * noise_bandwidth * array.feedback_resistance
    return np.sqrt(amplifier + shot * np.asarray(volts))
