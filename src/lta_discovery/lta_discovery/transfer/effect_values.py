"""Fit the values of selected effects, and cross-validate them by regime."""

from collections.abc import Mapping, Sequence
from typing import Final, final, NamedTuple

from lta_discovery.forecast.forecast_fit import ForecastFit, ForecastFitter
from lta_discovery.transfer.bootstrap_intervals import bootstrap_values
from lta_discovery.transfer.candidate_groups import (
    CandidateGroup,
    list_knobs,
    prior_deviations,
    tolerance_indices,
)
from lta_discovery.transfer.cross_validation import cross_validate, RegimeForecastErrors
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

ROUNDS: Final = 6  # most steps of the fit of effects
TUNING: Final = 4  # most steps of the fit of tolerances


@final
class EffectValues(NamedTuple):
    """Selected effects with their values."""

    which: list[int]
    fitted: ForecastFit
    draws: Array  # bootstrap values, shape (D, K)
    regimes: list[RegimeForecastErrors]  # left-out regimes, the worst first


def fit_effect_values(
    sight: ForecastFitter,
    groups: Sequence[CandidateGroup],
    parts: Mapping[str, Sequence[int]],
    seed: int,
) -> EffectValues:
    """Fit effects to all flights."""
    every = range(len(sight.flights))
    which = list_knobs(groups)
    spread = prior_deviations(sight.knobs, which)
    fitted = sight.fit(which, spread, every, rounds=ROUNDS)
    regimes = cross_validate(sight, fitted, which, spread, parts)
    draws = bootstrap_values(fitted, sight.knobs, which, spread, seed)
    return EffectValues(which, fitted, draws, regimes)


def tune_tolerances(
    sight: ForecastFitter,
    parts: Mapping[str, Sequence[int]],
    groups: Sequence[CandidateGroup] = (),
) -> tuple[Array, list[RegimeForecastErrors]]:
    """Fit tolerances to forecasts, together with effects; return the values and regime errors."""
    named = list_knobs(groups)
    rest = [k for k in tolerance_indices(sight.knobs) if k not in named]
    which = [*named, *rest]
    spread = np.concatenate(
        [prior_deviations(sight.knobs, named), [sight.knobs[k].tolerance for k in rest]]
    )
    fitted = sight.fit(which, spread, range(len(sight.flights)), rounds=TUNING)
    return fitted.values, cross_validate(sight, fitted, which, spread, parts)
