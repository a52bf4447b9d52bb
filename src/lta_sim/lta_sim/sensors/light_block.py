"""
One block of converter counts from the light on a ring of photodiodes.

1. The light at a few instants is interpolated linearly over the block, times the
   lamp's wave; it and the flicker of the mains are taken as level within a sample.
2. The amplifier's bandwidth is one pole, solved exactly from sample to sample, with the lamp's
   edges between samples: what lies above Nyquist aliases as it does on the board. The pole stays
   where the setting puts it, whatever the feedback resistor.
3. All noise passes the same pole: a first-order autoregression whose variance is that of
   `noise_volts` at every sampling rate.
4. The converter rounds, and saturates at both ends of its range.

The samples come without jitter, and all diodes are sampled at the same instant.
"""

from dataclasses import dataclass
from functools import lru_cache
import math
from typing import final

from lta_sim.light_field import Ambient, Illuminance, LightField
from lta_sim.sensors.photodiode import noise_volts, PhotodiodeArray, sensitivity
from lta_vlc.modulation import cycles, NANOSECONDS
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@final
@dataclass(frozen=True, slots=True)
class AmplifierState:
    """
    What the amplifiers carry from one block to the next.

    Parameters
    ----------
    volts : ndarray of float64, shape (d,)
        Output at the last sample, without the offset in the dark. [V]

    """

    volts: Array


def synthesise(
    array: PhotodiodeArray,
    field: LightField,
    light: Illuminance,
    start: int,
    sample_rate: float,
    samples: int,
    generator: np.random.Generator,
    state: AmplifierState | None = None,
) -> tuple[NDArray[np.uint16], AmplifierState]:
    """
    Return one block of converter counts.

    Parameters
    ----------
    array : PhotodiodeArray
        The diodes.
    field : LightField
        When its lamp is on, and the mains' frequency and phase.
    light : Illuminance
        Light on the diodes at instants evenly spread over the block, arrays of shape (k, d): the
        first at `start`, the last one sample after the block's last. Between them it is taken to
        change linearly; a single instant holds throughout.
    start : int
        Time of the first sample. [ns]
    sample_rate : float
        Samples a second of each diode. [Hz]
    samples : int
        Samples in the block.
    generator : numpy.random.Generator
        Source of the noise; `samples` times d normal deviates are drawn.
    state : AmplifierState or None
        Where the block before ended; None for amplifiers that have long been on.

    Returns
    -------
    block : ndarray of uint16, shape (samples, d)
        Counts in time order, one column a diode.
    state : AmplifierState
        For the next block.

    """
    time_constant = 1.0 / (2.0 * math.pi * array.bandwidth)
    keep = math.exp(-1.0 / (sample_rate * time_constant))
    times = start + _offsets(samples, sample_rate)
    wave = field.lamp.wave.lagged(times, time_constant)
    weights = _interpolation(samples, light.modulated.shape[0])
    modulated = weights @ (light.modulated * (sensitivity(array) / field.lamp.efficacy))
    rest = _ambient(array, field.ambient, light, weights, times[1:])
    if state is None:
        state = AmplifierState(modulated[0] * wave[0] + rest[0])

    # The lamp's lagged wave is itself a solution of the pole: what it adds in one sample is exact.
    volts = modulated * (wave[1:] - keep * wave[:-1])[:, None]
    volts += rest * (1.0 - keep)
    deviation = noise_volts(array, modulated * wave[1:, None] + rest)
    deviation *= math.sqrt(1.0 - keep * keep)
    deviation *= generator.standard_normal(deviation.shape)
    volts += deviation
    volts[0] += keep * state.volts
    _accumulate(volts, keep)
    return _convert(array, volts), AmplifierState(volts[-1].copy())


def _ambient(
    array: PhotodiodeArray,
    ambient: Ambient,
    light: Illuminance,
    weights: Array,
    times: NDArray[np.int64],
) -> Array:
    """Return the volts of all light but the lamp's at the times of the samples."""
    position = cycles(times, ambient.mains_frequency, ambient.mains_phase)
    volts: Array = weights @ light.mains
    volts *= np.sin(2.0 * math.pi * position)[:, None]
    volts += weights @ light.steady
    volts *= sensitivity(array) / ambient.efficacy
    return volts


def _accumulate(volts: Array, keep: float) -> None:
    """
    Solve y_k = keep y_{k-1} + u_k along the first axis, in place.

    Each pass doubles how far back the sum reaches: the product of (1 + keep^s z^-s) over
    s = 1, 2, 4, ... is the whole geometric series.
    """
    reach = 1
    while reach < len(volts) and keep > np.finfo(np.float64).tiny:
        volts[reach:] += keep * volts[:-reach]
        keep *= keep
        reach *= 2


def _convert(array: PhotodiodeArray, volts: Array) -> NDArray[np.uint16]:
    """Return the counts of output voltages without the offset in the dark."""
    steps = 2**array.adc_bits
    counts = volts + array.dark_offset
    counts *= steps / array.adc_range
    np.rint(counts, out=counts)
    np.clip(counts, 0.0, steps - 1.0, out=counts)
    return counts.astype(np.uint16)


@lru_cache(maxsize=8)
def _offsets(samples: int, sample_rate: float) -> NDArray[np.int64]:
    """Return the times of the samples after the start, with one sample before it. [ns]"""
    offsets: NDArray[np.int64] = np.rint(
        np.arange(-1, samples) * (NANOSECONDS / sample_rate)
    ).astype(np.int64)
    offsets.setflags(write=False)
    return offsets


@lru_cache(maxsize=8)
def _interpolation(samples: int, instants: int) -> Array:
    """Return the (samples, instants) matrix that interpolates linearly over the block."""
    at = np.arange(samples) * ((instants - 1) / samples)
    weights: Array = np.maximum(0.0, 1.0 - np.abs(at[:, None] - np.arange(instants)))
    weights.setflags(write=False)
    return weights
