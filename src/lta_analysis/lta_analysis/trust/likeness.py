"""How two sides of a pair are alike: lag, correlation and factor, axis by axis."""

from dataclasses import dataclass
from typing import final

from lta_analysis.trust.limits import Limits
from lta_analysis.trust.pairs import Pair
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@final
@dataclass(frozen=True, slots=True)
class Likeness:
    """
    How the left side of a pair follows the right one.

    Attributes
    ----------
    lag : float
        By how much the left side is late. [s]
    correlation : ndarray, shape (k, k)
        Of left axis i with right axis j at that lag; 0 where an axis does not move.
    ratio : ndarray, shape (k, k)
        Standard deviation of left axis i over that of right axis j.
    at_zero : ndarray, shape (k,)
        Correlation of each axis with its own at lag 0.
    moving : ndarray of bool, shape (k,)
        Which axes of the right side move enough to judge.

    """

    lag: float
    correlation: Array
    ratio: Array
    at_zero: Array
    moving: NDArray[np.bool_]


def deviations(table: Array, known: NDArray[np.bool_]) -> tuple[Array, Array]:
    """Return columns less their means where known, 0 elsewhere, and their spreads."""
    inside = table[known]
    # The loudest hundredth does not decide: one glitch of a tracker has more power than a flight.
    low, high = np.percentile(inside, [0.5, 99.5], axis=0)
    margin = 0.5 * (high - low)
    kept = np.clip(table, low - margin, high + margin)
    kept = np.where(known[:, None], kept - kept[known].mean(axis=0), 0.0)
    return kept, np.sqrt((kept**2).sum(axis=0) / max(1, known.sum()))


def shifted_products(left: Array, right: Array, most: int) -> Array:
    """Return the sums of left[t + lag] right[t] over t by lag -most..most, shape (2m+1, k)."""
    size = 1 << int(len(left) + most).bit_length()
    found = np.fft.irfft(
        np.fft.rfft(left, size, axis=0) * np.conj(np.fft.rfft(right, size, axis=0)), size, axis=0
    )
    return np.concatenate((found[-most:], found[: most + 1]))


def lag_of(left: Array, right: Array, step: float, search: float) -> float:
    """
    Return by how much the left side is late, by the largest correlation of either sign. [s]

    Parameters
    ----------
    left, right : ndarray, shape (n, k)
        Deviations, 0 where unknown, each column scaled to what it shall weigh.
    step, search : float
        Of the grid, and furthest lag. [s]

    """
    most = min(round(search / step), len(left) // 2)
    total = np.abs(shifted_products(left, right, most)).sum(axis=1)
    best = int(np.argmax(total))
    if 0 < best < 2 * most:
        before, at, after = total[best - 1 : best + 2]
        bend = before - 2 * at + after
        part = 0.0 if bend >= 0 else float(0.5 * (before - after) / bend)
        return (best - most + part) * step
    return (best - most) * step


def likeness(pair: Pair, limits: Limits) -> Likeness | None:
    """Return how the sides are alike; None where the right side hardly moves."""
    left, left_size = deviations(pair.left, pair.known)
    right, right_size = deviations(pair.right, pair.known)
    moving = (right_size > pair.least) & (left_size > 0.0)
    if not moving.any():
        return None
    unit_left = left / np.where(left_size > 0.0, left_size, 1.0)
    unit_right = right / np.where(right_size > 0.0, right_size, 1.0)
    weight = np.where(moving, 1.0, 0.0)
    lag = lag_of(unit_left * weight, unit_right * weight, pair.step, limits.clock_search)
    count = max(1, int(pair.known.sum()))
    moved = round(lag / pair.step)
    late = np.roll(unit_left, -moved, axis=0)
    correlation = late.T @ unit_right / count
    at_zero = (unit_left * unit_right).sum(axis=0) / count
    ratio = left_size[:, None] / np.where(right_size > 0.0, right_size, np.inf)[None, :]
    return Likeness(lag, correlation, ratio, at_zero, moving)
