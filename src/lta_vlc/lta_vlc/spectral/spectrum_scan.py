"""Scan a spectrum once for beacon peaks, noise and the strongest unknown tone."""

from typing import NamedTuple

from lta_vlc.jit import compile_kernel
import numpy as np
from numpy.typing import NDArray


class SpectrumScan(NamedTuple):
    """
    What the whole bins hold.

    Attributes
    ----------
    highest : ndarray of int, shape (b,)
        Bin in which each beacon is strongest, over all diodes that have a say.
    peak : ndarray, shape (b, d)
        Magnitude of each diode's highest bin where a beacon is sought.
    noise : ndarray, shape (d,)
        Mean magnitude of the quiet bins.
    loudest : ndarray, shape (d,)
        Largest magnitude of a bin in which nothing known stands.

    """

    highest: NDArray[np.int64]
    peak: NDArray[np.float64]
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
    Return what the whole bins hold.

    Parameters
    ----------
    size : ndarray, shape (d, n // 2 + 1)
        Magnitudes.
    ranges : ndarray of int, shape (b, 2)
        Closed range of bins in which each beacon is sought.
    quiet, unlit : ndarray of int
        Quiet bins, and those of them that hold nothing known.
    weight : ndarray, shape (d,)
        1 for each diode that has a say in where a beacon stands, else 0.

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
            power = 0.0
            for diode in range(diodes):
                peak[beacon, diode] = max(peak[beacon, diode], size[diode, k])
                power += weight[diode] * size[diode, k] ** 2
            if power > most:
                most, highest[beacon] = power, k
    return SpectrumScan(highest, peak, noise, loudest)
