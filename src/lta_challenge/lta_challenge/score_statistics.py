"""Summarize scored cases as shares with intervals, and compare them with targets."""

from collections.abc import Callable, Iterable, Sequence
from functools import partial
from itertools import pairwise
import math
from typing import Final, final, NamedTuple

from lta_challenge.case_score import ScoredCase
from lta_challenge.rows import find_challenge_row
from lta_flight.sweep.statistics import wilson_interval
import numpy as np

CLEAR: Final = 6.0  # sigma; effects from this strength on should be named
WEAK: Final = 3.0  # sigma
SIZED: Final = 0.3  # of the true size; largest error of an unexplained force
ORACLE: Final = 1.05  # held-out error relative to the oracle's
NO_WORSE: Final = 1.05  # error of a fit on its own flights, by that of the vehicle file
NEAR: Final = 1.3  # held-out error by that of the oracle that knows the equation outside
FAULTY: Final = 'study ended in a traceback'
FITTED: Final = {'tuned': 'tuned model', 'after': 'final model'}
# Kinds outside the library: known during the development of discovery, or written independently
EARLY: Final = ' (early kinds)'
LATE: Final = ' (late kinds)'
BANDS: Final = (0.0, 3.0, 6.0, 10.0, 20.0, 50.0, math.inf)


@final
class ShareEstimate(NamedTuple):
    """A share: counts, value and 95 % interval; NaN if there are no cases."""

    hits: int
    of: int
    value: float
    low: float
    high: float


def estimate_share(hits: int, count: int) -> ShareEstimate:
    """Return a share with Wilson's interval."""
    return ShareEstimate(hits, count, *wilson_interval(hits, count))


@final
class ScoreFigure(NamedTuple):
    """A figure of the score."""

    name: str  # label
    share: ShareEstimate  # share with Wilson's 95 % interval
    # Target range; NaN for no bound
    least: float = math.nan
    most: float = math.nan

    @property
    def target_met(self) -> str:
        """'yes', 'no', or '' without a target or without cases."""
        if self.share.of == 0 or (math.isnan(self.least) and math.isnan(self.most)):
            return ''
        value = self.share.value
        # The tolerance absorbs rounding, such as 0.97 as 97 / 100
        enough = math.isnan(self.least) or value >= self.least - 1e-12
        few = math.isnan(self.most) or value <= self.most + 1e-12
        return 'yes' if enough and few else 'no'


def _estimate_passing_share(
    cases: Iterable[ScoredCase], test: Callable[[ScoredCase], bool]
) -> ShareEstimate:
    """Return the share of cases that pass a test."""
    hits = [test(one) for one in cases]
    return estimate_share(sum(hits), len(hits))


def _select_kind(cases: Sequence[ScoredCase], kind: str) -> list[ScoredCase]:
    return [one for one in cases if one.kind == kind]


def _select_strength(cases: Sequence[ScoredCase], low: float, high: float) -> list[ScoredCase]:
    """Return the cases whose weakest hidden effect is in a range of strengths."""
    return [one for one in cases if low <= one.weakest < high]


def _is_exact(one: ScoredCase) -> bool:
    """Return whether all hidden effects were named, and nothing else."""
    return one.exact


def _has_wrong_name(one: ScoredCase) -> bool:
    """Return whether an effect was named that was not hidden."""
    return bool(one.wrong)


def _has_detectable_miss(one: ScoredCase) -> bool:
    """Return whether an effect was missed that is larger than the reported detection limit."""
    return bool(one.promised)


def _is_flagged(one: ScoredCase) -> bool:
    """Return whether an unexplained force was reported."""
    return one.flagged


def _naming_figures(cases: Sequence[ScoredCase]) -> list[ScoreFigure]:
    """Return the figures of cases with hidden effects of the library, or with none."""
    single, pair, clean = (_select_kind(cases, kind) for kind in ('single', 'pair', 'clean'))
    clear, weak = _select_strength(single, CLEAR, math.inf), _select_strength(single, WEAK, CLEAR)
    both = _select_strength(pair, CLEAR, math.inf)
    silent = [one for one in single if one.outcome == 'silent']
    return [
        ScoreFigure(
            'one hidden effect, 6 sigma or more: named exactly',
            _estimate_passing_share(clear, _is_exact),
            least=0.97,
        ),
        ScoreFigure(
            'one hidden effect, 3 to 6 sigma: named exactly',
            _estimate_passing_share(weak, _is_exact),
            least=0.70,
        ),
        ScoreFigure(
            'one hidden effect: a wrong one named',
            _estimate_passing_share(single, _has_wrong_name),
            most=0.02,
        ),
        ScoreFigure(
            'one hidden effect: none named',
            _estimate_passing_share(single, lambda one: one.outcome == 'silent'),
        ),
        ScoreFigure(
            'one hidden effect, none named: above the detection limit',
            _estimate_passing_share(silent, _has_detectable_miss),
            most=0.05,
        ),
        ScoreFigure(
            'one hidden effect: unexplained force reported',
            _estimate_passing_share(single, _is_flagged),
        ),
        ScoreFigure(
            'two hidden effects, both 6 sigma or more: named exactly',
            _estimate_passing_share(both, _is_exact),
            least=0.85,
        ),
        ScoreFigure(
            'two hidden effects: a wrong one named', _estimate_passing_share(pair, _has_wrong_name)
        ),
        ScoreFigure(
            'no hidden effect: an effect named',
            _estimate_passing_share(clean, lambda one: bool(one.named)),
            most=0.01,
        ),
        ScoreFigure(
            'no hidden effect: unexplained force reported',
            _estimate_passing_share(clean, _is_flagged),
        ),
    ]


def _clean_law_figure(cases: Sequence[ScoredCase]) -> list[ScoreFigure]:
    """Return the figure of laws where nothing is hidden."""
    clean = _select_kind(cases, 'clean')
    return [
        ScoreFigure(
            'no hidden effect: a law proposed',
            _estimate_passing_share(clean, lambda one: one.law is True),
            most=0.01,
        )
    ]


def _outside_figures(cases: Sequence[ScoredCase]) -> list[ScoreFigure]:
    """Return the figures of cases with an effect outside the library."""
    early = [one for one in cases if one.outside and not one.late]
    late = [one for one in cases if one.late]
    return [
        *_clean_law_figure(cases),
        *_unexplained_figures(cases),
        *_unexplained_figures(early, EARLY),
        *_unexplained_figures(late, LATE),
    ]


def _unexplained_figures(cases: Sequence[ScoredCase], when: str = '') -> list[ScoreFigure]:
    """Return the figures of effects outside the library, alone and with a strong effect."""
    outside, strong = (
        _select_kind(cases, 'outside'),
        _select_strength(_select_kind(cases, 'mixed'), CLEAR, math.inf),
    )
    both = _estimate_passing_share(strong, lambda one: one.exact and one.flagged)
    # A line of the spectrum has no size in noise floors
    sized = [one for one in outside if one.flagged and min(one.remainder, one.floors) > 0.0]
    return [
        ScoreFigure(
            f'effect outside the library{when}: unexplained force reported',
            _estimate_passing_share(outside, _is_flagged),
            least=0.90,
        ),
        ScoreFigure(
            f'effect outside the library{when}: an effect named',
            _estimate_passing_share(outside, _has_wrong_name),
            most=0.03,
        ),
        ScoreFigure(
            f'effect outside the library{when}: size of the force within 30 %',
            _estimate_passing_share(
                sized, lambda one: abs(one.remainder / one.floors - 1.0) <= SIZED
            ),
        ),
        ScoreFigure(
            f'one effect in and one outside the library{when}: both reported', both, least=0.75
        ),
        *_law_figures(outside, when),
    ]


def _law_figures(outside: Sequence[ScoredCase], when: str) -> list[ScoreFigure]:
    """Return the figures of laws; none where none was sought."""
    if all(one.law is None for one in outside):
        return []
    # The oracle that knows the equation flies only where an unexplained force was reported
    cases_with_oracle = [one for one in outside if one.oracle_ratios]
    flagged = f'effect outside the library{when}, flagged'
    return [
        ScoreFigure(
            f'effect outside the library{when}: a law proposed',
            _estimate_passing_share(outside, lambda one: one.law is True),
        ),
        ScoreFigure(
            f'{flagged}: forecasts within {NEAR:g} of the oracle',
            _estimate_passing_share(
                cases_with_oracle, lambda one: one.oracle_ratios['law'] <= NEAR
            ),
            least=0.55,
        ),
        ScoreFigure(
            f'{flagged}: the same without laws',
            _estimate_passing_share(
                cases_with_oracle, lambda one: one.oracle_ratios['tuned'] <= NEAR
            ),
        ),
    ]


def _value_figures(cases: Sequence[ScoredCase]) -> list[ScoreFigure]:
    """Return the figures of parameter intervals and held-out errors."""
    intervals = [each for one in cases for each in one.intervals]
    covered = estimate_share(sum(each.covers for each in intervals), len(intervals))
    # Only cases that have both errors can be compared
    near = [one for one in cases if {'after', 'oracle'} <= set(one.errors)]
    near = [one for one in near if one.kind in ('clean', 'single', 'pair')]
    good = _estimate_passing_share(
        near, lambda one: one.errors['after'] <= ORACLE * one.errors['oracle']
    )
    return [
        ScoreFigure('95 % intervals that contain the true value', covered, 0.90, 0.98),
        ScoreFigure('held-out error at most 1.05 times that of the oracle', good),
    ]


def compute_score_figures(cases: Sequence[ScoredCase]) -> list[ScoreFigure]:
    """Return all figures of the cases of one row."""
    silent = ScoreFigure(
        'discovery refused the flights',
        _estimate_passing_share(cases, lambda one: bool(one.refused)),
    )
    torn = _estimate_passing_share(cases, lambda one: bool(one.contradictions))
    rest = [silent, ScoreFigure('outputs of the study contradict each other', torn, most=0.0)]
    # What should be named is unknown where the vehicle file is wrong
    named = [one for one in cases if not find_challenge_row(one.row).rough]
    return [
        *_naming_figures(named),
        *_outside_figures(named),
        *_value_figures(named),
        *rest,
        *_fit_figures(cases),
    ]


def _is_no_worse(model: str, one: ScoredCase) -> bool:
    """Return whether a model predicts the flights of its fit as well as the vehicle file."""
    return one.training[model] <= NO_WORSE


def _fit_figures(cases: Sequence[ScoredCase]) -> list[ScoreFigure]:
    """Return the figures of fits that must not diverge."""
    fitted = [one for one in cases if one.training]
    forecast = [one for one in cases if {'after', 'coast'} <= set(one.errors)]
    return [
        ScoreFigure(
            FAULTY, _estimate_passing_share(cases, lambda one: bool(one.traceback)), most=0.0
        ),
        *(
            ScoreFigure(
                f'{words} predicts its own flights as well as the vehicle file',
                _estimate_passing_share(fitted, partial(_is_no_worse, model)),
                least=1.0,
            )
            for model, words in FITTED.items()
        ),
        ScoreFigure(
            'final model predicts better than constant velocity after 3 s',
            _estimate_passing_share(
                forecast, lambda one: one.errors['after'] < one.errors['coast']
            ),
        ),
    ]


@final
class StrengthBand(NamedTuple):
    """Shares of exact, wrong and silent results for single effects in a range of strengths."""

    low: float
    high: float
    exact: ShareEstimate
    wrong: ShareEstimate
    silent: ShareEstimate


def shares_by_strength(cases: Sequence[ScoredCase]) -> list[StrengthBand]:
    """Return the shares of results for single effects, by band of strength."""
    single = _select_kind(cases, 'single')
    out = []
    for low, high in pairwise(BANDS):
        band = _select_strength(single, low, high)
        shares = (
            _estimate_passing_share(band, lambda one: one.outcome == 'exact'),
            _estimate_passing_share(band, lambda one: one.outcome == 'wrong'),
            _estimate_passing_share(band, lambda one: one.outcome == 'silent'),
        )
        out.append(StrengthBand(low, high, *shares))
    return out


def finite_median(values: Iterable[float]) -> float:
    """Return the median of the finite values; NaN if there are none."""
    finite = [value for value in values if math.isfinite(value)]
    return float(np.median(finite)) if finite else math.nan


def median_errors(cases: Sequence[ScoredCase]) -> dict[str, float]:
    """Return the median errors of the cases with hidden effects of the library, by model."""
    some = [one.errors for one in cases if one.kind in ('single', 'pair') and one.errors]
    # From the worst model to the best possible: constant velocity to measurement noise
    names = ('coast', 'before', 'tuned', 'after', 'oracle', 'noise')
    return {name: finite_median(each[name] for each in some if name in each) for name in names}


def count_outcomes(cases: Sequence[ScoredCase]) -> dict[str, dict[str, int]]:
    """Count the outcomes by kind of case."""
    out: dict[str, dict[str, int]] = {}
    for one in cases:
        # A case may name an effect and report an unexplained force as well
        column = one.outcome + (' + unexplained' if one.flagged else '')
        cells = out.setdefault(one.kind, {})
        cells[column] = cells.get(column, 0) + 1
    return out
