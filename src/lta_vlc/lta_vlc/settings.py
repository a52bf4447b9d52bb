# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Define the settings of the demodulation."""

from typing import Annotated

from lta_config.settings import setting, Settings
from pydantic import Field

ANY_BEACON = 0.0  # Hz, of a wanted beacon: the first of the settings


Frequency = Annotated[float, Field(ge=1.0, le=100_000.0)]


class DemodulationSettings(Settings):
    """
    Beacons and settings of the demodulation.

    In white noise alone a diode passes the threshold T in a share (2 window + 1) exp(-pi T^2 / 4)
    of the blocks: 0.43 % at T = 3 and a window of 2 (0.49 % in 128 000 blocks, as the noise is the
    mean of some 300 bins), never at 6, which leaves a margin for coloured noise.
    """

    frequency: float = setting(150.0, 'Hz', 1.0, 100_000.0)
    """Frequency at which the first beacon flickers."""
    others: tuple[Frequency, ...] = setting((), 'Hz')
    """Frequencies of further beacons."""
    window: int = setting(2, '1', 0, 100)
    """Number of FFT bins searched on either side of a beacon's frequency."""
    harmonics: int = setting(50, '1', 1, 1000)
    """
    Number of harmonics of each beacon excluded from the noise estimate (1: only the fundamental).
    """
    threshold: float = setting(6.0, '1', 1.0, 1000.0)
    """Smallest signal-to-noise ratio (SNR) at which the signal of a photodiode is used."""
    mains: float = setting(50.0, 'Hz', 0.0, 400.0)
    """Mains frequency, 50 or 60 Hz; room lamps flicker at twice this. 0: no such lamps."""

    @property
    def beacons(self) -> tuple[float, ...]:
        """Return the frequencies of all beacons, the first one first [Hz]."""
        return (self.frequency, *self.others)
