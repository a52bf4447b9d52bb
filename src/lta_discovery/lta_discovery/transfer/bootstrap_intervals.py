"""How well values are known that forecasts gave: by which flights happened to be flown."""

from collections.abc import Sequence
from typing import Final

from lta_discovery.forecast.forecast_fit import ForecastFit
from lta_discovery.forecast.levenberg_marquardt import solve_bounded_step
from lta_discovery.model.parameters import FreeParameter
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

DRAWS: Final = 1000  # of regimes, for an interval


def bootstrap_values(
    fit: ForecastFit,
    knobs: Sequence[FreeParameter],
    which: Sequence[int],
    spread: Array,
    seed: int,
) -> Array:
    """
    Return values by flights drawn anew, each one step away from the fit to all.

    Parameters
    ----------
    fitted : Fitted
        To all flights, with what each says there.
    knobs : sequence of Knob
        All of them.
    which, spread
        Those that were fitted, and how far they may be off: as for `Foresight.fit`.
    seed : int
        Of the draws.

    Returns
    -------
    ndarray, shape (DRAWS, K)
        Within the bounds of the knobs.

    """
    rng, count = np.random.default_rng(seed), len(fit.said)
    at, wall = fit.values[list(which)], np.diag(spread**-2.0)
    low, high = (np.array([getattr(knobs[k], side) for k in which]) for side in ('low', 'high'))
    products = np.array([one.products for one in fit.said])
    pulls = np.array([one.pull for one in fit.said])
    # Where all rest, the pull of all is that of the wall; what is left of it is no news.
    rest = pulls.sum(axis=0) - wall @ at
    out = np.empty((DRAWS, len(at)))
    for draw in range(DRAWS):
        times = np.bincount(rng.integers(0, count, count), minlength=count)
        inner = np.einsum('f,fij->ij', times, products) + wall
        right = times @ pulls - wall @ at - rest
        out[draw] = solve_bounded_step(inner, right, at, low, high)
    return out


def compute_intervals(draws: Array) -> list[tuple[float, float]]:
    """Return the 95 % interval of each value."""
    low, high = np.percentile(draws, (2.5, 97.5), axis=0)
    return list(zip(low.tolist(), high.tolist(), strict=True))
