"""
Draw the random parameters of a sweep, by path and sample.

Each path has its own random stream, seeded by its name, so a further parameter does not change the
others. Each sample has its own as well, so more samples only extend the list.
"""

from typing import Any
import zlib

from lta_config.errors import BadInput
from lta_config.parameter_override import format_value, parse_quantity, parse_value
from lta_config.quantity import SI_UNITS
from lta_config.schema.sweep_file import Distribution, NormalDistribution, UniformDistribution
import numpy as np
from numpy.random import Generator

NORMAL_TRIES = 10_000  # draws of a bounded normal distribution before it is an error


def sample_parameter(how: Distribution, path: str, seed: int, sample: int) -> Any:  # noqa: ANN401 - YAML's
    """
    Return the value of one parameter in one sample, as a file would hold it.

    `path`: path of the parameter. `seed`: seed of the sweep. `sample`: index of the sample. Raise
    `BadInput` if the distribution is invalid.
    """
    # CRC-32, because Python's own hash of a text differs between processes
    chance = np.random.default_rng([seed, zlib.crc32(path.encode()), sample])
    if how.choice is not None:
        return parse_value(how.choice[int(chance.integers(len(how.choice)))], path)
    if how.normal is not None:
        return _draw_normal(how.normal, path, chance)
    if how.uniform is not None:
        low, high, unit = _parse_bounds(how.uniform, path)
        return _build_quantity(float(chance.uniform(low, high)), unit)
    if how.loguniform is None:
        raise BadInput(f'{path} has no distribution; give uniform, loguniform, normal or choice.')
    low, high, unit = _parse_bounds(how.loguniform, path)
    if low <= 0.0:
        raise BadInput(
            f'{path} has a loguniform distribution from {low:g} {unit}; low must be above 0.'
        )
    # Uniform in the logarithm
    return _build_quantity(float(np.exp(chance.uniform(np.log(low), np.log(high)))), unit)


def _draw_normal(how: NormalDistribution, path: str, chance: Generator) -> Any:  # noqa: ANN401 - YAML's
    numbers = [how.mean, how.deviation, how.low, how.high]
    (mean, deviation, low, high), unit = _convert_to_common_unit(numbers, path)
    if mean is None or deviation is None or deviation < 0.0:
        raise BadInput(
            f'{path} has the standard deviation {format_value(how.deviation)}; it must be at '
            'least 0.'
        )
    for _ in range(NORMAL_TRIES):
        sample = float(chance.normal(mean, deviation))
        if (low is None or sample >= low) and (high is None or sample <= high):
            return _build_quantity(sample, unit)
    raise BadInput(
        f'The normal distribution of {path} gives almost no values between low and high; change '
        'mean, low or high.'
    )


def _parse_bounds(how: UniformDistribution, path: str) -> tuple[float, float, str]:
    (low, high), unit = _convert_to_common_unit([how.low, how.high], path)
    if low is None or high is None or not low < high:
        raise BadInput(
            f'{path} is drawn from {format_value(how.low)} to {format_value(how.high)}; low must '
            'be below high.'
        )
    return low, high, unit


def _convert_to_common_unit(items: list[Any], path: str) -> tuple[list[float | None], str]:
    """Return numbers in the unit of the first, and that unit; '' for plain numbers."""
    values = [None if item is None else parse_value(item, path) for item in items]
    first = parse_quantity(values[0])
    unit = '' if first is None else str(first['unit'])
    if unit and unit not in SI_UNITS:
        raise BadInput(f'{path} has the unknown unit "{unit}"; known: {", ".join(SI_UNITS)}.')
    return [
        None if value is None else _convert_number(value, unit, path) for value in values
    ], unit


def _convert_number(value: Any, unit: str, path: str) -> float:  # noqa: ANN401 - YAML's
    quantity = parse_quantity(value)
    number = value if quantity is None else quantity['value']
    plain = isinstance(number, int | float) and not isinstance(number, bool)
    if not plain or (quantity is None) != (unit == ''):
        raise BadInput(
            f'{path} has {format_value(value)} in its distribution; give all numbers '
            'either with or without a unit.'
        )
    # No conversion, to avoid a rounding error
    if quantity is None or quantity['unit'] == unit:
        return float(number)
    if quantity['unit'] not in SI_UNITS or SI_UNITS[quantity['unit']][0] != SI_UNITS[unit][0]:
        raise BadInput(f'{path} mixes {unit} and {quantity["unit"]}; use compatible units.')
    return float(number) * SI_UNITS[quantity['unit']][1] / SI_UNITS[unit][1]


def _build_quantity(number: float, unit: str) -> Any:  # noqa: ANN401 - YAML's
    return {'value': number, 'unit': unit} if unit else number
