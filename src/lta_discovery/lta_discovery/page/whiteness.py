"""Whether what is left over is noise: how it goes with itself a little later, and its spectrum."""

from collections.abc import Sequence
from typing import Final

from lta_discovery.flights.measured_flight import PERIOD
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

LONGEST: Final = 2.0  # s
GROUPS: Final = {'position': slice(0, 3), 'attitude': slice(3, 6)}
SURE: Final = 2.0  # deviations: of the band that white noise keeps to


def autocorrelation(left: Sequence[Array], longest: float = LONGEST) -> tuple[Array, Array, float]:
    """
    Return the autocorrelation of what is left over.

    Parameters
    ----------
    left : sequence of ndarrays, shape (S, n, k)
        Of some flights, NaN where nothing was measured; never across pieces.
    longest : float
        Lag. [s]

    Returns
    -------
    ndarray, ndarray, float
        Lags [s], the autocorrelation there, and the band about 0 that white noise of as many
        values would keep to.

    """
    count = round(longest / PERIOD)
    products, pairs = np.zeros(count + 1), np.zeros(count + 1)
    for each in left:
        known = np.isfinite(each)
        values = np.where(known, each, 0.0)
        length = min(count, each.shape[1] - 1)
        for lag in range(length + 1):
            end = each.shape[1] - lag
            products[lag] += np.sum(values[:, :end] * values[:, lag:])
            pairs[lag] += np.sum(known[:, :end] & known[:, lag:])
    means = products / np.maximum(pairs, 1.0)
    out: Array = means / means[0] if means[0] > 0.0 else means
    lags = np.arange(0, count + 1) * np.float64(PERIOD)
    return lags, out, float(SURE / np.sqrt(max(pairs[0], 1.0)))


def residual_spectrum(left: Sequence[Array]) -> tuple[Array, Array]:
    """
    Return the mean power of what is left over by frequency.

    Whole pieces only, each under a window of Hann: white noise of the size that was measured has
    1 at every frequency.

    Parameters
    ----------
    left : sequence of ndarrays, shape (S, n, k)
        By the noise.

    Returns
    -------
    ndarray, ndarray
        Frequencies above 0 [Hz] and the power there; empty where no piece is whole.

    """
    whole = []
    for each in left:
        rows = np.swapaxes(each, 1, 2).reshape(-1, each.shape[1])
        whole.append(rows[np.isfinite(rows).all(axis=1)])
    rows = np.concatenate(whole) if len({part.shape[1] for part in whole}) == 1 else whole[0]
    if not len(rows):
        return np.empty(0), np.empty(0)
    window = np.hanning(rows.shape[1])
    power = np.abs(np.fft.rfft(rows * window, axis=1)) ** 2 / np.sum(window**2)
    frequency = np.asarray(np.fft.rfftfreq(rows.shape[1], PERIOD), dtype=np.float64)
    mean: Array = power.mean(axis=0)
    return frequency[1:], mean[1:]
