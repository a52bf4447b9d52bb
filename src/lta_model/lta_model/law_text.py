"""Write a law as formulas and in words, with units."""

from collections.abc import Iterable, Iterator, Mapping
from typing import Final

from lta_config.quantity import format_with_unit
from lta_config.schema.vehicle_law import (
    AXES,
    HIDDEN,
    HIDDEN_RATE,
    HiddenState,
    Law,
    LawFactor,
    LawTerm,
    QUANTITIES,
    quantity_unit,
)

QUANTITY_WORDS: Final[Mapping[str, str]] = {
    'u': 'forward airspeed',
    'v': 'sideways airspeed',
    'w': 'upward airspeed',
    'speed': 'airspeed',
    'p': 'roll rate',
    'q': 'pitch rate',
    'r': 'yaw rate',
    'rate': 'rate of rotation',
    'roll': 'roll angle',
    'pitch': 'pitch angle',
    'yaw': 'heading',
    'voltage': 'battery voltage',
    'time': 'time since the start',
    HIDDEN: 'hidden state',
    HIDDEN_RATE: 'rate of the hidden state',
}


def describe_axis(axis: str) -> str:
    """Return an axis in words: 'yaw moment', 'force along map x'."""
    if axis.startswith('map_'):
        return f'force along {axis.replace("_", " ")}'
    return f'{axis} {"moment" if AXES[axis] == "N m" else "force"}'


def format_factor(factor: LawFactor, hidden: HiddenState | None = None) -> str:
    """Return a factor of a law as a formula: `max(u - 0.1 m/s, 0)`."""
    x, own = factor.quantity, quantity_unit(factor.quantity, hidden)
    threshold = factor.threshold or 0.0
    off = _subtract(x, threshold, _at(abs(threshold), own))
    power = '' if (factor.exponent or 1.0) == 1.0 else f'^{factor.exponent:g}'
    scale = '' if factor.scale is None else _at(factor.scale, own)
    phase = factor.phase or 0.0
    angle = _subtract(f'2 pi {x} / ({scale})' if scale else x, phase, f'{abs(phase):g}')
    return {
        'linear': x,
        'modulus': f'|{x}|{power}',
        'power': f'sign({x}) |{x}|{power}',
        'positive': f'max({off}, 0)',
        'negative': f'max({_at(threshold, own)} - {x}, 0)' if threshold else f'max(-{x}, 0)',
        'above': f'(1 + tanh(({off}) / ({scale}))) / 2',
        'sign': f'tanh({x} / ({scale}))',
        'decay': f'exp(-{x} / ({scale}))',
        'sin': f'sin({angle})',
        'cos': f'cos({angle})',
    }[factor.form]


def _subtract(text: str, value: float, size: str) -> str:
    """Return text minus a value of a size, with one sign; the text alone for 0."""
    return f'{text} {"-" if value > 0.0 else "+"} {size}' if value else text


def _at(value: float, unit: str) -> str:
    """Return a number with its unit, in few digits."""
    return format_with_unit(f'{value:.4g}', unit)


def format_product(law: Law, factors: Iterable[LawFactor]) -> str:
    """Return a product of factors as a formula: `speed |r|`; '' without any."""
    return ' '.join(format_factor(one, law.hidden) for one in factors)


def format_axes(law: Law) -> dict[str, str]:
    """Return a formula for each axis: 'yaw moment [N m] = -0.00031 speed r'."""
    sums: dict[str, str] = {}
    for term in law.terms:
        text = f'{abs(term.coefficient):.4g} {format_product(law, term.factors)}'.rstrip()
        sign = '-' if term.coefficient < 0.0 else '+'
        before = sums.get(term.axis)
        first = f'-{text}' if sign == '-' else text
        sums[term.axis] = f'{before} {sign} {text}' if before else first
    return {axis: f'{describe_axis(axis)} [{AXES[axis]}] = {sums[axis]}' for axis in sums}


def format_hidden(law: Law) -> str:
    """Return the equation of the hidden state; '' if there is none."""
    if (hidden := law.hidden) is None:
        return ''
    drive = format_product(law, hidden.drive)
    start = f', from {_at(hidden.start, quantity_unit(HIDDEN, hidden))}' if hidden.start else ''
    if hidden.time_constant is not None:
        return f'{hidden.time_constant:.4g} s d/dt hidden = {drive} - hidden{start}'
    return (
        f'd2/dt2 hidden = ({hidden.frequency:.4g} rad/s)^2 ({drive} - hidden) - '
        f'2 {hidden.damping:.4g} ({hidden.frequency:.4g} rad/s) d/dt hidden{start}'
    )


def format_region(law: Law) -> str:
    """Return the region of a law: 'speed 0 to 0.6 m/s, r -1 to 1 rad/s'."""
    return ', '.join(
        format_with_unit(f'{name} {low:.4g} to {high:.4g}', quantity_unit(name, law.hidden))
        for name, (low, high) in law.region.items()
    )


def describe_coefficient(term: LawTerm) -> str:
    """Return a coefficient with unit, interval and evidence."""
    text = format_with_unit(f'{term.coefficient:.4g}', term.unit)
    if term.interval:
        text += f', 95 % {term.interval[0]:.4g} to {term.interval[1]:.4g}'
    return text if term.evidence is None else f'{text}, {term.evidence:.1f} nats'


def describe_law(law: Law) -> Iterator[str]:
    """Yield a law line by line: formulas, hidden state and region."""
    yield from format_axes(law).values()
    if law.hidden:
        yield f'with {format_hidden(law)}'
    if law.region:
        yield f'for {format_region(law)}; outside, it fades to zero'


def describe_term(term: LawTerm) -> str:
    """
    Return a term in words.

    Such as 'a yaw moment of -0.00031 N m per (m/s)(rad/s) of airspeed times yaw rate'.
    """
    number = f'a {describe_axis(term.axis)} of {term.coefficient:.3g} {AXES[term.axis]}'
    if not term.factors:
        return number
    units = ''.join(
        f'({QUANTITIES[one.quantity]})' + ('' if one.degree == 1.0 else f'^{one.degree:g}')
        for one in term.factors
        if one.degree and one.quantity not in (HIDDEN, HIDDEN_RATE)
    )
    words = ' times '.join(
        QUANTITY_WORDS.get(one.quantity, one.quantity.replace('_', ' '))
        if one.form == 'linear'
        else format_factor(one)
        for one in term.factors
    )
    return f'{number}{f" per {units}" if units else ""} of {words}'
