"""Judge whether a claim agrees with the measured value, by the rule in its file."""

from collections import Counter
from collections.abc import Iterable, Mapping
from enum import StrEnum
import math
from typing import Final

from lta_config.quantity import format_with_unit, Quantity
from lta_config.schema.paper_file import AgreementRule, PaperClaim, PaperMeasure, PaperRow
from lta_report.formatting import format_number, MISSING
from lta_studies.reproduce.study_result import MeasuredValue

SIGNS: Final = {
    'deg': '°',
    'm2': 'm²',
    'cm2': 'cm²',
    'mm2': 'mm²',
    'us': 'µs',
}  # typeset units
PLAIN: Final = 1e-9  # relative tolerance for rounding differences between machines


class ClaimVerdict(StrEnum):
    """Verdict on a claim."""

    AGREES = 'agrees'
    DIFFERS = 'differs'
    UNTESTED = 'cannot be tested here'
    BEYOND = 'beyond the paper'
    LEFT_OUT = 'left out of --quick'


def judge_claim(claim: PaperClaim, values: Mapping[str, MeasuredValue]) -> ClaimVerdict:
    """Return the verdict on a claim."""
    # Without a measure nothing was measured; without a rule the paper made no claim.
    if claim.measure is None:
        return ClaimVerdict.UNTESTED
    if claim.rule is None:
        return ClaimVerdict.BEYOND
    if claim.measure not in values:
        return ClaimVerdict.LEFT_OUT
    value = values[claim.measure].value
    return (
        ClaimVerdict.AGREES
        if is_satisfied(claim.rule, claim.value, value)
        else ClaimVerdict.DIFFERS
    )


def is_satisfied(rule: AgreementRule, printed: Quantity | None, value: float | str) -> bool:
    """Return whether a value satisfies a rule; NaN never does."""
    if isinstance(value, str):
        return value == rule.word
    low, high = agreement_bounds(rule, printed)
    # An open bound is infinite and gives no scale.
    slack = PLAIN * max(abs(bound) for bound in (low, high, 0.0) if math.isfinite(bound))
    return low - slack <= value <= high + slack


def agreement_bounds(rule: AgreementRule, printed: Quantity | None) -> tuple[float, float]:
    """Return the bounds within which a value agrees. [SI]"""
    if rule.within is not None and printed is not None:
        # `within` is relative to the printed number.
        half = rule.within.si * abs(printed.si)
        return printed.si - half, printed.si + half
    low = -math.inf if rule.least is None else rule.least.si
    return low, math.inf if rule.most is None else rule.most.si


def judge_claims(row: PaperRow, values: Mapping[str, MeasuredValue]) -> dict[str, ClaimVerdict]:
    """Return the verdict on each claim of a row."""
    return {name: judge_claim(claim, values) for name, claim in row.claims.items()}


def count_verdicts(verdicts: Iterable[ClaimVerdict]) -> dict[ClaimVerdict, int]:
    """Count the verdicts, in the order of `ClaimVerdict`."""
    counts = Counter(verdicts)
    return {each: counts[each] for each in ClaimVerdict}


def format_rule(rule: AgreementRule) -> str:
    """Format a rule in words."""
    if rule.word is not None:
        return f'is {rule.word}'
    if rule.within is not None:
        return f'within {format_quantity(rule.within)}'
    ends = [('at least', rule.least), ('at most', rule.most)]
    return ' and '.join(f'{word} {format_quantity(end)}' for word, end in ends if end is not None)


def format_quantity(quantity: Quantity) -> str:
    """Format a quantity of a file."""
    return append_unit(f'{quantity.value:.12g}'.replace('-', '\N{MINUS SIGN}'), quantity.unit)


def format_value(
    measure: PaperMeasure, value: MeasuredValue | None, *, interval: bool = True
) -> str:
    """Format a value, with its interval if it has one."""
    if value is None:
        return MISSING
    if isinstance(value.value, str) or measure.unit is None:
        return str(value.value)
    if math.isnan(value.value):
        return 'never'
    texts = [format_rounded(measure, each) for each in (value.value, value.low, value.high)]
    text = texts[0]
    # Without the interval if all three round to the same number
    if interval and not math.isnan(value.low) and len(set(texts)) > 1:
        text += f' ({texts[1]} to {texts[2]})'
    return append_unit(text, measure.unit)


def append_unit(text: str, unit: str) -> str:
    """Append the typeset unit to a number."""
    return f'{text}°' if unit == 'deg' else format_with_unit(text, SIGNS.get(unit, unit))


def format_rounded(measure: PaperMeasure, value: float) -> str:
    """Format a number in the unit and precision of its measure."""
    scaled = value / measure.factor
    if not math.isfinite(scaled):
        return MISSING
    # Negative digits round to tens or hundreds.
    return format_number(round(scaled, measure.digits), max(0, measure.digits))


def fill_measures(text: str, row: PaperRow, values: Mapping[str, MeasuredValue]) -> str:
    """Fill in the measures of a text."""
    words = {
        name: format_value(measure, values.get(name), interval=False)
        for name, measure in row.measures.items()
    }
    return text.format_map(words)
