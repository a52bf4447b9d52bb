"""
One block of converter counts from the light on a ring of photodiodes.

1. The light at a few instants is interpolated linearly over the block, times the wave of its lamp
   (`lta_sim.light.flicker`); it and the flicker of the mains are taken as level within a sample.
2. The amplifier's bandwidth is one pole, solved exactly from sample to sample, with the lamps'
   edges between samples: what lies above Nyquist aliases as it does on the board. The pole stays
   where the setting puts it, whatever the feedback resistor.
3. All noise passes the same pole, also the converter's own: a first-order autoregression whose
   variance is that of `noise_volts` at every sampling rate.
4. The converter rounds, and saturates at both ends of its range. Its clock may be off within a
   block, and its instants jitter; blocks begin when they should.

All diodes are sampled at the same instant.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
import math
from typing import final

from lta_sim.compiled import compiled
from lta_sim.light.field import Illuminance, LightField
from lta_sim.light.flicker import lamp_wave, mains_wave, Sampling
from lta_sim.sensors.photodiode import noise_terms, PhotodiodeArray, sensitivity
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
        When its lamps are on, and the mains' frequency and phase.
    light : Illuminance
        Light as the diodes read it at instants evenly spread over the block, arrays of shape
        (k, d), with that of each lamp apart (l, k, d): the first at `start`, the last one sample
        after the block's last. Between them it is taken to change linearly; a single instant
        holds throughout.
    start : int
        Time of the first sample. [ns]
    sample_rate : float
        Samples a second of each diode. [Hz]
    samples : int
        Samples in the block.
    generator : numpy.random.Generator
        Source of the noise; `samples` times d normal deviates are drawn, and `samples` more if
        the instants jitter.
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
    lamps, ambient = field.lamps, field.ambient
    sampling = Sampling(sample_rate * (1.0 + array.clock_error), samples)
    shaken = generator.standard_normal(samples) * array.jitter if array.jitter else None
    wave = np.stack([lamp_wave(each, start, sampling, time_constant, shaken) for each in lamps])
    flicker = mains_wave(ambient, start, sampling)
    volts_by_watts = sensitivity(array) * array.factors
    bright = volts_by_watts / np.array([[[lamp.efficacy]] for lamp in lamps])
    dim = volts_by_watts / ambient.efficacy
    modulated, steady, crest = light.modulated * bright, light.steady * dim, light.mains * dim
    if state is None:
        rest = crest[0] * flicker[0] + steady[0]
        state = AmplifierState(wave[:, 0] @ modulated[:, 0] + rest)
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
    block[:, list(array.dead)] = 0
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
    modulated : ndarray of float64, shape (l, k, d)
        Volts by each lamp while it is on, at instants evenly spread over the block.
    steady, mains : ndarray of float64, shape (k, d)
        Volts by steady light and by the crest of the mains' flicker.
    wave : ndarray of float64, shape (l, n + 1)
        The lamps' waves behind the pole, from one sample before the block on.
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
    last = steady.shape[0] - 1
    pitch = last / block.shape[0]
    for n in range(block.shape[0]):
        at = n * pitch
        low = int(at)
        high = min(low + 1, last)
        b = at - low
        a = 1.0 - b
        ripple = flicker[n]
        for i in range(block.shape[1]):
            rest = a * steady[low, i] + b * steady[high, i]
            rest += (a * mains[low, i] + b * mains[high, i]) * ripple
            level, rise = rest, rest * (1.0 - keep)
            for k in range(modulated.shape[0]):
                # A lamp's lagged wave itself solves the pole: what it adds in a sample is exact.
                lamp = a * modulated[k, low, i] + b * modulated[k, high, i]
                level += lamp * wave[k, n + 1]
                rise += lamp * (wave[k, n + 1] - keep * wave[k, n])
            noise = math.sqrt(amplifier + shot * level) * fresh
            chance[n, i] = rise + noise * chance[n, i]
    # Apart from the above, which the compiler does for several diodes at once.
    for n in range(block.shape[0]):
        for i in range(block.shape[1]):
            volts[i] = keep * volts[i] + chance[n, i]
            level = min(max((volts[i] + dark) * scale, 0.0), top)
            block[n, i] = int((level + WHOLE) - WHOLE)
