# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Compute the SNR of each lamp over each cell while all lamps are on, as compiled functions.

With c counts per lux, E the light of a lamp and F that of all others on one diode, and the
demodulator's g, l and h (`lta_sim.light_link`):

    A = g c E,   m = s sqrt(pi / N) + l c E + h + sum q c F

q is the crosstalk of a unit wave of another lamp in this lamp's noise bins. As in the demodulator,
a diode whose ADC is saturated is excluded, and the strongest peak in a search window over all
valid diodes counts as the lamp's tone. A lamp is therefore not received unless it is
`LEAST_PURITY` times as strong there as the harmonics of the others.

For q, the wave of each lamp passes the amplifier's pole and the demodulator's spectrum as in the
simulator. Its magnitude in another lamp's search window and in the bins that measure that lamp's
noise is the crosstalk.
"""

from collections.abc import Sequence
from dataclasses import dataclass
import math
from typing import Final, final

from lta_config.topics import AdcBlockShape
from lta_model.effects.protocol import Vector
from lta_model.light.direct_light import DiodeResponse, unpack_beam
from lta_model.light.lamp import SECOND_NS, SquareWave
from lta_model.vehicle import Vehicle
from lta_studies.light.plan.floor import Array
from lta_studies.light.plan.rays import diode_light
from lta_vlc.demodulation import find_peaks, plan_bins
from lta_vlc.settings import DemodulationSettings
from lta_vlc.spectral.spectrum import amplitude_spectrum
import numpy as np


@final
@dataclass(frozen=True, slots=True)
class LightReceiver:
    """Receiver of the lamps."""

    vehicle: Vehicle  # hull and photodiode ring
    # Demodulator; its frequency is replaced by that of each lamp
    demodulation: DemodulationSettings
    light: AdcBlockShape  # sampling rate and block length
    margin: float  # required SNR relative to the threshold

    @property
    def required_snr(self) -> float:
        """SNR above which a lamp counts as received."""
        return self.margin * self.demodulation.threshold


def compute_crosstalk(
    ear: LightReceiver, frequencies: Sequence[float], duty: float
) -> tuple[Array, Array]:
    """
    Compute the crosstalk of unit waves.

    Parameters
    ----------
    ear : LightReceiver
        Diodes and demodulation.
    frequencies : sequence of float
        Frequencies of the lamps. [Hz]
    duty : float
        Duty cycle of all lamps.

    Returns
    -------
    window, quiet : ndarray, shape (k, k)
        Row i, column j: magnitude of lamp j in the search window of lamp i, and its mean over the
        noise bins of lamp i. Zero on the diagonal.

    """
    rate, samples = ear.light.sample_rate.si, ear.light.samples
    # Sample times in integer nanoseconds, as in the simulator
    times = np.rint(np.arange(samples) * (SECOND_NS / rate)).astype(np.int64)
    # Time constant of the amplifier's pole [s]
    lag = 1.0 / (2.0 * math.pi * ear.vehicle.diodes.bandwidth)
    waves = np.stack(
        [SquareWave(f, duty).sample_filtered(times, lag) for f in frequencies], axis=1
    )
    spectrum = amplitude_spectrum(waves)
    window, quiet = np.zeros((2, len(frequencies), len(frequencies)))
    for i, frequency in enumerate(frequencies):
        settings = ear.demodulation.model_copy(update={'frequency': frequency})
        bins = plan_bins(settings, rate, samples)
        window[i] = find_peaks(spectrum, bins).amplitude
        # Bins that measure the noise: a wave in them raises the apparent noise.
        quiet[i] = spectrum[bins.quiet].mean(axis=0)
    # A lamp's own wave is signal, not crosstalk.
    np.fill_diagonal(window, 0.0)
    np.fill_diagonal(quiet, 0.0)
    return window, quiet


LEAST_PURITY: Final = 2.0  # required amplitude ratio of a lamp to the crosstalk in its window
Numbers = tuple[float, float, float, float, float, float, float, float]


def diode_snr(
    own: float,
    total: float,
    disturbed: float,
    of_lamp: tuple[float, float, float],
    factor: float,
    numbers: Numbers,
) -> float:
    """
    Return the expected SNR of a lamp on one diode.

    Parameters
    ----------
    own, total : float
        Counts of this lamp and of all lamps while they are on.
    disturbed : float
        Crosstalk of the other lamps in the noise bins. [counts]
    of_lamp : tuple of 3 floats
        Gain, leak and hum at the lamp's frequency, as in `LightLink`.
    factor : float
        Gain of the diode times its share of ambient light.
    numbers : tuple of 8 floats
        Counts per lux, in the dark, from steady light and at full scale; variance in the dark,
        variance per count of steady light and of a lamp, and number of samples.

    """
    _, _, steady, _, variance, shot, flicker, samples = numbers
    gain, leak, hum = of_lamp
    # Variance of a sample: electronics, shot noise of steady light, and that of the lamps
    scatter = variance + shot * factor * steady + flicker * total
    noise = math.sqrt(math.pi * scatter / samples) + leak * own + hum * factor
    return gain * own / (noise + disturbed)


def is_saturated(total: float, factor: float, numbers: Numbers) -> bool:
    """Return whether all lamps together saturate the ADC; parameters as in `diode_snr`."""
    return numbers[1] + factor * numbers[2] + total > numbers[3]


def compute_ring_light(
    lamps: Array,
    eye: DiodeResponse,
    visible: Array,
    cell: Vector,
    planes: Array,
    half_axes: Vector,
    cosine: float,
    sine: float,
    counts: float,
    light: Array,
) -> None:
    """
    Compute the light of all lamps on all diodes of a drone.

    Parameters
    ----------
    lamps, eye, planes, half_axes
        As in `compute_joint_snr`.
    visible : ndarray of bool, shape (l,)
        Lamps that are not hidden by a wall.
    cell : tuple of 3 floats
        Hull centre. [m]
    cosine, sine : float
        Cosine and sine of the heading.
    counts : float
        Counts per lux.
    light : ndarray, shape (l, d)
        Output. [counts]

    """
    for d in range(planes.shape[0]):
        spot = (planes[d, 0], planes[d, 1], planes[d, 2])
        axis = (planes[d, 3], planes[d, 4], planes[d, 5])
        for n in range(lamps.shape[0]):
            light[n, d] = 0.0
            # A diode with a gain of 0 reads nothing.
            if visible[n] and planes[d, 6] > 0.0:
                lux = diode_light(
                    unpack_beam(lamps[n]), eye, cosine, sine, cell, spot, axis, half_axes
                )
                light[n, d] = planes[d, 6] * counts * lux


def compute_joint_snr(
    lamps: Array,
    eye: DiodeResponse,
    visible: Array,
    cells: Array,
    planes: Array,
    half_axes: Vector,
    headings: Array,
    numbers: Numbers,
    each: Array,
    window: Array,
    quiet: Array,
    light: Array,
    out: Array,
) -> None:
    """
    Compute the SNR of each lamp over each cell on its best diode, at the worst heading.

    Parameters
    ----------
    lamps : ndarray, shape (l, 11)
        Lamps in the order of `LampBeam`, without room.
    visible : ndarray of bool, shape (m, l)
        Lamps that are not hidden from a cell by a wall.
    cells : ndarray, shape (m, 3)
        Hull centres. [m]
    planes, half_axes, headings
        As in `rays.light_extremes`.
    numbers : tuple of 8 floats
        As in `diode_snr`.
    each : ndarray, shape (l, 3)
        Gain, leak and hum at each lamp's frequency.
    window, quiet : ndarray, shape (l, l)
        From `compute_crosstalk`.
    light : ndarray, shape (l, d)
        Work space.
    out : ndarray, shape (l, m)
        Output: the SNR.

    """
    count = lamps.shape[0]
    for m in range(cells.shape[0]):
        cell = (cells[m, 0], cells[m, 1], cells[m, 2])
        for n in range(count):
            # The minimum over the headings follows; hidden lamps are skipped.
            out[n, m] = math.inf if visible[m, n] else 0.0
        for h in range(headings.shape[0]):
            compute_ring_light(
                lamps, eye, visible[m], cell, planes, half_axes, headings[h, 0], headings[h, 1],
                numbers[0], light,
            )  # fmt: skip
            for n in range(count):
                if out[n, m] == 0.0:
                    continue
                best, power, spilt_power = 0.0, 0.0, 0.0
                for d in range(planes.shape[0]):
                    total, disturbed, spilt = 0.0, 0.0, 0.0
                    for j in range(count):
                        total += light[j, d]
                        disturbed += quiet[n, j] * light[j, d]
                        spilt += window[n, j] * light[j, d]
                    # Columns 6 and 7: gain of the diode, and its share of the ambient light
                    own, factor = light[n, d], planes[d, 6] * planes[d, 7]
                    if is_saturated(total, factor, numbers):
                        continue
                    of_lamp = (each[n, 0], each[n, 1], each[n, 2])
                    best = max(best, diode_snr(own, total, disturbed, of_lamp, factor, numbers))
                    power += (of_lamp[0] * own) ** 2
                    spilt_power += spilt**2
                # Compare amplitudes without square roots.
                if power < LEAST_PURITY**2 * spilt_power:
                    best = 0.0
                out[n, m] = min(out[n, m], best)
