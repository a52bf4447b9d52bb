"""Many judged cases as shares with their intervals, the figures that are to be reached beside."""

from collections.abc import Callable, Iterable, Sequence
from itertools import pairwise
import math
from typing import Final, final, NamedTuple

from lta_challenge.judged import Judged
from lta_flight.sweep.statistics import wilson
import numpy as np

CLEAR: Final = 6.0  # deviations
WEAK: Final = 3.0
ORACLE: Final = 1.05
# Kinds outside the library: those known while discovery was made, and those kept from it.
EARLY: Final = ', early kinds'
LATE: Final = ', late kinds'
BANDS: Final = (0.0, 3.0, 6.0, 10.0, 20.0, 50.0, math.inf)


@final
class Counted(NamedTuple):
    """How many of how many, and the share with its 95 % interval; NaN of none."""

    hits: int
    of: int
    value: float
    low: float
    high: float


def counted(hits: int, count: int) -> Counted:
    """Return a share with Wilson's interval."""
    return Counted(hits, count, *wilson(hits, count))


@final
class Figure(NamedTuple):
    """
    One figure.

    Attributes
    ----------
    name : str
        What it counts.
    share : Counted
        How many of how many, with Wilson's interval of 95 %.
    least, most : float
        Between which it is to be; NaN where nothing is asked for.

    """

    name: str
    share: Counted
    least: float = math.nan
    most: float = math.nan

    @property
    def met(self) -> str:
        """'yes', 'no', or '' where nothing is asked for or there is no case."""
        if self.share.of == 0 or (math.isnan(self.least) and math.isnan(self.most)):
            return ''
        value = self.share.value
        enough = math.isnan(self.least) or value >= self.least - 1e-12
        few = math.isnan(self.most) or value <= self.most + 1e-12
        return 'yes' if enough and few else 'no'


def _share(cases: Iterable[Judged], test: Callable[[Judged], bool]) -> Counted:
    """Return how many of some cases pass."""
    hits = [test(one) for one in cases]
    return counted(sum(hits), len(hits))


def _of(cases: Sequence[Judged], kind: str) -> list[Judged]:
    """Return the cases of a kind."""
    return [one for one in cases if one.kind == kind]


def _between(cases: Sequence[Judged], low: float, high: float) -> list[Judged]:
    """Return cases of which the weakest hidden effect is that strong."""
    return [one for one in cases if low <= one.weakest < high]


def _exact(one: Judged) -> bool:
    """Tell whether all that was hidden was named, and nothing else."""
    return one.exact


def _wrong(one: Judged) -> bool:
    """Tell whether anything was named that was not hidden."""
    return bool(one.wrong)


def _promised(one: Judged) -> bool:
    """Tell whether something was missed that is larger than what was said to be seen."""
    return bool(one.promised)


def _flagged(one: Judged) -> bool:
    """Tell whether something was called unexplained."""
    return one.flagged


def _of_names(cases: Sequence[Judged]) -> list[Figure]:
    """Return the figures of cases in which effects of the library are hidden, or nothing."""
    single, pair, clean = (_of(cases, kind) for kind in ('single', 'pair', 'clean'))
    clear, weak = _between(single, CLEAR, math.inf), _between(single, WEAK, CLEAR)
    both = _between(pair, CLEAR, math.inf)
    silent = [one for one in single if one.outcome == 'silent']
    return [
        Figure('one effect, 6 sigma or more: exact', _share(clear, _exact), least=0.97),
        Figure('one effect, 3 to 6 sigma: exact', _share(weak, _exact), least=0.70),
        Figure('one effect: a wrong name', _share(single, _wrong), most=0.02),
        Figure('one effect: silent', _share(single, lambda one: one.outcome == 'silent')),
        Figure('one effect: silent, of a size to be seen', _share(silent, _promised), most=0.05),
        Figure('one effect: also unexplained', _share(single, _flagged)),
        Figure('two effects, both 6 sigma or more: both exact', _share(both, _exact), least=0.85),
        Figure('two effects: a wrong name', _share(pair, _wrong)),
        Figure('nothing hidden: any name', _share(clean, lambda one: bool(one.named)), most=0.01),
        Figure('nothing hidden: unexplained', _share(clean, _flagged)),
    ]


def _of_outside(cases: Sequence[Judged]) -> list[Figure]:
    """Return the figures of cases in which something is hidden that is in no library."""
    early = [one for one in cases if one.outside and not one.late]
    late = [one for one in cases if one.late]
    return [*_unexplained(cases), *_unexplained(early, EARLY), *_unexplained(late, LATE)]


def _unexplained(cases: Sequence[Judged], when: str = '') -> list[Figure]:
    """Return the figures of what is outside alone, and beside an effect that is strong."""
    outside, strong = _of(cases, 'outside'), _between(_of(cases, 'mixed'), CLEAR, math.inf)
    both = _share(strong, lambda one: one.exact and one.flagged)
    return [
        Figure(f'outside the library{when}: unexplained', _share(outside, _flagged), least=0.90),
        Figure(f'outside the library{when}: a name', _share(outside, _wrong), most=0.03),
        Figure(f'an effect and something outside{when}: named and unexplained', both, least=0.75),
    ]


def _of_values(cases: Sequence[Judged]) -> list[Figure]:
    """Return the figures of intervals and of held-out errors."""
    intervals = [each for one in cases for each in one.intervals]
    covered = counted(sum(each.covers for each in intervals), len(intervals))
    near = [one for one in cases if {'after', 'oracle'} <= set(one.errors)]
    near = [one for one in near if one.kind in ('clean', 'single', 'pair')]
    good = _share(near, lambda one: one.errors['after'] <= ORACLE * one.errors['oracle'])
    return [
        Figure('intervals of 95 % that hold the truth', covered, 0.90, 0.98),
        Figure('held-out error within 1.05 of the oracle', good),
    ]


def figures(cases: Sequence[Judged]) -> list[Figure]:
    """Return all figures of some cases of one row."""
    silent = Figure('no answer', _share(cases, lambda one: bool(one.refused)))
    torn = _share(cases, lambda one: bool(one.contradictions))
    rest = [silent, Figure('the study contradicts itself', torn, most=0.0)]
    return [*_of_names(cases), *_of_outside(cases), *_of_values(cases), *rest]


@final
class Band(NamedTuple):
    """Single effects of some strength: how often exact, wrong, silent."""

    low: float
    high: float
    exact: Counted
    wrong: Counted
    silent: Counted


def by_strength(cases: Sequence[Judged]) -> list[Band]:
    """Return how often single effects are exact, wrong and silent, by band of strength."""
    single = _of(cases, 'single')
    out = []
    for low, high in pairwise(BANDS):
        band = _between(single, low, high)
        shares = (
            _share(band, lambda one: one.outcome == 'exact'),
            _share(band, lambda one: one.outcome == 'wrong'),
            _share(band, lambda one: one.outcome == 'silent'),
        )
        out.append(Band(low, high, *shares))
    return out


def middle(values: Iterable[float]) -> float:
    """Return the median; NaN of none."""
    known = [value for value in values if math.isfinite(value)]
    return float(np.median(known)) if known else math.nan


def ladder(cases: Sequence[Judged]) -> dict[str, float]:
    """Return the medians of the errors of cases in which something of the library is hidden."""
    some = [one.errors for one in cases if one.kind in ('single', 'pair') and one.errors]
    names = ('coast', 'before', 'tuned', 'after', 'oracle', 'noise')
    return {name: middle(each[name] for each in some if name in each) for name in names}


def matrix(cases: Sequence[Judged]) -> dict[str, dict[str, int]]:
    """Return how often each kind of case came to each outcome."""
    out: dict[str, dict[str, int]] = {}
    for one in cases:
        column = one.outcome + (' + unexplained' if one.flagged else '')
        cells = out.setdefault(one.kind, {})
        cells[column] = cells.get(column, 0) + 1
    return out
