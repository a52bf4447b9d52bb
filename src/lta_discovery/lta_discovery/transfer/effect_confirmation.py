"""Confirm effects between training and confirming flights, in both directions."""

from collections.abc import Sequence
from typing import Final

from lta_discovery.forecast.forecast_fit import ForecastFitter
from lta_discovery.transfer.candidate_groups import (
    CandidateGroup,
    list_knobs,
    prior_deviations,
)
from lta_discovery.transfer.forward_selection import GroupSelection
import numpy as np

ROUNDS: Final = 2  # steps of the fit to one half of the flights


def confirm_groups(
    sight: ForecastFitter, chosen: GroupSelection, halves: Sequence[Sequence[int]]
) -> tuple[CandidateGroup, ...]:
    """
    Return the effects without which the forecasts of the other half get worse.

    `halves`: training and confirming flights; if one is empty, all effects are confirmed.
    """
    groups = list(chosen.groups)
    if not all(halves):
        return tuple(groups)
    # Weakest first, so that strong effects are tested with few others
    for group in reversed(chosen.groups):
        rest = [one for one in groups if one is not group]
        with_it, without = (_cross_error(sight, chosen, some, halves) for some in (groups, rest))
        if with_it >= without:
            groups = rest
    return tuple(groups)


def _cross_error(
    sight: ForecastFitter,
    chosen: GroupSelection,
    groups: Sequence[CandidateGroup],
    halves: Sequence[Sequence[int]],
) -> float:
    """Return the summed squared error of each half with the values fitted to the other."""
    which = list_knobs(groups)
    # Start from the values of all flights, to save steps
    begin = np.where(np.isin(np.arange(len(sight.knobs)), which), chosen.values, 0.0)
    total = 0.0
    for teaching, other in (halves, halves[::-1]):
        values = begin
        if which:
            spread = prior_deviations(sight.knobs, which)
            values = sight.fit(which, spread, teaching, begin, ROUNDS, relinearize=False).values
        total += len(other) * sight.rms_error(values, other) ** 2
    return total
