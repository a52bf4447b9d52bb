"""
Fit all candidate parameters to forecasts at once.

Thrust, mass, drag and balance compensate each other, so that no value is a measurement or valid in
another regime. The result is the lowest forecast error within the flown regimes.
"""

from collections.abc import Mapping, Sequence
from typing import Final, final, NamedTuple

from lta_discovery.forecast.forecast_fit import ForecastFitter
from lta_discovery.transfer.candidate_groups import (
    CandidateGroup,
    list_knobs,
    prior_deviations,
)
from lta_discovery.transfer.cross_validation import cross_validate, RegimeForecastErrors
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

ROUNDS: Final = 8  # most steps of the fit


@final
class FullRefit(NamedTuple):
    """A fit of all candidate parameters to forecasts."""

    values: Array  # of all parameters, shape (G,)
    numbers: int  # number of fitted parameters
    regimes: list[RegimeForecastErrors]  # left-out regimes, the worst first; may be empty


def refit_all_parameters(
    sight: ForecastFitter,
    candidates: Sequence[CandidateGroup],
    begin: Array,
    parts: Mapping[str, Sequence[int]] | None = None,
) -> FullRefit:
    """
    Fit all parameters; with regimes, cross-validate the fit by them.

    `begin`, shape (G,): initial values: those of the named effects, or of the tolerances. `parts`:
    flights by regime.
    """
    which = list_knobs(candidates)
    spread = prior_deviations(sight.knobs, which)
    flights = range(len(sight.flights))
    fit = sight.fit(which, spread, flights, begin, ROUNDS, relinearize=False)
    regimes = cross_validate(sight, fit, which, spread, parts or {})
    return FullRefit(fit.values, len(which), regimes)
