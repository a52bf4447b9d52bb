"""Scan a spectrum once for beacon peaks, noise and the strongest unknown tone."""

from typing import NamedTuple

from lta_vlc.jit import compile_kernel
import numpy as np
from numpy.typing import NDArray


class SpectrumScan(NamedTuple):
    """Results of the scan of whole bins."""

    # Strongest bin of each beacon, over all weighted diodes, shape (b,)
    highest: NDArray[np.int64]
    # Magnitude of each diode's highest bin in the search range, shape (b, d)
    peak: NDArray[np.float64]
    # Mean magnitude of the quiet bins, and largest one of the unlit bins, shape (d,)
    noise: NDArray[np.float64]
    loudest: NDArray[np.float64]


@compile_kernel
def scan_spectrum(
    size: NDArray[np.float64],
    ranges: NDArray[np.int64],
    quiet: NDArray[np.int64],
    unlit: NDArray[np.int64],
    weight: NDArray[np.float64],
) -> SpectrumScan:
    """
    Return the peaks and the noise in a spectrum of magnitudes, shape (d, n // 2 + 1).

    `ranges`, shape (b, 2): closed search range of each beacon. `quiet`, `unlit`: quiet bins, and
    those of them without mains flicker. `weight`, shape (d,): 1 for each diode that decides on the
    bin of a beacon, else 0.
    """
    diodes = size.shape[0]
    noise, loudest = np.zeros(diodes), np.zeros(diodes)
    for diode in range(diodes):
        for k in quiet:
            noise[diode] += size[diode, k]
        noise[diode] /= len(quiet)
        for k in unlit:
            loudest[diode] = max(loudest[diode], size[diode, k])
    highest = ranges[:, 0].copy()
    peak = np.zeros((len(ranges), diodes))
    for beacon in range(len(ranges)):
        most = -1.0
        for k in range(ranges[beacon, 0], ranges[beacon, 1] + 1):
            # All diodes decide together where the beacon is, by power
            power = 0.0
            for diode in range(diodes):
                peak[beacon, diode] = max(peak[beacon, diode], size[diode, k])
                power += weight[diode] * size[diode, k] ** 2
            if power > most:
                most, highest[beacon] = power, k
    return SpectrumScan(highest, peak, noise, loudest)
