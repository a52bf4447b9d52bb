"""
Fit all candidate parameters to forecasts at once.

Thrust, mass, drag and balance compensate each other, so that no value is a measurement or valid in
another regime. The result is the lowest forecast error within the flown regimes.
"""

from collections.abc import Sequence
from typing import Final

from lta_discovery.forecast.forecast_fit import ForecastFitter
from lta_discovery.transfer.candidate_groups import (
    CandidateGroup,
    list_knobs,
    prior_deviations,
)
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

ROUNDS: Final = 8  # most steps of the fit


def refit_all_parameters(
    sight: ForecastFitter, candidates: Sequence[CandidateGroup], begin: Array
) -> tuple[Array, int]:
    """
    Return all parameters, fitted, and the number of fitted ones.

    `begin`, shape (G,): initial values: those of the named effects.
    """
    which = list_knobs(candidates)
    spread = prior_deviations(sight.knobs, which)
    flights = range(len(sight.flights))
    found = sight.fit(which, spread, flights, begin, ROUNDS, relinearize=False)
    return found.values, len(which)
