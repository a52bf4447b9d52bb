"""Decide whether values satisfy the rule of a claim: one value, or the draws of a measure."""

from collections import Counter
from collections.abc import Sequence
import math
from typing import Final, NamedTuple

from lta_config.quantity import Quantity
from lta_config.schema.paper_file import AgreementRule
import numpy as np

ROUNDING: Final = 1e-9  # relative tolerance for rounding differences between machines
SURE: Final = 0.95  # share of the draws that makes a verdict


class DrawSummary(NamedTuple):
    """The values of a measure over the draws from the ranges of what is assumed."""

    drawn: int  # number of draws
    share: float  # share of them that satisfies the rule of the claim
    middle: float | str  # median, or the most frequent word [SI]
    # 5 % and 95 % quantiles of the draws; NaN for words [SI]
    low: float = math.nan
    high: float = math.nan
    missing: int = 0  # draws without a value, such as the path of a flight that did not arrive


def summarize_draws(
    rule: AgreementRule, printed: Quantity | None, values: Sequence[float | str]
) -> DrawSummary:
    """Return the summary of draws; values that do not exist (NaN) satisfy no rule."""
    share = sum(is_satisfied(rule, printed, value) for value in values) / len(values)
    if isinstance(values[0], str):
        return DrawSummary(len(values), share, Counter(values).most_common(1)[0][0])
    numbers = [value for value in values if not isinstance(value, str) and math.isfinite(value)]
    missing = len(values) - len(numbers)
    if not numbers:
        return DrawSummary(len(values), share, math.nan, missing=missing)
    low, middle, high = map(float, np.quantile(numbers, [0.05, 0.5, 0.95]))
    return DrawSummary(len(values), share, middle, low, high, missing)


def is_satisfied(rule: AgreementRule, printed: Quantity | None, value: float | str) -> bool:
    """Return whether a value satisfies a rule; NaN never does."""
    if isinstance(value, str):
        return value == rule.word
    low, high = agreement_bounds(rule, printed)
    # An open bound is infinite and gives no scale.
    slack = ROUNDING * max(abs(bound) for bound in (low, high, 0.0) if math.isfinite(bound))
    return low - slack <= value <= high + slack


def agreement_bounds(rule: AgreementRule, printed: Quantity | None) -> tuple[float, float]:
    """Return the bounds within which a value agrees. [SI]"""
    if rule.within is not None and printed is not None:
        # `within` is relative to the printed number.
        half = rule.within.si * abs(printed.si)
        return printed.si - half, printed.si + half
    low = -math.inf if rule.least is None else rule.least.si
    return low, math.inf if rule.most is None else rule.most.si
