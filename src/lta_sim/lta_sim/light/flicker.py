"""
The waves of lamps and mains at the samples of a converter.

A lamp rises and falls as one pole whose 10 to 90 % time is `Lamp.rise`; the amplifier behind it is
another. With the answers y1, y2 of the two poles alone to the square wave, both together give
(t1 y1 - t2 y2) / (t1 - t2).

With frequencies of few digits there are few times from which a wave looks different, and it is
computed once for each.
"""

from dataclasses import dataclass
from functools import lru_cache
import math
from typing import final

from lta_sim.light.ambient import Ambient
from lta_sim.light.lamp import Lamp
from lta_vlc.modulation import cycles, NANOSECONDS, SquareWave
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
TEN_TO_NINETY = math.log(9.0)  # time constants that one pole takes from 10 % to 90 %
APART = 1e-3  # two poles nearer to each other than this part are moved apart


@final
@dataclass(frozen=True, slots=True)
class Sampling:
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

    def offsets(self) -> NDArray[np.int64]:
        """Return the times of the samples after the start, with one sample before it. [ns]"""
        times: NDArray[np.int64] = np.rint(
            np.arange(-1, self.samples) * (NANOSECONDS / self.rate)
        ).astype(np.int64)
        return times


def lamp_wave(
    lamp: Lamp, start: int, sampling: Sampling, time_constant: float, shaken: Array | None = None
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
    wave = lamp.clock.around(lamp.wave, start)
    if shaken is None:
        begin = _turn(start, wave.frequency)
        return _kept_wave(wave, lamp.rise, begin, sampling, time_constant)
    times = start + sampling.offsets()
    times[1:] += np.rint(shaken * NANOSECONDS).astype(np.int64)
    return _wave(wave, lamp.rise, times, time_constant)


def mains_wave(ambient: Ambient, start: int, sampling: Sampling) -> Array:
    """Return the mains' flicker at the samples of a block, the fundamental's amplitude being 1."""
    return _kept_flicker(ambient, _turn(start, ambient.mains_frequency), sampling)


def _wave(wave: SquareWave, rise: float, times: NDArray[np.int64], time_constant: float) -> Array:
    """Return the wave of a lamp with a rise time behind a pole."""
    behind = wave.lagged(times, time_constant)
    if not rise:
        return behind
    own = rise / TEN_TO_NINETY
    if abs(own / time_constant - 1.0) < APART:
        own = time_constant * (1.0 + APART)
    return (own * wave.lagged(times, own) - time_constant * behind) / (own - time_constant)


def _turn(start: int, frequency: float) -> int:
    """Return the first time from zero on with the phase of `start`: all a wave sees of it. [ns]"""
    top, bottom = frequency.as_integer_ratio()
    bottom *= NANOSECONDS
    return start % (bottom // math.gcd(top, bottom))


@lru_cache(maxsize=64)
def _kept_wave(
    wave: SquareWave, rise: float, start: int, sampling: Sampling, time_constant: float
) -> Array:
    values = _wave(wave, rise, start + sampling.offsets(), time_constant)
    values.setflags(write=False)
    return values


@lru_cache(maxsize=64)
def _kept_flicker(ambient: Ambient, start: int, sampling: Sampling) -> Array:
    times = start + sampling.offsets()[1:]
    turn = 2.0 * math.pi * cycles(times, ambient.mains_frequency, ambient.mains_phase)
    values: Array = np.sin(turn)
    for k, part in enumerate(ambient.mains_harmonics):
        values = values + part * np.sin((k + 2) * turn)
    values.setflags(write=False)
    return values
