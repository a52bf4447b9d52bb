"""Compute intervals of values fitted to forecasts, by bootstrap over flights."""

from collections.abc import Sequence
from typing import Final

from lta_discovery.forecast.forecast_fit import ForecastFit
from lta_discovery.forecast.levenberg_marquardt import solve_bounded_step
from lta_discovery.model.parameters import FreeParameter
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

DRAWS: Final = 1000  # bootstrap samples of the flights


def bootstrap_values(
    fit: ForecastFit,
    knobs: Sequence[FreeParameter],
    which: Sequence[int],
    spread: Array,
    seed: int,
) -> Array:
    """
    Return bootstrap values over flights, shape (DRAWS, K).

    Each is one step from the fit to all, within the bounds of the parameters.
    """
    rng, count = np.random.default_rng(seed), len(fit.equations)
    at, wall = fit.values[list(which)], np.diag(spread**-2.0)
    low, high = (np.array([getattr(knobs[k], side) for k in which]) for side in ('low', 'high'))
    products = np.array([one.products for one in fit.equations])
    pulls = np.array([one.pull for one in fit.equations])
    # At the optimum pull and prior balance; subtract what remains from an unconverged fit.
    rest = pulls.sum(axis=0) - wall @ at
    out = np.empty((DRAWS, len(at)))
    for draw in range(DRAWS):
        # How often each flight occurs in the sample
        times = np.bincount(rng.integers(0, count, count), minlength=count)
        inner = np.einsum('f,fij->ij', times, products) + wall
        right = times @ pulls - wall @ at - rest
        out[draw] = solve_bounded_step(inner, right, at, low, high)
    return out


def compute_confidence_intervals(draws: Array) -> list[tuple[float, float]]:
    """Return the 95 % interval of each value."""
    low, high = np.percentile(draws, (2.5, 97.5), axis=0)
    return list(zip(low.tolist(), high.tolist(), strict=True))
