"""
Declare the terms that a law may have: products of functions of measurable quantities.

A term is a product of factors on an axis. Simple terms come first: those of a later tier are more,
and therefore have to be worth more evidence.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import combinations_with_replacement, product
import math
from typing import Final, final

from lta_config.schema.vehicle_law import HiddenState, LawFactor, LEAST_LAG
from lta_model.law_arrays import HIDDEN_QUANTITIES

MOTIONS: Final = ('u', 'v', 'w', 'p', 'q', 'r')
THRUSTS: Final = ('thrust_surge', 'thrust_heave', 'thrust_yaw')
SOFT: Final = 0.15  # of the usual size of a quantity; width of a smooth step
# Trial values of numbers that are fitted afterwards
THRESHOLDS: Final = (-0.8, 0.0, 0.8)  # usual sizes from the mean
DECAYS: Final = (0.15, 0.4, 1.0)  # m of height
FADES: Final = (10.0, 30.0, 90.0)  # s since the start
WAVES: Final = (0.7, 1.2, 2.0, 3.2)  # m of height
PHASES: Final = (0.0, 0.25 * math.pi, 0.5 * math.pi, 0.75 * math.pi)
LAGS: Final = (0.4, 1.2, 4.0, 12.0, 36.0)  # s; first order
SWINGS: Final = (0.25, 0.4, 0.6, 0.9, 1.3)  # Hz; second order
DAMPED: Final = 0.1  # damping ratio
SHORTEST: Final = 1.5  # m; wave of a field over position
HARMONICS: Final = 16  # most of a field over position, in each direction
# Phases of a product of two waves, of which one holds half of the power of any other
QUARTERS: Final = (0.0, 0.5 * math.pi)
EIGHTHS: Final = (0.25 * math.pi, 0.75 * math.pi)
# Smallest and largest of a number by its name, where refinement may lead
LIMITS: Final = {
    'exponent': (0.5, 3.0),
    'damping': (0.02, 0.99),  # `filter_hidden` is for oscillators
    'time_constant': (LEAST_LAG, 1e4),  # s
    'frequency': (0.01, 50.0),  # rad/s
}


Place = tuple[int, str]  # index of the factor or HIDDEN, and name of a number
HIDDEN: Final = -1  # stands for the hidden state in place of the index of a factor


@final
@dataclass(frozen=True, slots=True)
class Column:
    """A column of the dictionary: the factors of a term on any axis."""

    factors: tuple[LawFactor, ...]
    tier: int  # 0: one factor, 1: a product, 2: a hidden state, 3: a field over position
    hidden: HiddenState | None = None

    @property
    def along_map(self) -> bool:
        """Whether it is tried along the axes of the map only: a field over both directions."""
        return {'x', 'y'} <= {factor.quantity for factor in self.factors}


@final
@dataclass(frozen=True, slots=True)
class Spread:
    """Usual size and mean of a quantity in some flights."""

    size: float  # standard deviation
    mean: float


def _list_steps(name: str, spread: Spread) -> Iterator[LawFactor]:
    """Yield smooth steps of a quantity: its sign, and being above each trial threshold."""
    scale = round_number(SOFT * spread.size)
    # A constant quantity has no step
    if scale == 0.0:
        return
    yield LawFactor(quantity=name, form='sign', scale=scale)
    for at in THRESHOLDS:
        mean = 0.0 if name in MOTIONS else spread.mean
        threshold = round_number(at * spread.size + mean)
        yield LawFactor(quantity=name, form='above', threshold=threshold, scale=scale)


def _list_single_factors(spreads: Mapping[str, Spread]) -> Iterator[LawFactor]:
    """Yield the single factors."""
    for name in MOTIONS:
        for form in ('linear', 'modulus', 'positive'):
            yield LawFactor(quantity=name, form=form)
        yield from _list_steps(name, spreads[name])
    yield LawFactor(quantity='speed')
    yield LawFactor(quantity='height')
    for scale in DECAYS:
        yield LawFactor(quantity='height', form='decay', scale=scale)
    for scale, phase in product(WAVES, PHASES):
        yield LawFactor(quantity='height', form='sin', scale=scale, phase=phase)
    yield from _list_steps('height', spreads['height'])
    for name in ('roll', 'pitch'):
        for form in ('linear', 'positive'):
            yield LawFactor(quantity=name, form=form)
        yield from _list_steps(name, spreads[name])
    for period, phase in product((None, math.pi), PHASES):
        yield LawFactor(quantity='yaw', form='sin', scale=period, phase=phase)
    for name in THRUSTS:
        for form in ('linear', 'modulus'):
            yield LawFactor(quantity=name, form=form)
    if spreads['voltage'].size > 0.0:
        yield LawFactor(quantity='voltage')
    yield LawFactor(quantity='time')
    for scale in FADES:
        yield LawFactor(quantity='time', form='decay', scale=scale)


def _is_product(one: LawFactor, other: LawFactor) -> bool:
    """Return whether two factors make a column of their own."""
    kinds, forms = {one.quantity, other.quantity}, {one.form, other.form}
    if len(kinds) == 1:
        return forms <= {'linear', 'modulus', 'positive'} and not kinds & {'time', 'voltage'}
    if forms <= {'sign', 'above'} or 'time' in kinds:
        return False
    return bool(kinds & {*MOTIONS, 'speed', *THRUSTS})


def _list_hidden_columns(spreads: Mapping[str, Spread]) -> Iterator[Column]:
    """Yield the columns with a hidden state."""
    for name in (*MOTIONS, *THRUSTS, 'roll', 'pitch', 'speed', 'height'):
        for form in ('linear',) if name in ('speed', 'height') else ('linear', 'modulus'):
            drive = [LawFactor(quantity=name, form=form)]
            # A height is never at 0
            start = round_number(spreads[name].mean) if name == 'height' else None
            states = [HiddenState(drive=drive, time_constant=lag, start=start) for lag in LAGS]
            if form == 'linear' and start is None:
                states += [
                    HiddenState(drive=drive, frequency=2.0 * math.pi * hertz, damping=DAMPED)
                    for hertz in SWINGS
                ]
            for state in states:
                for output in HIDDEN_QUANTITIES:
                    yield Column((LawFactor(quantity=output),), 2, state)
    # What switches with a delay, alone or as a share of the thrust
    for name in (*MOTIONS, 'roll', 'pitch', 'height'):
        for factor, lag in product(_list_steps(name, spreads[name]), LAGS):
            state = HiddenState(drive=[factor], time_constant=lag)
            for pushed in ((), *((LawFactor(quantity=one),) for one in THRUSTS[:2])):
                yield Column((LawFactor(quantity=HIDDEN_QUANTITIES[0]), *pushed), 2, state)


def _list_field_columns(spreads: Mapping[str, Spread]) -> Iterator[Column]:
    """Yield harmonics over the area of the flights: fields over position."""
    # A spring to a place, a pull beyond a place, a wall of another air
    for name in ('x', 'y'):
        yield Column((LawFactor(quantity=name),), 3)
        for factor in _list_steps(name, spreads[name]):
            if factor.form == 'above':
                yield Column((factor,), 3)
                for form in ('positive', 'negative'):
                    side = LawFactor(quantity=name, form=form, threshold=factor.threshold)
                    yield Column((side,), 3)
    scales: list[list[float]] = []
    for name in ('x', 'y'):
        # Half a wave over the area, and so on: a length between two fits at one of them
        length = 2.0 * max(3.5 * spreads[name].size, 0.5)
        most = min(HARMONICS, math.ceil(length / SHORTEST))
        scales.append([round_number(length / k) for k in range(1, most + 1)])
    fading = LawFactor(quantity='height', form='decay', scale=0.7)
    for name, own in zip(('x', 'y'), scales, strict=True):
        for scale, phase in product(own, PHASES):
            wave = LawFactor(quantity=name, form='sin', scale=scale, phase=phase)
            yield Column((wave,), 3)
            yield Column((wave, fading), 3)
    for (a, b), phases in product(product(*scales), (QUARTERS, EIGHTHS)):
        for phase, other in product(phases, phases):
            first = LawFactor(quantity='x', form='sin', scale=a, phase=phase)
            second = LawFactor(quantity='y', form='sin', scale=b, phase=other)
            yield Column((first, second), 3)


def build_dictionary(spreads: Mapping[str, Spread]) -> list[Column]:
    """Return all columns, for the usual sizes of the quantities in some flights."""
    single = list(_list_single_factors(spreads))
    pairs = [
        (one, other)
        for one, other in combinations_with_replacement(single, 2)
        if _is_product(one, other)
    ]
    return [
        *(Column((one,), 0) for one in single),
        *(Column(pair, 1) for pair in pairs),
        *_list_hidden_columns(spreads),
        *_list_field_columns(spreads),
    ]


def list_numbers(column: Column) -> list[Place]:
    """Return the parameters of a column that can be refined, also those it could still get."""
    out = []
    for k, factor in enumerate(column.factors):
        names = [*factor.numbers]
        if factor.form == 'modulus' and not names:
            names = ['exponent']
        if factor.form == 'positive':
            names = ['threshold']
        if factor.form in ('above', 'sign') or factor.quantity == 'yaw':
            names = [name for name in names if name != 'scale']
        out += [(k, name) for name in names]
    if column.hidden is not None:
        names = ['time_constant', 'frequency', 'damping', 'start']
        out += [(HIDDEN, name) for name in names if getattr(column.hidden, name) is not None]
        if column.hidden.drive[0].threshold is not None:
            out.append((HIDDEN, 'threshold'))
    return out


def move_number(
    column: Column, place: Place, step: float, spreads: Mapping[str, Spread]
) -> Column:
    """Return a column with a number moved: thresholds, starts and phases add, others multiply."""
    k, name = place
    if k == HIDDEN:
        assert column.hidden is not None
        state, drive = column.hidden, column.hidden.drive[0]
        holder = drive if name == 'threshold' else state
        value = _move_value(name, getattr(holder, name), step, spreads[drive.quantity].size)
        moved: dict[str, object] = {name: value}
        if holder is drive:
            moved = {'drive': [drive.model_copy(update=moved), *state.drive[1:]]}
        return replace(column, hidden=state.model_copy(update=moved))
    factor = column.factors[k]
    now = getattr(factor, name)
    before = (1.0 if name == 'exponent' else 0.0) if now is None else now
    spread = spreads[factor.quantity]
    value = _move_value(name, before, step, spread.size)
    change = {name: value}
    if name == 'scale' and factor.form in ('sin', 'cos'):
        # About the mean of the quantity, so that it does not shift the wave there
        turns = spread.mean / value - spread.mean / before
        change['phase'] = round_number((factor.phase or 0.0) + 2.0 * math.pi * turns)
    factors = list(column.factors)
    factors[k] = factor.model_copy(update=change)
    return replace(column, factors=tuple(factors))


def vary_numbers(column: Column, spreads: Mapping[str, Spread], step: float) -> list[Column]:
    """Return the column with each of its numbers moved by a step, up and down."""
    return [
        move_number(column, place, way * step, spreads)
        for place in list_numbers(column)
        for way in (1.0, -1.0)
    ]


def _move_value(name: str, value: float, step: float, size: float) -> float:
    """Return a moved number; `size` is the usual size of its quantity."""
    low, high = LIMITS.get(name, (-1e4, 1e4))
    if name in ('threshold', 'start'):
        moved = value + step * size
    else:
        moved = value + step if name == 'phase' else value * math.exp(step)
    # Few digits, as in a file
    return round_number(min(max(moved, low), high))


def round_number(value: float) -> float:
    """Return a number in four digits."""
    return float(f'{value:.4g}')
