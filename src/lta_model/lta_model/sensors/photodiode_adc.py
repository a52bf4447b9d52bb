# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
One block of converter counts from the light on a ring of photodiodes.

1. The light at a few instants is interpolated linearly over the block, times the wave of its lamp
   (`lta_model.light.flicker`); it and the flicker of the mains are taken as level within a sample.
2. The amplifier's bandwidth is one pole, solved exactly from sample to sample, with the lamps'
   edges between samples: what lies above Nyquist aliases as it does on the board. The pole stays
   where the setting puts it, whatever the feedback resistor.
3. All noise passes the same pole, also the converter's own: a first-order autoregression whose
   variance is that of `noise_variances` at every sampling rate.
4. The converter rounds, and saturates at both ends of its range or where the amplifier does. Its
   clock may be off within a block, and its instants jitter; blocks begin when they should.

All diodes are sampled at the same instant.
"""

from dataclasses import dataclass
import math
from typing import final

from lta_config.compilation.compiler import compile_functions
from lta_model.light.field import LightField, PlaneIlluminance
from lta_model.light.flicker import BlockSampling, FlickerWaves
from lta_model.sensors.photodiode import noise_variances, PhotodiodeArray, voltage_sensitivity
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
# Numbers above this have no fraction: adding and taking it rounds, halves to even.
ROUNDING_TERM = 2.0**52


@final
@dataclass(frozen=True, slots=True)
class AmplifierState:
    """Amplifier output at the last sample of a block, without dark offset, shape (d,) [V]."""

    volts: Array


@final
class PhotodiodeBoard:
    """Diodes, amplifiers and converter in the light of a scene; sample rate in Hz."""

    def __init__(
        self, array: PhotodiodeArray, field: LightField, sample_rate: float, samples: int
    ) -> None:
        self.sampling = sample_rate, samples
        self._time_constant = 1.0 / (2.0 * math.pi * array.bandwidth)
        # What remains of the old output after one sample
        keep = math.exp(-1.0 / (sample_rate * self._time_constant))
        self._waves = FlickerWaves(
            field.lamps,
            field.ambient,
            BlockSampling(sample_rate * (1.0 + array.clock_error), samples),
            self._time_constant,
        )
        gains = array.diode_gains
        lamps = [[[voltage_sensitivity(array, lamp.efficacy)]] for lamp in field.lamps]
        self._bright = gains * np.array(lamps)
        self._dim = gains * voltage_sensitivity(array, field.ambient.efficacy)
        steps = 2**array.adc_bits
        self._numbers = (
            keep,
            # Keeps the variance of the autoregression independent of the rate
            math.sqrt(1.0 - keep * keep),
            *noise_variances(array),
            array.dark_offset,
            # Counts per volt, and the largest count
            steps / array.adc_range,
            array.largest_reading,
        )
        self._jitter, self._dead = array.jitter, list(array.dead)
        self._chance = np.empty((samples, array.count))
        self._scratch = np.empty((2, array.count))
        self._count = compile_functions(convert_to_counts)[0]

    def sample_block(
        self,
        light: PlaneIlluminance,
        start: int,
        generator: np.random.Generator,
        state: AmplifierState | None = None,
    ) -> tuple[NDArray[np.uint16], AmplifierState]:
        """
        Return one block of converter counts, shape (samples, d), and the state for the next block.

        Parameters
        ----------
        light : PlaneIlluminance
            Light at k instants evenly spread over the block, shape (k, d), of each lamp (l, k, d):
            the first at `start`, the last one sample after the block's last. It is interpolated
            linearly; a single instant holds throughout.
        start : int
            Time of the first sample. [ns]
        generator : numpy.random.Generator
            Samples times d normal deviates are drawn, after one for each sample if the instants
            jitter.
        state : AmplifierState or None
            End of the previous block; None for amplifiers that have long been on.

        """
        samples = self.sampling[1]
        shaken = generator.standard_normal(samples) * self._jitter if self._jitter else None
        wave, flicker = self._waves.sample_block(start, shaken)
        modulated, steady = light.modulated * self._bright, light.steady * self._dim
        crest = light.mains * self._dim
        if state is None:
            # Stationary output for amplifiers that have long been on
            rest = crest[0] * flicker[0] + steady[0]
            # Column 0 is the sample before the block
            state = AmplifierState(wave[:, 0] @ modulated[:, 0] + rest)
        # The compiled function writes into it; the state of the caller stays
        volts = state.volts.copy()
        generator.standard_normal(out=self._chance)
        block = np.empty(self._chance.shape, dtype=np.uint16)
        self._count(
            modulated,
            steady,
            crest,
            wave,
            flicker,
            self._chance,
            self._numbers,
            volts,
            block,
            self._scratch,
        )
        if self._dead:
            # Dead diodes have no noise and no dark offset either
            block[:, self._dead] = 0
        return block, AmplifierState(volts)


def convert_to_counts(
    modulated: Array,
    steady: Array,
    mains: Array,
    wave: Array,
    flicker: Array,
    chance: Array,
    numbers: tuple[float, ...],
    volts: Array,
    block: NDArray[np.uint16],
    scratch: Array,
) -> None:
    """
    Write the counts of one block, sample by sample; compiled.

    Parameters
    ----------
    modulated : ndarray of float64, shape (l, k, d)
        Volts by each lamp while it is on, at instants evenly spread over the block.
    steady, mains : ndarray of float64, shape (k, d)
        Volts by steady light and by the crest of the mains flicker.
    wave : ndarray of float64, shape (l, n + 1)
        The lamps' waves behind the pole, from one sample before the block on.
    flicker : ndarray of float64, shape (n,)
        The mains' wave.
    chance : ndarray of float64, shape (n, d)
        Normal deviates.
    numbers : tuple of float
        Decay of the pole per sample and the root of 1 less its square, the two noise terms, dark
        offset [V], counts per volt, largest count.
    volts : ndarray of float64, shape (d,)
        Output at the sample before the block; on return at its last. [V]
    block : ndarray of uint16, shape (n, d)
        The counts.
    scratch : ndarray of float64, shape (2, d)
        Work space.

    """
    keep, fresh, amplifier, shot, dark, scale, top = numbers
    last = steady.shape[0] - 1
    # Light instants per sample
    pitch = last / block.shape[0]
    level, rise = scratch[0], scratch[1]
    for n in range(block.shape[0]):
        at = n * pitch
        low = int(at)
        high = min(low + 1, last)
        b = at - low
        a = 1.0 - b
        # Each loop over the diodes is short and straight: the compiler does several at once.
        for i in range(volts.size):
            rest = a * steady[low, i] + b * steady[high, i]
            rest += (a * mains[low, i] + b * mains[high, i]) * flicker[n]
            level[i], rise[i] = rest, rest * (1.0 - keep)
        for k in range(modulated.shape[0]):
            # A lamp's lagged wave itself solves the pole: what it adds in a sample is exact.
            now, more = wave[k, n + 1], wave[k, n + 1] - keep * wave[k, n]
            for i in range(volts.size):
                lamp = a * modulated[k, low, i] + b * modulated[k, high, i]
                level[i] += lamp * now
                rise[i] += lamp * more
        for i in range(volts.size):
            # Shot noise grows with the light
            noise = math.sqrt(amplifier + shot * level[i]) * fresh
            volts[i] = keep * volts[i] + (rise[i] + noise * chance[n, i])
            counts = min(max((volts[i] + dark) * scale, 0.0), top)
            block[n, i] = int((counts + ROUNDING_TERM) - ROUNDING_TERM)
