"""
When something changed for good: a rotor that fails, a payload that drops.

Before and after, a series is taken for noise about a mean; where splitting it so makes it most
probable is the candidate. How much that gains by chance, in a series as unquiet as this one, is
found by shuffling the series itself in blocks, longer than it remembers.
"""

from typing import Final, final, NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

DRAWS: Final = 299
CHANCE: Final = 0.005  # of a series in which nothing changed


@final
class Change(NamedTuple):
    """
    A change.

    Attributes
    ----------
    index : int
        Of the first row after it.
    gain : float
        Log likelihood won by it. [nats]
    chance : float
        Share of shuffled series that gain as much.

    """

    index: int
    gain: float
    chance: float


def gains(series: Array, least: int) -> Array:
    """
    Return what splitting a series at each row gains, in nats; -inf near the ends.

    Parameters
    ----------
    series : ndarray, shape (..., n, k)
        Columns count as independent, each Gaussian with its own mean and spread on either side.
    least : int
        Rows that either side has to have.

    """
    n = series.shape[-2]
    count = np.arange(1, n)[:, None]
    first, second = np.cumsum(series, axis=-2), np.cumsum(series**2, axis=-2)
    total = second[..., -1:, :] - first[..., -1:, :] ** 2 / n
    before = second[..., :-1, :] - first[..., :-1, :] ** 2 / count
    rest = first[..., -1:, :] - first[..., :-1, :]
    after = second[..., -1:, :] - second[..., :-1, :] - rest**2 / (n - count)
    tiny = 1e-9 * total / n + 1e-300
    won = n * np.log(total / n + tiny)
    won = won - count * np.log(before / count + tiny)
    won = won - (n - count) * np.log(after / (n - count) + tiny)
    out = np.full(series.shape[:-1], -np.inf)
    out[..., 1:] = 0.5 * won.sum(axis=-1)
    out[..., :least] = -np.inf
    out[..., n - least + 1 :] = -np.inf
    return out


def change(
    series: Array, block: int, seed: int, draws: int = DRAWS, chance: float = CHANCE
) -> Change | None:
    """
    Return where a series changed; None where it did not, as far as can be told.

    Parameters
    ----------
    series : ndarray, shape (n, k)
        In the order of time.
    block : int
        Rows within which it remembers; either side of a change has twice as many.
    seed : int
        Of the shuffling.
    draws : int
        How often it is shuffled.
    chance : float
        Above it a change counts as none.

    """
    n, least = len(series), 2 * block
    if n < 2 * least + 1:
        return None
    own = gains(series, least)
    index = int(np.argmax(own))
    rng = np.random.default_rng([seed, n])
    # Each side about its own mean: what is to be judged must not raise its own bar.
    calm = series.copy()
    for side in (slice(None, index), slice(index, None)):
        calm[side] -= calm[side].mean(axis=0)
        calm[side] /= calm[side].std(axis=0) + 1e-300
    starts = rng.integers(0, n, (draws, -(-n // block)))
    rows = (starts[..., None] + np.arange(block)).reshape(draws, -1)[:, :n] % n
    by_chance = gains(calm[rows], least).max(axis=-1)
    share = float((1 + np.sum(by_chance >= own[index])) / (draws + 1))
    return Change(index, float(own[index]), share) if share <= chance else None
