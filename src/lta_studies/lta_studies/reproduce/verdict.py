"""Whether a claim agrees with what was measured, by the rule that its file fixed beforehand."""

from collections import Counter
from collections.abc import Iterable, Mapping
from enum import StrEnum
import math
from typing import Final

from lta_config.quantity import Quantity, with_unit
from lta_config.schema.paper_file import Claim, Measure, PaperRow, Rule
from lta_report.formatting import MISSING, number
from lta_studies.reproduce.found import Value

SIGNS: Final = {
    'deg': '°',
    'm2': 'm²',
    'cm2': 'cm²',
    'mm2': 'mm²',
    'us': 'µs',
}  # of units, for people
PLAIN: Final = 1e-9  # relative; what two machines may differ by


class Verdict(StrEnum):
    """What came of a claim."""

    AGREES = 'agrees'
    DIFFERS = 'differs'
    UNTESTED = 'cannot be tested here'
    BEYOND = 'beyond the paper'
    LEFT_OUT = 'left out of --quick'


def judge(claim: Claim, values: Mapping[str, Value]) -> Verdict:
    """Return what came of a claim."""
    if claim.measure is None:
        return Verdict.UNTESTED
    if claim.rule is None:
        return Verdict.BEYOND
    if claim.measure not in values:
        return Verdict.LEFT_OUT
    value = values[claim.measure].value
    return Verdict.AGREES if holds(claim.rule, claim.value, value) else Verdict.DIFFERS


def holds(rule: Rule, printed: Quantity | None, value: float | str) -> bool:
    """Tell whether a value, in SI or a word, keeps a rule; NaN keeps none."""
    if isinstance(value, str):
        return value == rule.word
    low, high = bounds(rule, printed)
    slack = PLAIN * max(abs(bound) for bound in (low, high, 0.0) if math.isfinite(bound))
    return low - slack <= value <= high + slack


def bounds(rule: Rule, printed: Quantity | None) -> tuple[float, float]:
    """Return the least and the greatest value that agree. [SI]"""
    if rule.within is not None and printed is not None:
        half = rule.within.si * abs(printed.si)
        return printed.si - half, printed.si + half
    low = -math.inf if rule.least is None else rule.least.si
    return low, math.inf if rule.most is None else rule.most.si


def verdicts(row: PaperRow, values: Mapping[str, Value]) -> dict[str, Verdict]:
    """Return what came of each claim of a row."""
    return {name: judge(claim, values) for name, claim in row.claims.items()}


def counted(found: Iterable[Verdict]) -> dict[Verdict, int]:
    """Return how many claims came to what, in the order of `Verdict`."""
    counts = Counter(found)
    return {each: counts[each] for each in Verdict}


def rule_words(rule: Rule) -> str:
    """Return a rule in words."""
    if rule.word is not None:
        return f'is {rule.word}'
    if rule.within is not None:
        return f'within {quantity(rule.within)}'
    ends = [('at least', rule.least), ('at most', rule.most)]
    return ' and '.join(f'{word} {quantity(end)}' for word, end in ends if end is not None)


def quantity(given: Quantity) -> str:
    """Return a quantity of a file as people write it."""
    return signed(f'{given.value:.12g}'.replace('-', '\N{MINUS SIGN}'), given.unit)


def told(measure: Measure, value: Value | None, *, interval: bool = True) -> str:
    """Return a value as people read it, with its interval where it has one."""
    if value is None:
        return MISSING
    if isinstance(value.value, str) or measure.unit is None:
        return str(value.value)
    if math.isnan(value.value):
        return 'never'
    texts = [rounded(measure, each) for each in (value.value, value.low, value.high)]
    text = texts[0]
    if interval and not math.isnan(value.low) and len(set(texts)) > 1:
        text += f' ({texts[1]} to {texts[2]})'
    return signed(text, measure.unit)


def signed(text: str, unit: str) -> str:
    """Return a number with its unit as people write it."""
    return f'{text}°' if unit == 'deg' else with_unit(text, SIGNS.get(unit, unit))


def rounded(measure: Measure, value: float) -> str:
    """Return a number of the measure's unit, rounded as it declares."""
    scaled = value / measure.factor
    if not math.isfinite(scaled):
        return MISSING
    return number(round(scaled, measure.digits), max(0, measure.digits))


def filled(text: str, row: PaperRow, values: Mapping[str, Value]) -> str:
    """Return a text with its measures in their places."""
    words = {
        name: told(measure, values.get(name), interval=False)
        for name, measure in row.measures.items()
    }
    return text.format_map(words)
