"""
Which names carry over: chosen one by one by what they do to regimes that were left out.

About the model so far all flights are linearised once; then every candidate is fitted without each
regime in turn and judged by that regime, which is algebra on small matrices. The best is added and
everything refitted, until none is worth it.
"""

from collections.abc import Mapping, Sequence
from typing import Final, final, NamedTuple

from lta_discovery.forecast.forecast_fit import ForecastFitter, ForecastInformation
from lta_discovery.transfer.candidate_groups import CandidateGroup, list_groups, prior_deviations
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

WORTH: Final = 0.015  # of the squared error of the vehicle file in regimes left out
WORST: Final = -0.12  # of that of a regime; one that promises any regime worse is not taken
MOST: Final = 6  # names by forecasts
ROUNDS: Final = 2  # of the fit after each name


@final
class CandidateGain(NamedTuple):
    """One candidate of a round: its name, and the part of the squared error that it takes away."""

    group: CandidateGroup
    worth: float
    worst: float


@final
class GroupSelection(NamedTuple):
    """
    What was chosen.

    Attributes
    ----------
    groups : tuple of Group
        In the order in which they were added.
    worth : tuple of float
        Part of the squared error of the vehicle file in regimes left out that each takes away.
    values : ndarray, shape (G,)
        Fitted to all flights.
    rounds : tuple of tuple of Tried
        All that was tried, round by round; one more than there are names, unless there were many.
    first : float
        The squared error of the vehicle file, as it counts.

    """

    groups: tuple[CandidateGroup, ...]
    worth: tuple[float, ...]
    values: Array
    rounds: tuple[tuple[CandidateGain, ...], ...]
    first: float

    @property
    def log_evidence(self) -> tuple[float, ...]:
        """Log likelihood that each wins in regimes left out, errors as large as usual."""
        return tuple(0.5 * self.first * worth for worth in self.worth)

    @property
    def names(self) -> tuple[str, ...]:
        """For people."""
        return tuple(group.name for group in self.groups)

    @property
    def knobs(self) -> list[int]:
        """Places of all that has a name."""
        return [k for group in self.groups for k in group.knobs]


def select_forward(
    sight: ForecastFitter,
    flights: Sequence[int],
    regimes: Mapping[str, Sequence[int]],
    candidates: Sequence[CandidateGroup] | None = None,
) -> GroupSelection:
    """
    Return the names that carry over, by some flights alone.

    Parameters
    ----------
    sight : Foresight
        About the pieces that teach.
    flights : sequence of int
        That teach.
    regimes : mapping of str to sequence of int
        Of all flights.
    candidates : sequence of Group, optional
        What may be named; all that could be by default.

    """
    candidates = list_groups(sight.knobs) if candidates is None else candidates
    inside = set(flights)
    sides = [g for g in ([f for f in r if f in inside] for r in regimes.values()) if g]
    sides = [g for g in sides if len(g) < len(inside)]
    every = [k for group in candidates for k in group.knobs]
    chosen: list[tuple[CandidateGroup, float]] = []
    rounds: list[tuple[CandidateGain, ...]] = []
    values = np.zeros(len(sight.knobs))
    first = 0.0
    while sides and len(chosen) < MOST:
        about = sight.fit(every, np.ones(len(every)), flights, values, rounds=0)
        said = dict(zip(flights, about.said, strict=True))
        first = first or sum(one.cost for one in about.said)
        tried = _rank_candidates(
            sight, said, sides, every, values, [g for g, _ in chosen], candidates, first
        )
        rounds.append(tuple(tried))
        best = next((one for one in tried if one.worst > WORST), None)
        if best is None or best.worth < WORTH:
            break
        chosen.append((best.group, best.worth))
        which = [k for group, _ in chosen for k in group.knobs]
        values = sight.fit(
            which, prior_deviations(sight.knobs, which), flights, values, ROUNDS
        ).values
    names, worth = zip(*chosen, strict=True) if chosen else ((), ())
    return GroupSelection(names, worth, values, tuple(rounds), first)


def _rank_candidates(
    sight: ForecastFitter,
    information: Mapping[int, ForecastInformation],
    sides: Sequence[Sequence[int]],
    every: Sequence[int],
    values: Array,
    chosen: Sequence[CandidateGroup],
    candidates: Sequence[CandidateGroup],
    first: float,
) -> list[CandidateGain]:
    """Return all candidates of a round, the best first."""
    now = [k for group in chosen for k in group.knobs]
    base = _cross_validated_gain(sight, information, sides, every, now, values)
    costs = np.array([sum(information[f].cost for f in side) for side in sides])
    often = max(1, round(sum(map(len, sides)) / len({f for side in sides for f in side})))
    out = []
    for group in candidates:
        if group in chosen:
            continue
        gain = (
            _cross_validated_gain(sight, information, sides, every, [*now, *group.knobs], values)
            - base
        )
        out.append(
            CandidateGain(group, float(gain.sum()) / often / first, float((gain / costs).min()))
        )
    return sorted(out, key=lambda one: -one.worth)


def _cross_validated_gain(
    sight: ForecastFitter,
    information: Mapping[int, ForecastInformation],
    sides: Sequence[Sequence[int]],
    every: Sequence[int],
    which: Sequence[int],
    values: Array,
) -> Array:
    """Return by how much each regime gets better by what the others say, in squared error."""
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
        step = np.clip(np.linalg.solve(inner, right), low, high)
        n = np.sum([products[f] for f in side], axis=0)
        b = np.sum([pulls[f] for f in side], axis=0)
        out.append(float(2.0 * step @ b - step @ n @ step))
    return np.array(out)
