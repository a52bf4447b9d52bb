"""
A law: a force or moment without a name, as a sum of products of measured quantities.

`lta discover` writes one where something is at work that no effect of the library describes; the
effect `law` of `lta_model` flies it. A law is

    sum of coefficient * factor * factor ...

on each axis, where a factor is a form of one quantity, such as max(u - threshold, 0). All numbers
are in SI. At most one hidden state h follows a product of factors with a lag, from `start` and at
rest when a flight begins:

    order 1:  time_constant dh/dt = drive - h
    order 2:  d2h/dt2 = frequency^2 (drive - h) - 2 damping frequency dh/dt

Within the `region` of the flights that it was found in, the law applies in full. Outside it fades
to zero over half of the width of the range, on each side; so does the drive of the hidden state,
by the ranges of all other quantities.
"""

from collections import Counter
from collections.abc import Iterable, Mapping
import math
from typing import Annotated, Final, Self

from lta_config.files import StrictModel
from pydantic import Field, field_validator, model_validator

# The arrays of the effect have these sizes
TERMS: Final = 6
FACTORS: Final = 3
REGION: Final = 8  # different quantities in a law

# Components of the wrench about the hull centre, and their units: body frame, then the map's
AXES: Final[Mapping[str, str]] = {
    **dict.fromkeys(('surge', 'sway', 'heave'), 'N'),
    **dict.fromkeys(('roll', 'pitch', 'yaw'), 'N m'),
    **dict.fromkeys(('map_x', 'map_y', 'map_z'), 'N'),
}
LEAST_LAG: Final = 0.02  # s; least time constant of a hidden state
# The hidden state and its rate; their units are those of the drive
HIDDEN: Final = 'hidden'
HIDDEN_RATE: Final = 'hidden_rate'
# Quantities, with their units. The order is that of the codes in the compiled effect.
QUANTITIES: Final[Mapping[str, str]] = {
    # Velocity relative to the air, body frame, and its modulus; body rates, and their modulus
    **dict.fromkeys(('u', 'v', 'w', 'speed'), 'm/s'),
    **dict.fromkeys(('p', 'q', 'r', 'rate'), 'rad/s'),
    # Hull centre in the map
    **dict.fromkeys(('x', 'y', 'height'), 'm'),
    **dict.fromkeys(('roll', 'pitch', 'yaw'), 'rad'),
    'voltage': 'V',
    'time': 's',  # since the start of the flight
    HIDDEN: '',
    HIDDEN_RATE: '/s',
    # Thrust of each rotor, in the order of the file; their sum along the axes of the rotors, and
    # its moment about the hull centre
    **{f'thrust_{k}': 'N' for k in range(1, 9)},
    **dict.fromkeys(('thrust_surge', 'thrust_sway', 'thrust_heave'), 'N'),
    **dict.fromkeys(('thrust_roll', 'thrust_pitch', 'thrust_yaw'), 'N m'),
}
# Forms, with their equation, and the numbers that each needs and may have. The order is that of
# the codes in the compiled effect.
FORMS: Final[Mapping[str, tuple[str, tuple[str, ...], tuple[str, ...]]]] = {
    'linear': ('x', (), ()),
    'modulus': ('|x|^exponent', (), ('exponent',)),
    'power': ('sign(x) |x|^exponent', ('exponent',), ()),
    'positive': ('max(x - threshold, 0)', (), ('threshold',)),
    'negative': ('max(threshold - x, 0)', (), ('threshold',)),
    'above': ('(1 + tanh((x - threshold) / scale)) / 2', ('threshold', 'scale'), ()),
    'sign': ('tanh(x / scale)', ('scale',), ()),
    'decay': ('exp(-x / scale)', ('scale',), ()),
    'sin': ('sin(2 pi x / scale - phase)', (), ('scale', 'phase')),
    'cos': ('cos(2 pi x / scale - phase)', (), ('scale', 'phase')),
}
# Where `scale` of a sine or cosine is not given: the period of an angle
PERIOD: Final = 2.0 * math.pi

Finite = Annotated[float, Field(allow_inf_nan=False)]
Positive = Annotated[float, Field(gt=0.0, allow_inf_nan=False)]


def _check_name(name: str, what: str, valid: Iterable[str]) -> str:
    """Return a name, or raise `ValueError` with the list of the valid ones."""
    if name not in valid:
        raise ValueError(f'is {name!r}, which is no {what}; known: {", ".join(valid)}')
    return name


class LawFactor(StrictModel):
    """A form of one quantity, such as |r| or max(u - 0.1, 0)."""

    quantity: str
    form: str = 'linear'
    exponent: Annotated[float, Field(ge=0.25, le=4.0)] | None = None
    threshold: Finite | None = None
    scale: Positive | None = None
    phase: Finite | None = None

    @field_validator('quantity')
    @classmethod
    def _check_quantity(cls, value: str) -> str:
        return _check_name(value, 'quantity', QUANTITIES)

    @field_validator('form')
    @classmethod
    def _check_form(cls, value: str) -> str:
        return _check_name(value, 'form', FORMS)

    @model_validator(mode='after')
    def _check_numbers(self) -> Self:
        equation, needed, optional = FORMS[self.form]
        numbers = self.numbers
        if missing := [name for name in needed if name not in numbers]:
            raise ValueError(
                f'has the form {self.form}, {equation}, without {" and ".join(missing)}; add it'
            )
        if surplus := [name for name in numbers if name not in (*needed, *optional)]:
            raise ValueError(
                f'has the form {self.form}, {equation}, and {" and ".join(surplus)}, which that '
                'form does not use; remove it'
            )
        if self.form in ('sin', 'cos') and not self.scale and QUANTITIES[self.quantity] != 'rad':
            raise ValueError(
                f'has the form {self.form} of {self.quantity}, which is no angle, without scale; '
                'add its period as scale'
            )
        return self

    @property
    def numbers(self) -> dict[str, float]:
        """The given numbers, by name."""
        names = ('exponent', 'threshold', 'scale', 'phase')
        return {name: value for name in names if (value := getattr(self, name)) is not None}

    @property
    def degree(self) -> float:
        """The power of the quantity's unit in the unit of the factor."""
        if self.form in ('linear', 'positive', 'negative'):
            return 1.0
        return (self.exponent or 1.0) if self.form in ('modulus', 'power') else 0.0


Factors = Annotated[list[LawFactor], Field(max_length=FACTORS)]


class LawTerm(StrictModel):
    """
    A coefficient times a product of factors, on one axis; without factors it is constant.

    Attributes
    ----------
    interval : list of float
        95 % interval of the coefficient.
    evidence : float
        Gain of the log evidence by this term. [nats]

    """

    axis: str
    coefficient: Finite
    unit: str
    factors: Factors
    interval: Annotated[list[Finite], Field(min_length=2, max_length=2)] | None = None
    evidence: Finite | None = None

    @field_validator('axis')
    @classmethod
    def _check_axis(cls, value: str) -> str:
        return _check_name(value, 'axis', AXES)

    @model_validator(mode='after')
    def _check_interval(self) -> Self:
        if self.interval and not self.interval[0] <= self.coefficient <= self.interval[1]:
            raise ValueError(
                f'has the coefficient {self.coefficient:g} outside of its interval '
                f'{self.interval[0]:g} to {self.interval[1]:g}; correct one of them'
            )
        return self


class HiddenState(StrictModel):
    """One state that follows a product of factors, its drive, with a lag."""

    drive: Annotated[list[LawFactor], Field(min_length=1, max_length=FACTORS)]
    # Of a lag of first order [s]; the bounds allow for the steps of simulation and replay
    time_constant: Annotated[float, Field(ge=LEAST_LAG, le=1e6)] | None = None
    # Natural frequency of a lag of second order [rad/s]
    frequency: Annotated[float, Field(gt=0.0, le=50.0)] | None = None
    # Damping ratio of a lag of second order
    damping: Annotated[float, Field(ge=0.0, le=5.0)] | None = None
    # Where it begins, in the unit of the drive; 0 if not given
    start: Finite | None = None

    @model_validator(mode='after')
    def _check_order(self) -> Self:
        second = self.frequency is not None and self.damping is not None
        either = self.frequency is not None or self.damping is not None
        if (self.time_constant is None) != second or (self.time_constant is not None and either):
            raise ValueError(
                'needs either time_constant, for a lag of first order, or frequency and damping, '
                'for one of second order'
            )
        if any(factor.quantity in (HIDDEN, HIDDEN_RATE) for factor in self.drive):
            raise ValueError('is driven by itself; use other quantities in drive')
        return self


class Law(StrictModel):
    """
    A force or moment without a name, as a sum of products (docs/effects.md).

    Attributes
    ----------
    region : mapping of str to list of float
        Lowest and highest value of each quantity that the law uses. [SI]

    """

    source: Annotated[str, Field(min_length=1)]
    terms: Annotated[list[LawTerm], Field(min_length=1, max_length=TERMS)]
    hidden: HiddenState | None = None
    region: Mapping[str, Annotated[list[Finite], Field(min_length=2, max_length=2)]]

    @property
    def quantities(self) -> list[str]:
        """The quantities that it uses, in the order of `QUANTITIES`."""
        drive = self.hidden.drive if self.hidden else []
        factors = [*drive, *(factor for term in self.terms for factor in term.factors)]
        used = {factor.quantity for factor in factors}
        return [name for name in QUANTITIES if name in used]

    @model_validator(mode='after')
    def _check_hidden(self) -> Self:
        used = [name for name in (HIDDEN, HIDDEN_RATE) if name in self.quantities]
        if used and not self.hidden:
            raise ValueError(f'uses the quantity {used[0]}, but has no block "hidden"; add one')
        if self.hidden and not used:
            raise ValueError('has a block "hidden" that no term uses; remove it')
        return self

    @model_validator(mode='after')
    def _check_region(self) -> Self:
        used = self.quantities
        if missing := [name for name in used if name not in self.region]:
            raise ValueError(
                f'uses {", ".join(missing)} without a range in "region"; add the lowest and '
                'highest value in the flights'
            )
        if surplus := [name for name in self.region if name not in used]:
            raise ValueError(
                f'has a range in "region" of {", ".join(surplus)}, which no term uses; remove it'
            )
        if len(used) > REGION:
            raise ValueError(
                f'uses {len(used)} quantities, but at most {REGION} are possible; remove terms'
            )
        if empty := [name for name, (low, high) in self.region.items() if low >= high]:
            raise ValueError(
                f'has an empty range of {", ".join(empty)} in "region"; give the lowest and then '
                'the highest value'
            )
        return self

    @model_validator(mode='after')
    def _check_units(self) -> Self:
        for number, term in enumerate(self.terms, start=1):
            if term.unit != (unit := coefficient_unit(term.axis, term.factors, self.hidden)):
                raise ValueError(
                    f'has the unit "{term.unit}" in term {number}, but its axis and factors give '
                    f'"{unit}"; write that unit'
                )
        return self


def _add_unit(total: Counter[str], unit: str, power: float) -> None:
    """Add a unit such as `rad/s` to exponents of N, V, m and s; angles have no unit."""
    numerator, _, denominator = unit.partition('/')
    for names, sign in ((numerator, power), (denominator, -power)):
        for name in names.split():
            total[name] += sign  # type: ignore[assignment] # exponents may be fractions


def _add_factors(
    total: Counter[str], factors: Iterable[LawFactor], hidden: HiddenState | None, power: float
) -> None:
    """Add the units of factors to exponents."""
    for factor in factors:
        if factor.quantity in (HIDDEN, HIDDEN_RATE):
            _add_factors(total, hidden.drive if hidden else (), None, power * factor.degree)
        _add_unit(total, QUANTITIES[factor.quantity], power * factor.degree)


def _format_unit(total: Counter[str]) -> str:
    """Return exponents as a unit, as files have it: `N s2/m`; '1' if all are 0."""
    powers = {name: round(total[name], 6) for name in ('N', 'V', 'm', 's')}
    up, down = (
        ' '.join(
            f'{name}{"" if sign * power == 1.0 else f"{sign * power:g}"}'
            for name, power in powers.items()
            if sign * power > 0.0
        )
        for sign in (1, -1)
    )
    return (up or '1') + (f'/{down}' if down else '')


def quantity_unit(name: str, hidden: HiddenState | None = None) -> str:
    """Return the SI unit of a quantity of a law with a hidden state."""
    if name not in (HIDDEN, HIDDEN_RATE):
        return QUANTITIES[name]
    total: Counter[str] = Counter()
    _add_factors(total, [LawFactor(quantity=name)], hidden, 1.0)
    return _format_unit(total)


def coefficient_unit(
    axis: str, factors: Iterable[LawFactor], hidden: HiddenState | None = None
) -> str:
    """Return the SI unit of a term's coefficient, such as `N s2` of a moment per (m/s)(rad/s)."""
    total: Counter[str] = Counter()
    _add_unit(total, AXES[axis], 1.0)
    _add_factors(total, factors, hidden, -1.0)
    return _format_unit(total)
