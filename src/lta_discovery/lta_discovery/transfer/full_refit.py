"""
Everything fitted to forecasts at once: the best forecast between what was flown, and no finding.

Thrust, mass, drag and balance trade against each other, so no value of it is a measurement, and
nobody says what it does in another regime. It shows how much of the error a name could still take.
"""

from typing import Final

from lta_discovery.forecast.forecast_fit import ForecastFitter
from lta_discovery.transfer.candidate_groups import iterated_prior_deviations, list_groups
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

ROUNDS: Final = 8  # of the fit of everything


def refit_everything(sight: ForecastFitter, begin: Array) -> tuple[Array, int]:
    """
    Return the knobs with all that could have a name fitted, and how many numbers those are.

    Parameters
    ----------
    sight : Foresight
        All flights that teach or confirm.
    begin : ndarray, shape (G,)
        With what was named.

    """
    which = [k for group in list_groups(sight.knobs) for k in group.knobs]
    spread = iterated_prior_deviations(sight.knobs, which)
    flights = range(len(sight.flights))
    found = sight.fit(which, spread, flights, begin, ROUNDS, relinearize=False)
    return found.values, len(which)
