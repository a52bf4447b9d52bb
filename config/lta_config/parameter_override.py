# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Replace single parameters of files by dotted path: `vehicle.trim.heaviness`, `scenario.air.wind.0`.

The replacement happens before validation, so the model's rules apply to the result. The new value
is written as in a file: `4 g`, `[1, 0, 0] m/s`, `0.5`.
"""

from collections.abc import Iterator, Mapping
from contextlib import suppress
import re
from typing import Any, Final, NamedTuple
import zlib

from lta_config.errors import BadInput, unknown_name_error
from lta_config.quantity import Quantity, SI_UNITS
from lta_config.schema.spectrum_file import read_light
import numpy as np
from pydantic import ValidationError
import yaml

OPEN_BLOCK = 'effects'  # the only block below which a path may add keys that the file omits
NAMED_GROUP = 'vehicle.aero'  # a group that may be replaced by the name of an aero file
OVERRIDE_SOURCE = 'set for this flight'  # recorded as the source of a replaced quantity
# A bracketed list, then its unit
_VECTOR = re.compile(r'^\s*(\[[^\]]*\])\s*(\S.*?)\s*$')


def parse_assignment(text: str) -> tuple[str, Any]:
    """
    Return path and value of `PATH=VALUE`.

    Raise `BadInput` if the text has another form, or the value cannot be read.
    """
    path, mark, value = text.partition('=')
    if not mark or not path.strip() or not value.strip():
        raise BadInput(
            f"'{text}' is not an assignment; write PATH=VALUE, as in 'vehicle.trim.heaviness=4 g'."
        )
    return path.strip(), parse_value(value, path.strip())


def parse_value(value: Any, where: str) -> Any:
    """
    Return a value as YAML would hold it: a quantity as a mapping, anything else unchanged.

    `value`: text such as '4 g', '[1, 0, 0] m/s' or 'true', a number, or a mapping with a unit.
    `where`: what the value is for, as the subject of an error message. Raise `BadInput` if the
    text cannot be read.
    """
    if isinstance(value, Mapping):
        return dict(value)
    if not isinstance(value, str):
        return value
    try:
        vector = _VECTOR.match(value)
        if vector is not None:
            numbers = [_parse_number(item) for item in vector.group(1).strip('[]').split(',')]
            return {'value': numbers, 'unit': vector.group(2)}
        quantity = parse_quantity(value)
        return _parse_number(value) if quantity is None else quantity
    except (yaml.YAMLError, ValueError):
        raise BadInput(
            f"{where} cannot be set to '{value}'; write a value such as 0.5, true, '4 g' or "
            "'[1, 0, 0] m/s'."
        ) from None


def _parse_number(text: str) -> Any:
    """Return a word as YAML reads it, and numbers such as 1e-05, which YAML takes for text."""
    read = yaml.safe_load(text)
    if isinstance(read, str):
        with suppress(ValueError):
            return float(read)
    return read


def parse_quantity(held: Any) -> dict[str, Any] | None:
    """Return a value as the mapping of a quantity; None if it is not a quantity."""
    if isinstance(held, Mapping) and 'value' in held and 'unit' in held:
        return dict(held)
    if not isinstance(held, str):
        return None
    try:
        read = Quantity.model_validate(held)
    except ValidationError:
        return None
    return {'value': read.value, 'unit': read.unit}


def replace_parameter(content: Any, path: str, value: Any, root: str) -> Any:
    """
    Return the content of a file with one parameter replaced.

    Parameters
    ----------
    content : Any
        The whole file as YAML holds it; not modified.
    path : str
        Path within the file: 'trim.heaviness'. A number at the end is an index from 0.
    value : Any
        From `parse_value`.
    root : str
        Name of the file in paths: 'vehicle'.

    Raises
    ------
    BadInput
        If the parameter does not exist, or the value has another type or dimension.

    """
    return _replace_at(content, path.split('.'), value, root)


def get_parameter(content: Any, path: str, root: str) -> Any:
    """Return the value at a path; errors as `replace_parameter`."""
    for key in path.split('.'):
        content = _get_child(content, key, root)
        root = f'{root}.{key}'
    return content


def _get_child(content: Any, key: str, where: str) -> Any:
    """Return the value below one key; None if the key is optional and missing."""
    quantity = parse_quantity(content)
    if quantity is not None:
        return _select_element(quantity, key, where)
    if content is None and OPEN_BLOCK in where.split('.'):  # a parameter of an omitted effect
        return None
    if not isinstance(content, Mapping):
        raise BadInput(
            f"{where} is a single value without keys; remove '.{key}' from the parameter path."
        )
    if key not in content and OPEN_BLOCK not in where.split('.'):
        raise unknown_name_error(f'key of {where}', key, [str(name) for name in content])
    return content.get(key)


def _select_element(quantity: Mapping[str, Any], key: str, where: str) -> dict[str, Any]:
    """Return one element of a vector quantity as a quantity."""
    numbers = quantity['value']
    if not isinstance(numbers, list | tuple):
        raise BadInput(
            f"{where} is a single value without keys; remove '.{key}' from the parameter path."
        )
    if not (key.isdecimal() and int(key) < len(numbers)):
        raise unknown_name_error(
            f'index of {where}', key, [str(index) for index in range(len(numbers))]
        )
    return {'value': numbers[int(key)], 'unit': quantity['unit']}


def _replace_at(content: Any, keys: list[str], value: Any, where: str) -> Any:
    if not keys:
        return _validate_replacement(content, value, where)
    key, *rest = keys
    below = _get_child(content, key, where)
    if below is None and not rest:  # an omitted parameter of an effect
        return {**content, key: _mark_source(value)}
    new = _replace_at({} if below is None else below, rest, value, f'{where}.{key}')
    quantity = parse_quantity(content)
    return (
        {**content, key: new} if quantity is None else _copy_with_element(quantity, int(key), new)
    )


def _copy_with_element(
    quantity: dict[str, Any], index: int, new: Mapping[str, Any]
) -> dict[str, Any]:
    """Return a quantity with one element replaced, in its original unit."""
    factor = SI_UNITS[new['unit']][1] / SI_UNITS[quantity['unit']][1]
    numbers = list(quantity['value'])
    # Not multiplied for an equal unit, to avoid a rounding error
    numbers[index] = new['value'] if new['unit'] == quantity['unit'] else new['value'] * factor
    return {'value': numbers, 'unit': quantity['unit'], 'source': OVERRIDE_SOURCE}


def _validate_replacement(old: Any, value: Any, where: str) -> Any:
    """Return the new value if it has the type of the old one."""
    # A light is a number or the name of its spectrum
    if where.endswith('.efficacy'):
        old, value = read_light(old), read_light(value)
    before, now = parse_quantity(old), parse_quantity(value)
    if before is not None:
        return _mark_source(_check_same_unit(before, now, value, where))
    # An aero block may be replaced by the name of a file
    if where == NAMED_GROUP and isinstance(value, str):
        return value
    if isinstance(old, Mapping):
        names = ', '.join(map(str, old))
        raise BadInput(f'{where} is a group of parameters; set one of its keys: {names}.')
    if now is not None:
        raise BadInput(
            f'{where} has no unit, so it cannot be set to {format_value(value)}; give a value '
            f'such as {old}.'
        )
    # bool is a subclass of int
    number = isinstance(old, int | float) and not isinstance(old, bool)
    if number and (isinstance(value, bool) or not isinstance(value, int | float)):
        raise BadInput(f'{where} is {format_value(value)}, but must be a number, such as {old}.')
    return float(value) if isinstance(old, float) else value


def _check_same_unit(
    before: Mapping[str, Any],
    now: dict[str, Any] | None,
    value: Any,
    where: str,
) -> dict[str, Any]:
    unit = before['unit']
    if now is None:
        raise BadInput(
            f'{where} is {format_value(value)}, but must be a number with a unit, such as '
            f'"1 {unit}".'
        )
    if now['unit'] not in SI_UNITS:
        raise BadInput(
            f'{where} has the unknown unit "{now["unit"]}"; known: {", ".join(SI_UNITS)}.'
        )
    if SI_UNITS[now['unit']][0] != SI_UNITS.get(unit, (unit,))[0]:
        raise BadInput(f'{where} is in {now["unit"]}, but must be in {unit} or a compatible unit.')
    return now


def _mark_source(value: Any) -> Any:
    quantity = parse_quantity(value)
    return value if quantity is None else {**quantity, 'source': OVERRIDE_SOURCE}


def format_value(value: Any) -> str:
    """Return a value as it is written in a file."""
    quantity = parse_quantity(value)
    return str(value) if quantity is None else f'{quantity["value"]} {quantity["unit"]}'


RANGE_SOURCE: Final = 'drawn from its range'


class AssumedNumber(NamedTuple):
    """A number with a range: its dotted path in the file, and the quantity as YAML holds it."""

    path: str
    quantity: Mapping[str, Any]


def list_ranges(content: Any, path: str = '') -> list[AssumedNumber]:
    """Return all numbers of a file that have a range, in the order of the file."""
    return list(_iterate_ranges(content, path))


def _iterate_ranges(content: Any, path: str) -> Iterator[AssumedNumber]:
    if not isinstance(content, Mapping):
        return
    if 'range' in content and 'unit' in content:
        yield AssumedNumber(path, content)
        return
    for key, below in content.items():
        yield from _iterate_ranges(below, f'{path}.{key}' if path else str(key))


def draw_values(content: Any, seed: int, path: str = '') -> dict[str, dict[str, Any]]:
    """
    Return drawn values of all numbers of a file that have a range, by path.

    Parameters
    ----------
    content : Any
        The whole file as YAML holds it.
    seed : int
        Number of the draw.
    path : str
        Prefix of the paths, such as 'vehicle'.

    Returns
    -------
    dict
        Quantities as YAML holds them, for `FlightSpec.with_values`.

    """
    return {
        entry.path: {
            'value': draw_between(entry.quantity['range'], entry.quantity['range_source'], seed),
            'unit': entry.quantity['unit'],
            'source': RANGE_SOURCE,
        }
        for entry in list_ranges(content, path)
    }


def draw_content(content: Any, seed: int, root: str) -> Any:
    """Return the content of a file with all numbers that have a range drawn."""
    for path, value in draw_values(content, seed).items():
        content = replace_parameter(content, path, value, root)
    return content


def draw_between(ends: Any, cause: str, seed: int) -> Any:
    """Return a number or a list between two ends; equal causes and seeds give equal shares."""
    # CRC-32, because Python's own hash of a text differs between processes
    share = np.random.default_rng([seed, zlib.crc32(cause.encode())]).uniform()
    low, high = (np.asarray(end, dtype=float) for end in ends)
    return (low + share * (high - low)).tolist()
