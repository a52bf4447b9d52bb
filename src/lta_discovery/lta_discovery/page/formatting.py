"""Format parameters, effects, values with intervals, and odds."""

from collections.abc import Sequence
import math
from typing import Final

from lta_discovery.finding import NamedEffect, ParameterEstimate, SearchCandidate
from lta_discovery.selection.candidate_acceptance import (
    AGAIN,
    APART,
    GAIN,
    HOLDS,
    LARGER,
    SPOILT,
    TORN,
)
from lta_discovery.unmodeled.unexplained_force import Remainder
from lta_model.effects import EFFECTS
from lta_model.effects.protocol import describe_effect
from lta_report.formatting import MISSING

MINUS: Final = '\N{MINUS SIGN}'
DEGREES: Final = 180.0 / math.pi
DEGREE: Final = '\N{DEGREE SIGN}'
SHOWN_UNITS: Final = {'rad': (DEGREE, DEGREES), 'rad/s': (f'{DEGREE}/s', DEGREES)}
RAISED: Final = str.maketrans(
    '0123456789', '\u2070\u00b9\u00b2\u00b3\u2074\u2075\u2076\u2077\u2078\u2079'
)
MANY: Final = 2  # most directions of one effect that are listed separately
FORCES: Final = ('surge', 'sway', 'heave')


def format_parameter(knob: str) -> str:
    """Return a parameter's readable name: 'linear drag (surge)', 'net lift'."""
    effect, _, rest = knob.partition('.')
    if effect == 'vehicle':
        return rest if rest == 'mass' else f'inertia ({rest})'
    words, declaration = effect.replace('_', ' '), EFFECTS.get(effect)
    if not rest or (declaration is not None and len(declaration.parameters) == 1):
        return words
    return f'{words} ({rest.replace("_", " ")})'


def format_effect(one: NamedEffect) -> str:
    """Return an effect's readable name: its directions, or the effect if there are many."""
    if len(one.knobs) > MANY:
        return one.name.replace('_', ' ')
    return join_words([format_parameter(knob) for knob in one.knobs])


def explain_effect(effect: str) -> str:
    """Describe an effect in a sentence; '' for one that is not in this registry."""
    declaration = EFFECTS.get(effect)
    return '' if declaration is None else f'{describe_effect(declaration)}.'


def format_number(value: float, digits: int = 3) -> str:
    """Format a number to a few significant digits, without an exponent where possible."""
    if not math.isfinite(value):
        return MISSING
    text = f'{value:.{digits}g}'
    if 'e' in text and 1e-5 < abs(value) < 1e6:
        places = max(0, digits - 1 - math.floor(math.log10(abs(value))))
        text = f'{value:.{places}f}'
    return text.replace('-', MINUS)


def format_with_interval(value: float, interval: tuple[float, float]) -> tuple[str, str, str]:
    """Format a value and its interval, to two significant digits of the interval's width."""
    width = interval[1] - interval[0]
    if not all(map(math.isfinite, (value, *interval))) or width <= 0.0:
        return format_number(value), format_number(interval[0]), format_number(interval[1])
    places = max(0, 1 - math.floor(math.log10(width)))
    # Fixed-point notation would be all zeros here.
    if places > 8:
        return (
            format_number(value, 5),
            format_number(interval[0], 5),
            format_number(interval[1], 5),
        )
    a, b, c = (f'{part:.{places}f}'.replace('-', MINUS) for part in (value, *interval))
    return a, b, c


def append_unit(text: str, unit: str) -> str:
    """Append the unit to a number; a pure number has none."""
    apart = '' if unit.startswith(DEGREE) else ' '
    return text if unit in ('', '1') else f'{text}{apart}{unit}'


def format_quantity(value: float, unit: str, digits: int = 3) -> str:
    """Format an error in a readable unit: millimetres, centimetres, degrees."""
    if unit == 'm' and math.isfinite(value):
        size = abs(value)
        scale, name = (1e3, 'mm') if size < 0.01 else (100.0, 'cm') if size < 1.0 else (1.0, 'm')
        return f'{format_number(scale * value, digits)} {name}'
    name, factor = SHOWN_UNITS.get(unit, (unit, 1.0))
    return append_unit(format_number(factor * value, digits), name)


def format_percent(share: float) -> str:
    """Format a share in whole per cent."""
    return MISSING if not math.isfinite(share) else f'{100 * share:.0f}'.replace('-', MINUS)


def join_words(words: Sequence[str], last: str = 'and') -> str:
    """Join words with commas and a final conjunction."""
    if len(words) < 2:
        return ''.join(words)
    return f'{", ".join(words[:-1])} {last} {words[-1]}'


def format_file_value(one: ParameterEstimate) -> str:
    """Describe the vehicle file's value of a parameter."""
    return (
        f'vehicle file: {format_number(one.before)}' if one.in_file else 'not in the vehicle file'
    )


def format_estimate(one: ParameterEstimate) -> str:
    """Format an estimate with its unit."""
    return append_unit(format_with_interval(one.value, one.ci95)[0], one.unit)


def format_assumed(one: NamedEffect) -> str:
    """Describe the assumed parameters of an effect; '' if there are none."""
    if not one.assumed:
        return ''
    numbers = [
        f'{each.name.replace("_", " ")} {append_unit(format_number(each.value), each.unit)}'
        for each in one.assumed
    ]
    return f' for {join_words(numbers)} (assumed and not fitted)'


def format_remainder(one: Remainder) -> str:
    """Describe a remaining force: 'a force along surge that varies with heading (sine)'."""
    kind = f'force along {one.axis}' if one.axis in FORCES else f'{one.axis} moment'
    if not one.is_traced:
        return f'a {kind} of unknown cause'
    if not one.follows:
        return f'a {kind} that is unrelated to all measured quantities'
    return f'a {kind} that varies with {join_words(one.follows)}'


def remainder_unit(one: Remainder) -> str:
    """Return the unit of a remaining force or moment."""
    return 'N' if one.axis in FORCES else 'N m'


def format_odds(nats: float) -> str:
    """Format evidence as odds against chance."""
    power = nats / math.log(10.0)
    if power < 1.0:
        return 'no better than chance' if nats <= 0.0 else f'odds of {math.exp(nats):.1f} to 1'
    return f'odds of 10{f"{power:.0f}".translate(RAISED)} to 1'


def explain_decision(rung: SearchCandidate, beaten: bool, status: str = '') -> str:
    """
    Explain why a candidate was named or rejected.

    `beaten`: whether its round named another. `status`: 'named' or 'possible' if it is in the
    final result.
    """
    witness = max(rung.confirm, rung.carried)
    if rung.accepted:
        return status or 'first named, then dropped: all flights together do not support it'
    if rung.total <= GAIN or max(rung.train, witness) <= LARGER:
        return 'too little evidence'
    if rung.apart >= APART:
        return 'the flights disagree on its value'
    if beaten:
        return 'another explains it better'
    alone = rung.confirm > AGAIN and rung.carried > -SPOILT
    if alone or (rung.carried > HOLDS and rung.confirm > -TORN):
        return 'an unexplained force explains the flights better'
    return 'the other flights do not confirm it'
