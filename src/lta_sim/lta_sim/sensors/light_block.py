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

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, lru_cache
import math
from typing import final

from lta_sim.compiled import compiled
from lta_sim.light_field import Illuminance, LightField
from lta_sim.sensors.photodiode import noise_terms, PhotodiodeArray, sensitivity
from lta_vlc.modulation import cycles, NANOSECONDS, SquareWave
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
# Numbers above this have no fraction: adding and taking it rounds, halves to even.
WHOLE = 2.0**52


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
    lamp, ambient = field.lamp, field.ambient
    wave = _wave(lamp.wave, _turn(start, lamp.wave.frequency), sample_rate, samples, time_constant)
    mains = (ambient.mains_frequency, ambient.mains_phase)
    flicker = _flicker(*mains, _turn(start, ambient.mains_frequency), sample_rate, samples)
    bright, dim = (sensitivity(array) / light_of.efficacy for light_of in (lamp, ambient))
    modulated, steady, crest = light.modulated * bright, light.steady * dim, light.mains * dim
    if state is None:
        rest = crest[0] * flicker[0] + steady[0]
        state = AmplifierState(modulated[0] * wave[0] + rest)
    volts = state.volts.copy()
    steps = 2**array.adc_bits
    numbers = (
        keep,
        math.sqrt(1.0 - keep * keep),
        *noise_terms(array),
        array.dark_offset,
        steps / array.adc_range,
        steps - 1.0,
    )
    chance = generator.standard_normal((samples, volts.size))
    block = np.empty((samples, volts.size), dtype=np.uint16)
    _compiled()(modulated, steady, crest, wave, flicker, chance, numbers, volts, block)
    return block, AmplifierState(volts)


@cache
def _compiled() -> Callable[..., None]:
    """Return `count`, compiled."""
    return compiled(count)[0]


def count(
    modulated: Array,
    steady: Array,
    mains: Array,
    wave: Array,
    flicker: Array,
    chance: Array,
    numbers: tuple[float, ...],
    volts: Array,
    block: NDArray[np.uint16],
) -> None:
    """
    Write the counts of one block, sample by sample; for the compiler.

    Parameters
    ----------
    modulated, steady, mains : ndarray of float64, shape (k, d)
        Volts by the lamp while it is on, by steady light and by the crest of the mains' flicker,
        at instants evenly spread over the block.
    wave : ndarray of float64, shape (n + 1,)
        The lamp's wave behind the pole, from one sample before the block on.
    flicker : ndarray of float64, shape (n,)
        The mains' wave.
    chance : ndarray of float64, shape (n, d)
        Normal deviates; what each sample adds to the volts takes their place.
    numbers : tuple of float
        What the pole keeps from sample to sample and the root of 1 less its square, the two terms
        of the noise, offset in the dark [V], counts by volt, largest count.
    volts : ndarray of float64, shape (d,)
        Output at the sample before the block; left at that of its last. [V]
    block : ndarray of uint16, shape (n, d)
        The counts.

    """
    keep, fresh, amplifier, shot, dark, scale, top = numbers
    last = modulated.shape[0] - 1
    pitch = last / block.shape[0]
    for n in range(block.shape[0]):
        at = n * pitch
        low = int(at)
        high = min(low + 1, last)
        b = at - low
        a = 1.0 - b
        # The lamp's lagged wave itself solves the pole: what it adds in a sample is exact.
        now, ripple = wave[n + 1], flicker[n]
        rise = now - keep * wave[n]
        for i in range(block.shape[1]):
            lamp = a * modulated[low, i] + b * modulated[high, i]
            rest = a * steady[low, i] + b * steady[high, i]
            rest += (a * mains[low, i] + b * mains[high, i]) * ripple
            noise = math.sqrt(amplifier + shot * (lamp * now + rest)) * fresh
            chance[n, i] = lamp * rise + rest * (1.0 - keep) + noise * chance[n, i]
    # Apart from the above, which the compiler does for several diodes at once.
    for n in range(block.shape[0]):
        for i in range(block.shape[1]):
            volts[i] = keep * volts[i] + chance[n, i]
            level = min(max((volts[i] + dark) * scale, 0.0), top)
            block[n, i] = int((level + WHOLE) - WHOLE)


@lru_cache(maxsize=8)
def _offsets(samples: int, sample_rate: float) -> NDArray[np.int64]:
    """Return the times of the samples after the start, with one sample before it. [ns]"""
    offsets: NDArray[np.int64] = np.rint(
        np.arange(-1, samples) * (NANOSECONDS / sample_rate)
    ).astype(np.int64)
    offsets.setflags(write=False)
    return offsets


def _turn(start: int, frequency: float) -> int:
    """
    Return the first time from zero on with the phase of `start`: all that a wave sees of it. [ns]

    With frequencies of few digits there are few such times, and a wave is computed once for each.
    """
    top, bottom = frequency.as_integer_ratio()
    bottom *= NANOSECONDS
    return start % (bottom // math.gcd(top, bottom))


@lru_cache(maxsize=64)
def _wave(
    wave: SquareWave, start: int, sample_rate: float, samples: int, time_constant: float
) -> Array:
    """Return the lamp's wave behind the pole, from one sample before the start on."""
    values = wave.lagged(start + _offsets(samples, sample_rate), time_constant)
    values.setflags(write=False)
    return values


@lru_cache(maxsize=64)
def _flicker(
    frequency: float, phase: float, start: int, sample_rate: float, samples: int
) -> Array:
    """Return the wave of the mains at the samples."""
    position = cycles(start + _offsets(samples, sample_rate)[1:], frequency, phase)
    values: Array = np.sin(2.0 * math.pi * position)
    values.setflags(write=False)
    return values
