"""
Judge whether a claim agrees with what is measured here, by the rule in its file.

A claim agrees if the rule holds in at least 95 % of the draws from the ranges of what is assumed,
in each of its readings; it differs if the rule fails in at least 95 % of them, in each reading.
Anything between is within our uncertainty. A measure that depends on nothing assumed, or that was
not drawn, counts as it is.
"""

from collections import Counter
from collections.abc import Iterable, Mapping
from enum import StrEnum
import math
from typing import Final

from lta_config.quantity import format_with_unit, Quantity
from lta_config.schema.paper_file import AgreementRule, PaperClaim, PaperMeasure, PaperRow
from lta_report.formatting import format_number, MISSING
from lta_studies.reproduce.agreement import DrawSummary, is_satisfied, SURE
from lta_studies.reproduce.stored_row import StoredRow
from lta_studies.reproduce.study_result import MeasuredValue

SIGNS: Final = {
    'deg': '°',
    'm2': 'm²',
    'cm2': 'cm²',
    'mm2': 'mm²',
    'us': 'µs',
}  # typeset units


class ClaimVerdict(StrEnum):
    """Verdict on a claim."""

    AGREES = 'agrees'
    DIFFERS = 'differs'
    UNCERTAIN = 'within our uncertainty'
    UNTESTED = 'cannot be tested'
    CONSTRUCTION = 'agrees by construction'
    VACUOUS = 'agrees, but says nothing'
    BEYOND = 'beyond the paper'
    LEFT_OUT = 'not measured in this run'


def judge_claim(name: str, claim: PaperClaim, stored: StoredRow) -> ClaimVerdict:
    """Return the verdict on a claim of a stored row."""
    # Without a measure nothing was measured; without a rule the paper made no claim.
    if claim.measure is None:
        return ClaimVerdict.UNTESTED
    if claim.rule is None:
        return ClaimVerdict.BEYOND
    if claim.measure not in stored.values:
        return ClaimVerdict.LEFT_OUT
    # --quick may leave out readings; its verdicts are preliminary
    measured = [each for each in claim.measures.values() if each in stored.values]
    shares = [satisfied_share(name, claim, measure, stored) for measure in measured]
    if all(share <= 1.0 - SURE for share in shares):
        return ClaimVerdict.DIFFERS
    if not all(share >= SURE for share in shares):
        return ClaimVerdict.UNCERTAIN
    if claim.construction:
        return ClaimVerdict.CONSTRUCTION
    empty = stored.values.get(claim.vacuous or '')
    if empty is not None and empty.value == 'yes':
        return ClaimVerdict.VACUOUS
    return ClaimVerdict.AGREES


def satisfied_share(name: str, claim: PaperClaim, measure: str, stored: StoredRow) -> float:
    """Return the share of the draws of a measure that satisfies the rule of a claim."""
    summary = find_summary(name, measure, stored)
    if summary is not None:
        return summary.share
    assert claim.rule is not None
    return float(is_satisfied(claim.rule, claim.value, stored.values[measure].value))


def find_summary(name: str, measure: str, stored: StoredRow) -> DrawSummary | None:
    """Return the summary of the draws of a measure of a claim; None if it was not drawn."""
    return stored.draws.get(name, {}).get(measure)


def judge_claims(row: PaperRow, stored: StoredRow) -> dict[str, ClaimVerdict]:
    """Return the verdict on each claim of a row."""
    return {name: judge_claim(name, claim, stored) for name, claim in row.claims.items()}


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


def format_draws(row: PaperRow, name: str, stored: StoredRow) -> str:
    """Format what decides a claim: each reading with its draws and the share that agrees."""
    claim = row.claims[name]
    texts = []
    for reading, measure in claim.measures.items():
        if measure not in stored.values:
            continue
        summary = find_summary(name, measure, stored)
        text = format_summary(row.measures[measure], summary) if summary else ''
        # A single reading without draws has its value in another column
        if reading and not text:
            text = format_value(row.measures[measure], stored.values[measure])
        texts.append(f'{reading}: {text}' if reading else text)
    return '; '.join(filter(None, texts)) or MISSING


def format_summary(measure: PaperMeasure, summary: DrawSummary) -> str:
    """Format the draws of a measure: their range (5 to 95 %), and how many agree."""
    agreeing = f'{100.0 * summary.share:.0f} % of {summary.drawn} agree'
    if isinstance(summary.middle, str) or measure.unit is None:
        return f'mostly {summary.middle}, {agreeing}'
    ends = [format_rounded(measure, each) for each in (summary.low, summary.high)]
    text = ends[0] if ends[0] == ends[1] else ' to '.join(ends)
    return f'{append_unit(text, measure.unit)}, {agreeing}'


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
