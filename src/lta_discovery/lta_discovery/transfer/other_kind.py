"""
Judge effects by forecasts in a regime of another kind: straight or in a turn, slow or fast.

A regime left out of a fit (a place of the moving mass, a command) is often like the others. Here
the pieces of all flights that are slowest, fastest, straightest or in the tightest turns are left
out. Position and attitude are judged separately: a fit to the sum can trade one for the other.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
import math
from typing import Final, final, NamedTuple

from lta_discovery.finding import LeftOutKind
from lta_discovery.forecast.forecast_fit import ForecastFitter
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.replay.flight_linearizer import FlightLinearizer
from lta_discovery.transfer.candidate_groups import CandidateGroup, list_knobs, prior_deviations
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
# Squared errors of each part of a flight, infinite with a forecast that diverges, by kind of
# regime and channel
Errors = Mapping[tuple[str, str], Array]

OUTER: Final = 0.2  # share of the pieces that are slowest, and that are fastest
APART: Final = 1.1  # times; a median closer to that of the other pieces is the same kind
FEWEST: Final = 20  # pieces of a kind
WORSE: Final = 1.02  # of the error; above it forecasts are worse, if by more than chance
CHANCE: Final = 2.0  # standard errors of the mean difference between flights
ROUNDS: Final = 2  # most steps of a fit without an effect, or without a kind
MOST: Final = 300  # pieces, to limit time
CHANNELS: Final[dict[str, slice]] = {'position': slice(0, 3), 'attitude': slice(3, 6)}
SPEED: Final = slice(7, 10)  # of a state: its velocity
TURN: Final = 12  # of a state: its yaw rate
NAMES: Final = {
    'speed': ('slower than {:.2g} m/s', 'faster than {:.2g} m/s'),
    'turn': ('turns below {:.2g} rad/s', 'turns above {:.2g} rad/s'),
}


@final
class RejectedEffect(NamedTuple):
    """An effect that makes forecasts worse in a regime of another kind, and where."""

    name: str
    kind: str
    channel: str
    ratio: float

    @property
    def sentence(self) -> str:
        """Reason in one clause."""
        if math.isinf(self.ratio):
            return (
                f'{self.name}: rejected, as forecasts of {self.channel} with it diverge in flight '
                f'of another kind ({self.kind})'
            )
        return (
            f'{self.name}: rejected, as it makes forecasts of {self.channel} '
            f'{100.0 * (self.ratio - 1.0):.0f} % worse in flight of another kind ({self.kind})'
        )


@final
class KindJudgement(NamedTuple):
    """Effects that are kept and rejected, and the errors of the kept ones by kind of regime."""

    accepted: Sequence[CandidateGroup]
    rejected: Sequence[RejectedEffect]
    kinds: Sequence[LeftOutKind]


@final
class KindSplit(NamedTuple):
    """Flights in parts of different kinds, and the parts of each kind."""

    sight: ForecastFitter
    kinds: Mapping[str, Sequence[int]]


def split_by_kind(
    nominal: NominalVehicle, flights: Sequence[FlightLinearizer], lift: float
) -> list[KindSplit]:
    """Return the flights split by speed and by rate of turn, where these differ enough."""
    some = _thin_pieces(flights)
    starts = [one.replay.cut.start for one in some]
    sizes = {
        'speed': [np.linalg.norm(start[:, SPEED], axis=1) for start in starts],
        'turn': [np.abs(start[:, TURN]) for start in starts],
    }
    out = []
    for quantity, values in sizes.items():
        every = np.concatenate(values)
        ends = np.quantile(every, (OUTER, 1.0 - OUTER))
        sides = [np.digitize(each, ends) for each in values]
        # Each flight in up to three parts: low, between, high
        parts = [
            (which, select_pieces(flight, side == which))
            for flight, side in zip(some, sides, strict=True)
            for which in range(3)
            if (side == which).any()
        ]
        kinds = {
            name.format(end): [k for k, (part, _) in enumerate(parts) if part == which]
            for which, name, end in zip((0, 2), NAMES[quantity], ends, strict=True)
            if _is_other_kind(every, np.concatenate(sides) == which)
        }
        if kinds:
            out.append(KindSplit(ForecastFitter(nominal, [one for _, one in parts], lift), kinds))
    return out


def _is_other_kind(values: Array, inside: NDArray[np.bool_]) -> bool:
    """Return whether enough pieces differ clearly from all others."""
    if inside.sum() < FEWEST or inside.all():
        return False
    low, high = sorted((float(np.median(values[inside])), float(np.median(values[~inside]))))
    return high > APART * low


def _thin_pieces(flights: Sequence[FlightLinearizer]) -> list[FlightLinearizer]:
    """Return flights with every n-th of all pieces, so that at most `MOST` remain."""
    counts = [len(one.replay.first) for one in flights]
    every = np.arange(sum(counts)) % -(-sum(counts) // MOST) == 0
    masks = np.split(every, np.cumsum(counts)[:-1])
    pairs = zip(flights, masks, strict=True)
    return [select_pieces(flight, mask) for flight, mask in pairs if mask.any()]


def select_pieces(flight: FlightLinearizer, which: NDArray[np.bool_]) -> FlightLinearizer:
    """Return a flight with some of its pieces; `which` has shape (S,)."""
    cut = flight.replay.cut
    some = replace(cut, first=cut.first[which], start=cut.start[which], inside=cut.inside[which])
    return FlightLinearizer(flight.replay.with_pieces(some), flight.knobs, flight.places)


def judge_by_kind(
    sight: ForecastFitter,
    groups: Sequence[CandidateGroup],
    values: Array,
    splits: Sequence[KindSplit],
) -> KindJudgement:
    """
    Return the effects that make no forecast in a regime of another kind worse, and the others.

    `groups`: the effects. `values`, shape (G,): fitted to all flights. `splits`: of
    `split_by_kind`; if there are none, all effects are kept.
    """
    lost: list[RejectedEffect] = []
    remaining = list(groups)
    if not splits:
        return KindJudgement(remaining, lost, ())
    file = _errors_by_kind(splits, [], np.zeros_like(values))
    own = _errors_by_kind(splits, remaining, values)
    while remaining:
        harm = dict[CandidateGroup, RejectedEffect]()
        without = dict[CandidateGroup, tuple[Array, Errors]]()
        for group in remaining:
            rest = [one for one in remaining if one != group]
            fitted = _fit(sight, rest, range(len(sight.flights)), values)
            errors = _errors_by_kind(splits, rest, fitted) if rest else file
            without[group] = fitted, errors
            harm[group] = _worst(group.name, own, errors)
        worst = max(remaining, key=lambda group: harm[group].ratio)
        whole = _worst(worst.name, own, file)
        if max(harm[worst].ratio, whole.ratio) <= WORSE:
            break
        lost.append(harm[worst] if harm[worst].ratio > WORSE else whole)
        remaining.remove(worst)
        values, own = without[worst]
    names = list(dict.fromkeys(kind for kind, _ in file))
    return KindJudgement(
        remaining,
        lost,
        [
            LeftOutKind(kind, *(_ratio(own[kind, each], file[kind, each]) for each in CHANNELS))
            for kind in names
        ],
    )


def _fit(
    sight: ForecastFitter, groups: Sequence[CandidateGroup], flights: Sequence[int], begin: Array
) -> Array:
    """Return values of some effects, fitted to some flights; all others are zero."""
    which = list_knobs(groups)
    start = np.where(np.isin(np.arange(len(begin)), which), begin, 0.0)
    if not which:
        return start
    spread = prior_deviations(sight.knobs, which)
    return sight.fit(which, spread, flights, start, ROUNDS, relinearize=False).values


def _errors_by_kind(
    splits: Sequence[KindSplit], groups: Sequence[CandidateGroup], values: Array
) -> Errors:
    """Return the errors of each kind with the values of the other pieces."""
    out = dict[tuple[str, str], Array]()
    for sight, kinds in splits:
        for kind, inside in kinds.items():
            others = [k for k in range(len(sight.flights)) if k not in set(inside)]
            # Fitted, not one step: left-out pieces of another kind are far from the others
            fitted = _fit(sight, groups, others, values)
            for channel, columns in CHANNELS.items():
                out[kind, channel] = np.array(
                    [sight.rms_error(fitted, [part], columns, np.inf) ** 2 for part in inside]
                ) * [len(sight.flights[part].replay.first) for part in inside]
    return out


def _ratio(own: Array, other: Array) -> float:
    """Return the ratio of two errors; infinite if forecasts diverge with the first alone."""
    if (np.isinf(own) & np.isfinite(other)).any():
        return math.inf
    finite = np.isfinite(own) & np.isfinite(other)
    return float(np.sqrt(own[finite].sum() / other[finite].sum())) if finite.any() else 1.0


def _worst(name: str, own: Errors, other: Errors) -> RejectedEffect:
    """Return where forecasts with an effect are worst, compared with others."""

    def ratio(where: tuple[str, str]) -> float:
        worst_ratio = _ratio(own[where], other[where])
        finite = np.isfinite(own[where]) & np.isfinite(other[where])
        more = own[where][finite] - other[where][finite]
        # A difference within its standard error, which one flight does not tell, counts as none
        chance = CHANCE * np.std(more, ddof=1) * len(more) ** 0.5 if len(more) > 1 else np.inf
        return (
            min(worst_ratio, 1.0)
            if more.sum() <= chance and math.isfinite(worst_ratio)
            else worst_ratio
        )

    kind, channel = max(own, key=ratio)
    return RejectedEffect(name, kind, channel, ratio((kind, channel)))
