"""
Select effects one by one, by their forecast gain in left-out regimes.

All flights are linearized about the current model. Every candidate is then fitted without each
regime in turn and scored on that regime, which needs only small matrices. The best is added and
everything refitted, until no candidate gains enough.
"""

from collections.abc import Mapping, Sequence
from typing import Final, final, NamedTuple

from lta_discovery.forecast.forecast_fit import ForecastFitter, ForecastNormalEquations
from lta_discovery.transfer.candidate_groups import (
    CandidateGroup,
    HULL,
    list_candidate_groups,
    list_knobs,
    prior_deviations,
)
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# of the vehicle file's squared error in left-out regimes; smallest gain of an effect
WORTH: Final = 0.015
WORST: Final = -0.12  # of a regime's squared error; a candidate with a larger loss is rejected
MOST: Final = 6  # most effects by forecasts
ROUNDS: Final = 2  # steps of the fit after each effect


@final
class CandidateGain(NamedTuple):
    """A candidate of a round, with its share of the squared error and its worst regime."""

    group: CandidateGroup
    worth: float
    worst: float


@final
class GroupSelection(NamedTuple):
    """Result of the selection."""

    groups: tuple[CandidateGroup, ...]  # in the order in which they were added
    # Share of the vehicle file's squared error in left-out regimes that each removes
    worth: tuple[float, ...]
    values: Array  # fitted to all flights, shape (G,)
    # All candidates by round; the last round usually adds none
    rounds: tuple[tuple[CandidateGain, ...], ...]
    first: float  # cost of the vehicle file

    @property
    def log_likelihood_gains(self) -> tuple[float, ...]:
        """Log likelihood gained by each in left-out regimes, for errors of the usual size."""
        return tuple(0.5 * self.first * worth for worth in self.worth)

    @property
    def names(self) -> tuple[str, ...]:
        """Readable names."""
        return tuple(group.name for group in self.groups)

    @property
    def knobs(self) -> list[int]:
        """Indices of the selected parameters."""
        return list_knobs(self.groups)


def select_forward(
    sight: ForecastFitter,
    flights: Sequence[int],
    regimes: Mapping[str, Sequence[int]],
    candidates: Sequence[CandidateGroup] | None = None,
) -> GroupSelection:
    """
    Select the effects that transfer between regimes.

    `candidates`: all of `list_candidate_groups` by default.
    """
    candidates = list_candidate_groups(sight.knobs) if candidates is None else candidates
    inside = set(flights)
    sides = [g for g in ([f for f in r if f in inside] for r in regimes.values()) if g]
    # A regime with all flights leaves nothing to fit to.
    sides = [g for g in sides if len(g) < len(inside)]
    every = list_knobs(candidates)
    chosen: list[tuple[CandidateGroup, float]] = []
    rounds: list[tuple[CandidateGain, ...]] = []
    values = np.zeros(len(sight.knobs))
    first = 0.0
    while sides and len(chosen) < MOST:
        # Zero rounds: linearize all candidates about the current model without a step.
        about = sight.fit(every, np.ones(len(every)), flights, values, rounds=0)
        equations = dict(zip(flights, about.equations, strict=True))
        first = first or sum(one.cost for one in about.equations)
        tried = _rank_candidates(
            sight, equations, sides, every, values, [g for g, _ in chosen], candidates, first
        )
        rounds.append(tuple(tried))
        # The best candidate that harms no regime much
        best = next((one for one in tried if one.worst > WORST), None)
        if best is None or best.worth < WORTH:
            break
        chosen.append((best.group, best.worth))
        which = list_knobs([group for group, _ in chosen])
        values = sight.fit(
            which, prior_deviations(sight.knobs, which), flights, values, ROUNDS
        ).values
    names, worth = zip(*chosen, strict=True) if chosen else ((), ())
    return GroupSelection(names, worth, values, tuple(rounds), first)


def _rank_candidates(
    sight: ForecastFitter,
    information: Mapping[int, ForecastNormalEquations],
    sides: Sequence[Sequence[int]],
    every: Sequence[int],
    values: Array,
    chosen: Sequence[CandidateGroup],
    candidates: Sequence[CandidateGroup],
    first: float,
) -> list[CandidateGain]:
    """Return all candidates of a round, the best first."""
    now = list_knobs(chosen)
    base = _cross_validated_gain(sight, information, sides, every, now, values)
    costs = np.array([sum(information[f].cost for f in side) for side in sides])
    # A flight can be in several regimes (mass, command, speed, turn): count its error once.
    often = max(1, round(sum(map(len, sides)) / len({f for side in sides for f in side})))
    out = []
    for group in candidates:
        both = list_knobs([*chosen, group])
        if len(both) == len(now):
            continue
        gain = _cross_validated_gain(sight, information, sides, every, both, values) - base
        out.append(
            CandidateGain(group, float(gain.sum()) / often / first, float((gain / costs).min()))
        )
    # Many parameters together have to be worth more than one effect
    return sorted(out, key=lambda one: WORTH * (one.group.name == HULL) - one.worth)


def _cross_validated_gain(
    sight: ForecastFitter,
    information: Mapping[int, ForecastNormalEquations],
    sides: Sequence[Sequence[int]],
    every: Sequence[int],
    which: Sequence[int],
    values: Array,
) -> Array:
    """Return the decrease of each regime's squared error with values of the others."""
    if not which:
        return np.zeros(len(sides))
    place = {k: i for i, k in enumerate(every)}
    at = [place[k] for k in which]
    grid = np.ix_(at, at)
    wall = np.diag(prior_deviations(sight.knobs, which) ** -2.0)
    low = np.array([sight.knobs[k].low for k in which]) - values[which]
    high = np.array([sight.knobs[k].high for k in which]) - values[which]
    products = {f: one.products[grid] for f, one in information.items()}
    pulls = {f: one.pull[at] for f, one in information.items()}
    out = []
    for side in sides:
        others = [f for f in information if f not in set(side)]
        inner = wall + np.sum([products[f] for f in others], axis=0)
        right = np.sum([pulls[f] for f in others], axis=0) - wall @ values[which]
        # One Gauss-Newton step from the other regimes, within bounds
        step = np.clip(np.linalg.solve(inner, right), low, high)
        n = np.sum([products[f] for f in side], axis=0)
        b = np.sum([pulls[f] for f in side], axis=0)
        # Decrease of the quadratic cost of the left-out regime
        out.append(float(2.0 * step @ b - step @ n @ step))
    return np.array(out)
