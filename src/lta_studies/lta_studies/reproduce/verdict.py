# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Judge whether a claim agrees with what is measured here, by the rule in its file.

A reading of a claim agrees if its rule surely holds in at least 95 % of the draws from the ranges
of what is assumed: the lower end of Wilson's interval of the share is 95 % or more. It differs if
the upper end is 5 % or less. A claim agrees or differs if all of its readings do. Any other claim
is open, because of how the paper is read (one reading agrees and another differs), because single
flights were flown, or because our numbers are not known well enough.

The navigation rows fly several flights in each draw, and the rate of a draw is their share. A
manoeuvre is flown once in each draw: of a claim about the rate at which flights succeed, such a
draw shows one outcome and not the rate. By Markov's inequality a share P(p < L) of the draws with
a rate p below L makes at least (1 - L) P(p < L) of all flights fail, so that few failures bound
it. If the paper prints a figure of one flight, it differs where that figure is outside of the
interval in which nine of ten single flights lie.

A measure that was not drawn counts as it is, with its whole interval over the seeds if it has one.
"""

from collections import Counter
from collections.abc import Iterable, Mapping
from enum import StrEnum
import math
from typing import Final

from lta_config.quantity import format_with_unit, Quantity
from lta_config.schema.paper_file import AgreementRule, PaperClaim, PaperMeasure, PaperRow
from lta_flight.sweep.statistics import wilson_interval
from lta_report.formatting import format_number, MISSING
from lta_studies.reproduce.study_result import (
    agreement_bounds,
    DrawSummary,
    is_satisfied,
    MeasuredValue,
    StoredRow,
    SURE_SHARE,
)

TYPESET_UNITS: Final = {
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
    READING = 'open: how the paper is read'
    CHANCE = 'open: chance of single flights'
    NUMBERS = 'open: our numbers'
    UNTESTED = 'cannot be tested'
    CONSTRUCTION = 'agrees by construction'
    VACUOUS = 'agrees, but says nothing'
    LEFT_OUT = 'not measured in this run'


def judge_claim(name: str, claim: PaperClaim, stored: StoredRow) -> ClaimVerdict:
    """Return the verdict on a claim of a stored row."""
    if claim.measure is None:
        return ClaimVerdict.UNTESTED
    if claim.measure not in stored.values:
        return ClaimVerdict.LEFT_OUT
    # --quick may leave out readings; its verdicts are preliminary
    measured = [each for each in claim.measures.values() if each in stored.values]
    readings = {each: judge_reading(name, claim, each, stored) for each in measured}
    states = set(readings.values())
    if states == {False}:
        return ClaimVerdict.DIFFERS
    if states >= {True, False}:
        return ClaimVerdict.READING
    if None in states:
        undrawn = any(
            state is None and find_summary(name, measure, stored) is None
            for measure, state in readings.items()
        )
        return ClaimVerdict.CHANCE if claim.flights or undrawn else ClaimVerdict.NUMBERS
    if claim.construction:
        return ClaimVerdict.CONSTRUCTION
    empty = stored.values.get(claim.vacuous or '')
    if empty is not None and empty.value == 'yes':
        return ClaimVerdict.VACUOUS
    return ClaimVerdict.AGREES


def judge_reading(name: str, claim: PaperClaim, measure: str, stored: StoredRow) -> bool | None:
    """Return whether a reading of a claim agrees (true) or differs (false); None if neither."""
    rule, summary = claim.rule, find_summary(name, measure, stored)
    assert rule is not None
    if summary is None:
        value = stored.values[measure]
        # Flights without draws and without an interval decide nothing
        single = claim.flights is not None and math.isnan(value.low)
        return None if single else judge_undrawn(rule, claim.value, value)
    share = wilson_interval(round(summary.share * summary.drawn), summary.drawn)
    failures, successes = tolerated_shares(rule, rate=claim.flights == 'rate')
    if share.low >= 1.0 - failures:
        return True
    if claim.flights == 'single' and claim.value is not None:
        return None if summary.low <= claim.value.si <= summary.high else False
    return False if share.high <= successes else None


def tolerated_shares(rule: AgreementRule, *, rate: bool) -> tuple[float, float]:
    """
    Return up to which share of draws may fail a rule that holds, and satisfy one that does not.

    `rate`: whether each draw shows a single outcome, and the rule bounds the rate of them.
    """
    doubt = 1.0 - SURE_SHARE
    if not rate:
        return doubt, doubt
    low, high = agreement_bounds(rule, None)
    # By Markov's inequality; a rate is bounded on one side
    if math.isfinite(low):
        return doubt * (1.0 - low), doubt * low
    return doubt * high, doubt * (1.0 - high)


def judge_undrawn(
    rule: AgreementRule, printed: Quantity | None, measured: MeasuredValue
) -> bool | None:
    """Return whether a value with its interval over the seeds agrees; None if only a part does."""
    value, low, high, _ = measured
    if isinstance(value, str) or math.isnan(low) or math.isnan(high):
        return is_satisfied(rule, printed, value)
    least, most = agreement_bounds(rule, printed)
    if high < least or low > most:
        return False
    return True if least <= low and high <= most else None


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
    if summary.missing:
        agreeing += f', {summary.missing} did not arrive'
    if isinstance(summary.middle, str) or measure.unit is None:
        return f'mostly {summary.middle}, {agreeing}'
    ends = [format_rounded(measure, each) for each in (summary.low, summary.high)]
    text = ends[0] if ends[0] == ends[1] else ' to '.join(ends)
    return f'{append_unit(text, measure.unit)}, {agreeing}'


def append_unit(text: str, unit: str) -> str:
    """Append the typeset unit to a number."""
    return f'{text}°' if unit == 'deg' else format_with_unit(text, TYPESET_UNITS.get(unit, unit))


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
