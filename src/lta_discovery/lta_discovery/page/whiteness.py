"""Test residuals for whiteness: autocorrelation and spectrum."""

from collections.abc import Sequence
from typing import Final

from lta_discovery.flights.measured_flight import PERIOD
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

LONGEST: Final = 2.0  # s
GROUPS: Final = {'position': slice(0, 3), 'attitude': slice(3, 6)}
SURE: Final = 2.0  # standard deviations; half the width of the band of white noise


def autocorrelation(left: Sequence[Array], longest: float = LONGEST) -> tuple[Array, Array, float]:
    """
    Compute the autocorrelation of residuals within pieces.

    Parameters
    ----------
    left : sequence of ndarrays, shape (S, n, k)
        Residuals of some flights, NaN where nothing was measured.
    longest : float
        Largest lag. [s]

    Returns
    -------
    ndarray, ndarray, float
        Lags [s], the autocorrelation, and the half width of the band of white noise with as many
        values.

    """
    count = round(longest / PERIOD)
    products, pairs = np.zeros(count + 1), np.zeros(count + 1)
    for each in left:
        finite = np.isfinite(each)
        values = np.where(finite, each, 0.0)
        length = min(count, each.shape[1] - 1)
        for lag in range(length + 1):
            end = each.shape[1] - lag
            products[lag] += np.sum(values[:, :end] * values[:, lag:])
            pairs[lag] += np.sum(finite[:, :end] & finite[:, lag:])
    # Divide by the number of valid pairs, as gaps leave fewer at some lags.
    means = products / np.maximum(pairs, 1.0)
    out: Array = means / means[0] if means[0] > 0.0 else means
    lags = np.arange(0, count + 1) * np.float64(PERIOD)
    return lags, out, float(SURE / np.sqrt(max(pairs[0], 1.0)))


def residual_spectrum(left: Sequence[Array]) -> tuple[Array, Array]:
    """
    Compute the mean power spectrum of residuals.

    Only complete pieces count, each under a Hann window. White noise of the measured size has
    power 1 at every frequency.

    Parameters
    ----------
    left : sequence of ndarrays, shape (S, n, k)
        By the noise.

    Returns
    -------
    ndarray, ndarray
        Frequencies above 0 [Hz] and their power; empty without a complete piece.

    """
    whole = []
    for each in left:
        rows = np.swapaxes(each, 1, 2).reshape(-1, each.shape[1])
        whole.append(rows[np.isfinite(rows).all(axis=1)])
    # Flights may differ in piece length; a spectrum needs one length.
    rows = np.concatenate(whole) if len({part.shape[1] for part in whole}) == 1 else whole[0]
    if not len(rows):
        return np.empty(0), np.empty(0)
    window = np.hanning(rows.shape[1])
    power = np.abs(np.fft.rfft(rows * window, axis=1)) ** 2 / np.sum(window**2)
    frequency = np.asarray(np.fft.rfftfreq(rows.shape[1], PERIOD), dtype=np.float64)
    mean: Array = power.mean(axis=0)
    return frequency[1:], mean[1:]
