# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Quantities in files: a number, its unit and, in vehicle files, its source.

They are written as text, `7 m`, or as a mapping, `{value: [0, 0, -8], unit: cm, source: scale}`,
and converted to SI. A number that is not known well has a `range`, which
`schema.parameter_ranges` draws from. The table below is the only list of units in the project.
"""

import math
import re
from typing import Any, final

from pydantic import (
    BaseModel,
    ConfigDict,
    model_validator,
    ValidatorFunctionWrapHandler,
    WrapValidator,
)

SI_UNITS: dict[str, tuple[str, float]] = {
    # unit as written: (SI unit, factor)
    '1': ('1', 1.0),
    '%': ('1', 0.01),
    'm': ('m', 1.0),
    'cm': ('m', 1e-2),
    'mm': ('m', 1e-3),
    'mm2': ('m2', 1e-6),
    'cm2': ('m2', 1e-4),
    'm2': ('m2', 1.0),
    'kg': ('kg', 1.0),
    'g': ('kg', 1e-3),
    's': ('s', 1.0),
    'ms': ('s', 1e-3),
    'us': ('s', 1e-6),
    'ns': ('s', 1e-9),
    'min': ('s', 60.0),
    'h': ('s', 3600.0),
    'Hz': ('Hz', 1.0),
    'kHz': ('Hz', 1e3),
    '1/m': ('1/m', 1.0),
    '1/s': ('1/s', 1.0),
    '1/K': ('1/K', 1.0),
    '%/K': ('1/K', 0.01),
    'm/s': ('m/s', 1.0),
    'm/s2': ('m/s2', 1.0),
    'rad': ('rad', 1.0),
    'deg': ('rad', math.pi / 180.0),
    'rad/s': ('rad/s', 1.0),
    'deg/s': ('rad/s', math.pi / 180.0),
    'rpm': ('rad/s', math.pi / 30.0),
    'N': ('N', 1.0),
    'mN': ('N', 1e-3),
    'N/m': ('N/m', 1.0),
    'N/V': ('N/V', 1.0),
    'N/V2': ('N/V2', 1.0),
    'N/V3': ('N/V3', 1.0),
    'N m': ('N m', 1.0),
    'mN m': ('N m', 1e-3),
    'N s/m': ('N s/m', 1.0),
    'N s2/m2': ('N s2/m2', 1.0),
    'N m s': ('N m s', 1.0),
    'N m s2': ('N m s2', 1.0),
    # Force per force, as of a thrust column
    'N/N': ('1', 1.0),
    'kg/m2': ('kg/m2', 1.0),
    'g/cm2': ('kg/m2', 10.0),
    's/m2': ('s/m2', 1.0),
    's/cm2': ('s/m2', 1e4),
    'kg m2': ('kg m2', 1.0),
    'kg/m3': ('kg/m3', 1.0),
    'K': ('K', 1.0),
    'K m2/W': ('K m2/W', 1.0),
    'N/s': ('N/s', 1.0),
    # Not converted to K, which would need an offset
    'degC': ('degC', 1.0),
    'Pa': ('Pa', 1.0),
    'hPa': ('Pa', 100.0),
    'Pa/s': ('Pa/s', 1.0),
    'V': ('V', 1.0),
    'mV': ('V', 1e-3),
    'uV': ('V', 1e-6),
    'A': ('A', 1.0),
    'mA': ('A', 1e-3),
    'A/W': ('A/W', 1.0),
    'ohm': ('ohm', 1.0),
    'kohm': ('ohm', 1e3),
    'Mohm': ('ohm', 1e6),
    'eV': ('eV', 1.0),
    'W': ('W', 1.0),
    'mW': ('W', 1e-3),
    'W/N': ('W/N', 1.0),
    # Battery capacities are charges in coulomb
    'A h': ('C', 3600.0),
    'mA h': ('C', 3.6),
    'lx': ('lx', 1.0),
    'klx': ('lx', 1e3),
    'lm': ('lm', 1.0),
    'lm/W': ('lm/W', 1.0),
    'ppm': ('1', 1e-6),
    'ppm/s': ('1/s', 1e-6),
}

UNSOURCED = 'has no source; state where the value comes from, as in "source: measured"'
# A decimal number, then optionally a unit; (?a) keeps \d to ASCII digits
_TEXT = re.compile(r'(?a)^\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(\S.*?)?\s*$')


def _is_plain_number(number: object) -> bool:
    """Return whether a text is a number without a unit."""
    match = _TEXT.match(number) if isinstance(number, str) else None
    return match is not None and match[2] is None


def _parse_numbers(value: Any) -> float | tuple[float, ...]:
    numbers = value if isinstance(value, list | tuple) else [value]
    for number in numbers:
        if isinstance(number, bool) or not isinstance(number, int | float):
            # YAML 1.1, which ROS uses too, reads a number such as 1e-3 as text
            hint = (
                '; write it with a decimal point, as in 1.0e-3' if _is_plain_number(number) else ''
            )
            raise ValueError(
                f'has the value {value!r}, but must be a number or a list of numbers{hint}'
            )
    try:
        floats = tuple(float(number) for number in numbers)
    except OverflowError:
        raise ValueError('has a number that is too large; give one below 1.8e308') from None
    return floats if isinstance(value, list | tuple) else floats[0]


@final
class Quantity(BaseModel):
    """
    A number or a list of numbers with the unit as written and an optional source.

    `range` holds both ends of what is possible, in the same unit and form as the value;
    `range_source` says where it comes from.
    """

    model_config = ConfigDict(frozen=True, extra='forbid', strict=True, defer_build=True)

    value: float | tuple[float, ...]
    unit: str
    source: str | None = None
    range: tuple[float | tuple[float, ...], float | tuple[float, ...]] | None = None
    range_source: str | None = None

    @model_validator(mode='before')
    @classmethod
    def _from_text(cls, value: Any) -> Any:
        if isinstance(value, bool | int | float):
            raise ValueError(f'is {value} and has no unit; add one, as in "7 m"')
        if isinstance(value, str):
            match = _TEXT.match(value)
            if match is None or match.group(2) is None:
                raise ValueError(f'is "{value}", but must be a number and a unit, such as "7 m"')
            return {'value': float(match.group(1)), 'unit': match.group(2)}
        if isinstance(value, dict):
            if 'unit' not in value:
                raise ValueError('has no unit; add one, as in "unit: m"')
            if 'value' in value:
                value = {**value, 'value': _parse_numbers(value['value'])}
            if isinstance(value.get('range'), list):
                value = {**value, 'range': tuple(map(_parse_numbers, value['range']))}
        return value

    @model_validator(mode='after')
    def _check_range(self) -> 'Quantity':
        if (self.range is None) != (not self.range_source):
            raise ValueError('has only one of "range" and "range_source"; give both or neither')
        for end in self.range or ():
            if isinstance(end, tuple) != isinstance(self.value, tuple) or (
                isinstance(end, tuple) and len(end) != len(self._value_as_tuple())
            ):
                raise ValueError(
                    f'has the range {list(self.range or ())}; give two ends in the form of the '
                    'value'
                )
        return self

    @model_validator(mode='after')
    def _check_value(self) -> 'Quantity':
        if self.unit not in SI_UNITS:
            raise ValueError(f'has the unknown unit "{self.unit}"; known: {", ".join(SI_UNITS)}')
        if not all(math.isfinite(number) for number in self.vector):
            raise ValueError(f'is {self.value}, which is not a finite number')
        return self

    def _value_as_tuple(self) -> tuple[float, ...]:
        return self.value if isinstance(self.value, tuple) else (self.value,)

    @property
    def dimension(self) -> str:
        """Return the SI unit of `si`."""
        return SI_UNITS[self.unit][0]

    @property
    def si(self) -> float:
        """Return the number in SI; raises an error if the quantity is a list."""
        (number,) = self._value_as_tuple()  # a list of several numbers fails here
        return number * SI_UNITS[self.unit][1]

    @property
    def vector(self) -> tuple[float, ...]:
        """All numbers in SI; of length 1 for a single number."""
        factor = SI_UNITS[self.unit][1]
        return tuple(number * factor for number in self._value_as_tuple())


def si_quantity(
    dimension: str,
    *,
    low: float = -math.inf,
    high: float = math.inf,
    above: float | None = None,
    length: int = 1,
    sourced: bool = False,
) -> WrapValidator:
    """
    Return a validator, for annotations such as `Annotated[Quantity, VALIDATOR]`.

    Parameters
    ----------
    dimension : str
        The SI unit that the unit must convert to; one of the right-hand sides of `SI_UNITS`.
    low, high : float
        Closed bounds of every number. [SI]
    above : float or None
        Open lower bound, for positive quantities. [SI]
    length : int
        How many numbers the quantity has.
    sourced : bool
        Whether a source is required.

    """

    def check_quantity(value: Any, read: ValidatorFunctionWrapHandler) -> Quantity:
        if isinstance(value, int | float) and not isinstance(value, bool):
            raise ValueError(
                f'is {value} and has no unit; write for example "{value} {dimension}"'
            )
        quantity: Quantity = read(value)
        if complaint := describe_misfit(quantity, dimension, low, high, above, length):
            raise ValueError(complaint)
        if sourced and not quantity.source:
            raise ValueError(UNSOURCED)
        return quantity

    return WrapValidator(check_quantity)


def describe_misfit(
    quantity: Quantity,
    dimension: str,
    low: float = -math.inf,
    high: float = math.inf,
    above: float | None = None,
    length: int = 1,
) -> str | None:
    """Return what is wrong with a quantity, or None; parameters as `si_quantity`."""
    if quantity.dimension != dimension:
        return f'is in {quantity.unit}, but must be in {dimension} or a compatible unit'
    if len(quantity.vector) != length:
        count = len(quantity.vector)
        return f'has {count} number{"" if count == 1 else "s"}, but needs {length}'
    floor = -math.inf if above is None else above
    # Also false for NaN
    if all(low <= number <= high and number > floor for number in quantity.vector):
        return None
    allowed = format_bounds(low if above is None else None, above, high, quantity.unit)
    # State the bounds in the unit that the user wrote
    return f'is {format_quantity(quantity)}, but must be {allowed}'


def format_quantity(quantity: Quantity) -> str:
    """Return a quantity as it is written in a file: `[0, 0, -8] cm`."""
    numbers = quantity.value if isinstance(quantity.value, tuple) else [quantity.value]
    texts = [f'{number:.12g}' for number in numbers]
    text = f'[{", ".join(texts)}]' if isinstance(quantity.value, tuple) else texts[0]
    return format_with_unit(text, quantity.unit)


def format_with_unit(text: str, unit: str) -> str:
    """Return a number with its unit; a dimensionless number has none."""
    return text if unit == '1' else f'{text} {unit}'


def format_bounds(low: float | None, above: float | None, high: float, unit: str) -> str:
    """Return bounds, which are in SI, in words and in a unit."""
    factor = SI_UNITS[unit][1]
    least, floor, most = (
        None if number is None or math.isinf(number) else f'{number / factor:.6g}'
        for number in (low, above, high)
    )
    if least is not None and most is not None:
        return format_with_unit(f'from {least} to {most}', unit)
    words = [
        word + number
        for word, number in (('at least ', least), ('above ', floor), ('at most ', most))
        if number is not None
    ]
    return format_with_unit(' and '.join(words), unit)
