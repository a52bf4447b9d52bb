# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Generate the page of all keys of a vehicle file from its schema."""

from collections.abc import Iterator, Mapping, Sequence
import inspect
import re
from typing import Any, Final, get_args, get_origin, Literal, Union

from lta_config.quantity import format_bounds as format_quantity_bounds
from lta_config.quantity import Quantity, SI_UNITS
from lta_config.schema.vehicle_file import VehicleFile
from lta_config.settings import format_bounds
from pydantic import BaseModel, WrapValidator

HEAD: Final = """# Every key of a vehicle file

Generated from the schema by `make reference`.

A number is `{value: 7, unit: g, source: "kitchen scale"}`, with a list as `value` where several
are asked for. Any unit that converts to the one in brackets will do. An assumed number may also
have a `range: [low, high]` and a `range_source`. `NAME` stands for a name of your own. Keys in
**bold** must be there; the others have a default, or switch something on. `./lta vehicle new`
writes a file from size, mass and motors, `./lta vehicle check` names what is wrong with one, and
[the tutorial](tutorials/your_vehicle.md) shows how to change it.

"""
Entry = tuple[str, Any]


def render_page() -> str:
    """Return the page: a section for each block of the file."""
    sections = list(_iterate_sections('', VehicleFile))
    return HEAD + '\n'.join(sections)


def _iterate_sections(path: str, model: type[BaseModel]) -> Iterator[str]:
    """Yield the section of a model, then those of the blocks in it."""
    comments = _read_comments(model)
    rows, below = [], []
    for name, field in model.model_fields.items():
        alias = field.validation_alias
        key = 'schema' if alias is not None else name
        kind, inner, steps = _describe_type(field.annotation, field.metadata)
        bounds = format_bounds(field) if kind == 'number' else ''
        label = f'**`{key}`**' if field.is_required() else f'`{key}`'
        text = comments.get(name, '')
        if key == 'effects':
            kind, text = (
                '[block](effects.md)',
                'A block of parameters for each effect beyond weight, buoyancy, drag and thrust.',
            )
        if inner is not None:
            place = '.'.join(filter(None, (path, key, *steps)))
            below.append((place, inner))
            kind = f'[block](#{place.lower().replace(".", "")})'
            if not path:  # others stand right above the section that says it
                text = text or inspect.cleandoc(inner.__doc__ or '').splitlines()[0]
        cell = ', '.join(filter(None, (kind, bounds)))
        rows.append(f'- {label} ({cell}){f": {text}" if text else ""}\n')
    about = inspect.cleandoc(model.__doc__ or '').split('\n\nAttributes\n')[0]
    title = f'## {path}\n{about}\n\n' if path else ''
    yield f'{title}{"".join(rows)}'
    for place, inner in below:
        yield from _iterate_sections(place, inner)


def _describe_type(
    annotation: Any,
    metadata: Sequence[Any],
) -> tuple[str, type[BaseModel] | None, list[str]]:
    """Return a type in words, the model of a block, and the steps of the path to it."""
    for item in metadata:
        if isinstance(item, WrapValidator):
            return _describe_quantity(item), None, []
    origin, args = get_origin(annotation), get_args(annotation)
    if hasattr(annotation, '__metadata__'):
        return _describe_type(args[0], annotation.__metadata__)
    if origin is Literal:
        return ' or '.join(f'`{each}`' for each in args), None, []
    if origin is Union or type(None) in args:
        (one, *_) = [each for each in args if each is not type(None)]
        return _describe_type(one, getattr(one, '__metadata__', ()))
    if isinstance(origin, type) and issubclass(origin, Mapping):
        kind, inner, steps = _describe_type(args[1], getattr(args[1], '__metadata__', ()))
        return f'by name: {kind}', inner, ['NAME', *steps]
    if origin is list:
        return f'list of {_describe_type(args[0], ())[0]}s', None, []
    if annotation is Quantity:
        return 'number', None, []
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return 'block', annotation, []
    words = {str: 'text', bool: 'true or false', int: 'number', float: 'number'}
    return words.get(annotation, 'as declared'), None, []


def _describe_quantity(validator: WrapValidator) -> str:
    """Return the unit, count and bounds of a quantity, which its validator encloses."""
    limits = inspect.getclosurevars(validator.func).nonlocals
    unit = limits['dimension']
    # Charges are written in mA h
    unit_label = 'mA h' if unit == 'C' else unit
    low = limits['low'] if limits['above'] is None else None
    file_unit = next(
        word
        for word, (kind, factor) in SI_UNITS.items()
        if (kind == unit and factor == 1.0) or word == unit_label
    )
    bounds = format_quantity_bounds(low, limits['above'], limits['high'], file_unit)
    bounds = bounds if bounds.strip() not in {'', file_unit} else ''
    count = f'{limits["length"]} numbers' if limits['length'] > 1 else 'number'
    return ', '.join(filter(None, (f'{count} [{unit_label}]', bounds)))


def _read_comments(model: type[BaseModel]) -> dict[str, str]:
    """Return the comment of each field: at its line, or above it."""
    comments, above = {}, ''
    for line in inspect.getsource(model).splitlines():
        if whole := re.match(r'    # (.*)', line):
            above = f'{above} {whole[1]}'.strip()
            continue
        if field := re.match(r'    (\w+): .*?(?:  # (.*))?$', line):
            comments[field[1]] = (field[2] or above).replace('|', '\\|')
        above = ''
    return comments
