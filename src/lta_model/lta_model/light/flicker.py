# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Waves of lamps and mains at the samples of a converter.

A lamp rises and falls as one pole whose 10 to 90 % time is `BeaconLamp.rise`; the amplifier is
another. With the responses y1, y2 of the two poles alone to the square wave, both together give
(t1 y1 - t2 y2) / (t1 - t2).

With frequencies of few digits a wave repeats after few starts, and is computed once for each.
"""

from dataclasses import dataclass
from functools import lru_cache
import math
from typing import final

from lta_model.light.field import Ambient
from lta_model.light.lamp import BeaconLamp, EXACT_CLOCK, phase_in_cycles, SECOND_NS
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
TEN_TO_NINETY = math.log(9.0)  # time constants that one pole takes from 10 % to 90 %
POLE_DISTANCE = 1e-3  # two poles nearer to each other than this part are moved apart


@final
@dataclass(frozen=True, slots=True)
class BlockSampling:
    """Sample rate by an exact clock [Hz], and number of samples in a block."""

    rate: float
    samples: int

    def sample_offsets(self) -> NDArray[np.int64]:
        """Return the times of the samples after the start, with one sample before it [ns]."""
        times: NDArray[np.int64] = np.rint(
            # From -1: the first sample needs the state of the low pass before it
            np.arange(-1, self.samples) * (SECOND_NS / self.rate)
        ).astype(np.int64)
        return times


def sample_lamp_wave(
    lamp: BeaconLamp,
    start: int,
    sampling: BlockSampling,
    time_constant: float,
    shaken: Array | None = None,
) -> Array:
    """
    Return a lamp's wave behind the amplifier's pole, from one sample before the start on.

    `start` is the time of the first sample [ns], `time_constant` the amplifier's [s], `shaken` the
    delay of each sample by jitter, shape (n,) [s].
    """
    wave = lamp.clock.distort_wave(lamp.wave, start)
    times = start + sampling.sample_offsets()
    if shaken is not None:
        # Not times[0], which belongs to the block before
        times[1:] += np.rint(shaken * SECOND_NS).astype(np.int64)
    behind = wave.sample_filtered(times, time_constant)
    if not lamp.rise:
        return behind
    # Time constant of the lamp's own pole
    own = lamp.rise / TEN_TO_NINETY
    if abs(own / time_constant - 1.0) < POLE_DISTANCE:
        # Equal poles would divide by zero in the sum below
        own = time_constant * (1.0 + POLE_DISTANCE)
    # Partial fractions of two poles in series
    return (own * wave.sample_filtered(times, own) - time_constant * behind) / (
        own - time_constant
    )


def sample_mains_wave(ambient: Ambient, start: int, sampling: BlockSampling) -> Array:
    """Return the mains' flicker at the samples of a block, shape (n,); the fundamental's is 1."""
    times = start + sampling.sample_offsets()[1:]
    # Angle of the fundamental at each sample [rad]
    turn = 2.0 * math.pi * phase_in_cycles(times, ambient.mains_frequency, ambient.mains_phase)
    values: Array = np.sin(turn)
    for k, part in enumerate(ambient.mains_harmonics):
        values = values + part * np.sin((k + 2) * turn)
    return values


def repeat_period(frequency: float) -> int:
    """Return after how many whole nanoseconds a wave repeats [ns]."""
    # Exact: the shortest integer time that holds a whole number of periods
    top, bottom = frequency.as_integer_ratio()
    bottom *= SECOND_NS
    return bottom // math.gcd(top, bottom)


@final
class FlickerWaves:
    """Waves of all lamps and of the mains, block by block; `time_constant` in s."""

    def __init__(
        self,
        lamps: tuple[BeaconLamp, ...],
        ambient: Ambient,
        sampling: BlockSampling,
        time_constant: float,
    ) -> None:
        self._lamps, self._ambient = lamps, ambient
        self._sampling, self._time_constant = sampling, time_constant
        frequencies = *(lamp.wave.frequency for lamp in lamps), ambient.mains_frequency
        self._turns = tuple(map(repeat_period, frequencies))
        self._steady = all(lamp.clock == EXACT_CLOCK for lamp in lamps)
        # Waves repeat after few starts; a cache on the instance, so that it dies with it
        self._recall_waves = lru_cache(maxsize=64)(self._compute_waves)

    def sample_block(self, start: int, shaken: Array | None = None) -> tuple[Array, Array]:
        """
        Return the waves of a block; see `sample_lamp_wave` and `sample_mains_wave`.

        `start` is the time of the first sample [ns], `shaken` the delay of each sample [s]. The
        lamps have shape (l, n + 1), the mains (n,).
        """
        # Drift or jitter make each block different, so caching would not help
        if shaken is None and self._steady:
            return self._recall_waves(tuple(start % turn for turn in self._turns))
        return self._compute_waves((start,) * len(self._turns), shaken)

    def _compute_waves(
        self, starts: tuple[int, ...], shaken: Array | None = None
    ) -> tuple[Array, Array]:
        """Return the waves, each from its own start."""
        sampling, behind = self._sampling, self._time_constant
        lamps = zip(self._lamps, starts[:-1], strict=True)
        waves = [sample_lamp_wave(lamp, start, sampling, behind, shaken) for lamp, start in lamps]
        return np.stack(waves), sample_mains_wave(self._ambient, starts[-1], sampling)
