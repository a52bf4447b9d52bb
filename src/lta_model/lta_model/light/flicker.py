"""
The waves of lamps and mains at the samples of a converter.

A lamp rises and falls as one pole whose 10 to 90 % time is `BeaconLamp.rise`; the amplifier behind
it is
another. With the answers y1, y2 of the two poles alone to the square wave, both together give
(t1 y1 - t2 y2) / (t1 - t2).

With frequencies of few digits there are few times from which a wave looks different, and it is
computed once for each.
"""

from dataclasses import dataclass
from functools import lru_cache
import math
from typing import final

from lta_model.light.ambient import Ambient
from lta_model.light.clock_error import RIGHT
from lta_model.light.lamp import BeaconLamp
from lta_model.light.modulation import NANOSECONDS, phase_in_cycles
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
TEN_TO_NINETY = math.log(9.0)  # time constants that one pole takes from 10 % to 90 %
APART = 1e-3  # two poles nearer to each other than this part are moved apart


@final
@dataclass(frozen=True, slots=True)
class BlockSampling:
    """
    The samples of a block.

    Parameters
    ----------
    rate : float
        Samples a second, by a right clock. [Hz]
    samples : int
        In a block.

    """

    rate: float
    samples: int

    def sample_offsets(self) -> NDArray[np.int64]:
        """Return the times of the samples after the start, with one sample before it. [ns]"""
        times: NDArray[np.int64] = np.rint(
            np.arange(-1, self.samples) * (NANOSECONDS / self.rate)
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

    Parameters
    ----------
    lamp : Lamp
        The lamp.
    start : int
        Time of the first sample. [ns]
    sampling : Sampling
        The samples.
    time_constant : float
        Of the amplifier. [s]
    shaken : ndarray of float64, shape (n,), optional
        By how much each sample is late. [s]

    """
    wave = lamp.clock.distort_wave(lamp.wave, start)
    times = start + sampling.sample_offsets()
    if shaken is not None:
        times[1:] += np.rint(shaken * NANOSECONDS).astype(np.int64)
    behind = wave.sample_filtered(times, time_constant)
    if not lamp.rise:
        return behind
    own = lamp.rise / TEN_TO_NINETY
    if abs(own / time_constant - 1.0) < APART:
        own = time_constant * (1.0 + APART)
    return (own * wave.sample_filtered(times, own) - time_constant * behind) / (
        own - time_constant
    )


def sample_mains_wave(ambient: Ambient, start: int, sampling: BlockSampling) -> Array:
    """Return the mains' flicker at the samples of a block, shape (n,); the fundamental's is 1."""
    times = start + sampling.sample_offsets()[1:]
    turn = 2.0 * math.pi * phase_in_cycles(times, ambient.mains_frequency, ambient.mains_phase)
    values: Array = np.sin(turn)
    for k, part in enumerate(ambient.mains_harmonics):
        values = values + part * np.sin((k + 2) * turn)
    return values


def repeat_period(frequency: float) -> int:
    """Return after how many whole nanoseconds a wave looks the same again. [ns]"""
    top, bottom = frequency.as_integer_ratio()
    bottom *= NANOSECONDS
    return bottom // math.gcd(top, bottom)


@final
class FlickerWaves:
    """
    The waves of all lamps and of the mains, block by block.

    Parameters
    ----------
    lamps : tuple of Lamp
        The lamps.
    ambient : Ambient
        The mains.
    sampling : Sampling
        The samples of a block.
    time_constant : float
        Of the amplifier. [s]

    """

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
        self._steady = all(lamp.clock == RIGHT for lamp in lamps)
        self._kept = lru_cache(maxsize=64)(self._compute_waves)

    def sample_block(self, start: int, shaken: Array | None = None) -> tuple[Array, Array]:
        """
        Return the waves of a block.

        Parameters
        ----------
        start : int
            Time of the first sample. [ns]
        shaken : ndarray of float64, shape (n,), optional
            By how much each sample is late. [s]

        Returns
        -------
        lamps : ndarray of float64, shape (l, n + 1)
            See `sample_lamp_wave`.
        mains : ndarray of float64, shape (n,)
            See `sample_mains_wave`.

        """
        if shaken is None and self._steady:
            return self._kept(tuple(start % turn for turn in self._turns))
        return self._compute_waves((start,) * len(self._turns), shaken)

    def _compute_waves(
        self, starts: tuple[int, ...], shaken: Array | None = None
    ) -> tuple[Array, Array]:
        """Return the waves from a start each."""
        sampling, behind = self._sampling, self._time_constant
        lamps = zip(self._lamps, starts[:-1], strict=True)
        waves = [sample_lamp_wave(lamp, start, sampling, behind, shaken) for lamp, start in lamps]
        return np.stack(waves), sample_mains_wave(self._ambient, starts[-1], sampling)
