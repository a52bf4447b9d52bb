# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Format parameters, effects, values with intervals, and odds."""

from collections.abc import Sequence
import math
from typing import Final

from lta_model.effects import EFFECTS
from lta_model.effects.protocol import describe_effect
from lta_report.formatting import MISSING

MINUS: Final = '\N{MINUS SIGN}'
DIVERGED: Final = 1e3  # m; no forecast over some seconds is off by more
TO_DEG: Final = 180.0 / math.pi
DEGREE: Final = '\N{DEGREE SIGN}'
SHOWN_UNITS: Final = {'rad': (DEGREE, TO_DEG), 'rad/s': (f'{DEGREE}/s', TO_DEG)}


def format_parameter(knob: str) -> str:
    """Return a parameter's readable name: 'linear drag (surge)', 'net lift'."""
    effect, _, rest = knob.partition('.')
    if effect == 'vehicle':
        return rest if rest == 'mass' else f'inertia ({rest})'
    words, declaration = effect.replace('_', ' '), EFFECTS.get(effect)
    if not rest or (declaration is not None and len(declaration.parameters) == 1):
        return words
    return f'{words} ({rest.replace("_", " ")})'


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


def format_error(metres: float, digits: int = 2) -> str:
    """Format a position error."""
    return 'diverged' if metres > DIVERGED else f'{format_number(100.0 * metres, digits)} cm'


def append_unit(text: str, unit: str) -> str:
    """Append the unit to a number; a pure number has none."""
    apart = '' if unit.startswith(DEGREE) else ' '
    return text if unit in ('', '1') else f'{text}{apart}{unit}'


def join_words(words: Sequence[str], last: str = 'and') -> str:
    """Join words with commas and a final conjunction."""
    if len(words) < 2:
        return ''.join(words)
    return f'{", ".join(words[:-1])} {last} {words[-1]}'
