# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Set numbers in a vehicle file, with their sources."""

from collections.abc import Sequence
from pathlib import Path
from typing import final, NamedTuple

from lta_config.atomic_file import replace_atomically
from lta_config.errors import BadInput
from lta_config.files import parse_yaml, validate_content
from lta_config.parameter_override import (
    get_parameter,
    parse_assignment,
    parse_quantity,
    replace_parameter,
)
from lta_config.schema.vehicle_file import VehicleFile
from lta_config.vehicle_edit import set_yaml_values
from lta_model.vehicle import Vehicle

EDIT_ROOT = 'vehicle'


@final
class NumberEdit(NamedTuple):
    """One number that was set: its path, and as text its old and new value and source."""

    path: str
    before: str
    after: str
    source_before: str
    source: str

    @property
    def is_stale(self) -> bool:
        """Whether the number changed and its source did not."""
        return (
            self.before != self.after and bool(self.source) and self.source_before == self.source
        )


def edit_vehicle_file(
    path: Path, assignments: Sequence[str], source: str | None
) -> list[NumberEdit]:
    """
    Set numbers in a vehicle file; comments and order stay.

    `path`: the file. `assignments`: 'PATH=VALUE', such as 'trim.heaviness=3 g'. `source`: source
    of all these numbers; None keeps the sources of the file. Raise `BadInput` if a path does not
    exist, a value is invalid or the file cannot be written; the file is unchanged then.
    """
    try:
        text = path.read_text(encoding='utf-8')
    except (OSError, UnicodeDecodeError):
        raise BadInput(
            f"'{path}' is not a file that can be read; check the path, or copy a shipped vehicle "
            'with lta vehicle new NAME --from VEHICLE.'
        ) from None
    edits = []
    for assignment in assignments:
        place, value = parse_assignment(assignment)
        place = place.removeprefix(f'{EDIT_ROOT}.')
        content = parse_yaml(text, str(path))
        old = get_parameter(content, place, EDIT_ROOT)
        # Checks path, type and dimension, as for --set
        replace_parameter(content, place, value, EDIT_ROOT)
        quantity = parse_quantity(value)
        old_source = str(old.get('source', '')) if isinstance(old, dict) else ''
        if quantity is not None:
            new_source = old_source if source is None else source
            number = shorten_number(quantity['value'])
            value = quantity | {'value': number} | ({'source': new_source} if new_source else {})
        elif source is not None:
            raise BadInput(
                f'{place} has no unit, so the file holds no source for it; leave out --source.'
            )
        text = set_yaml_values(text, {place: value})
        edits.append(
            NumberEdit(
                place, format_number_value(old), format_number_value(value), old_source,
                str(value.get('source', '')) if isinstance(value, dict) else '',
            )
        )  # fmt: skip
    # The whole file must be valid before it replaces the old one
    Vehicle(validate_content(VehicleFile, parse_yaml(text, str(path)), str(path)))
    try:
        with replace_atomically(path) as part:
            part.write_text(text, encoding='utf-8')
    except OSError as error:
        raise BadInput(
            f"'{path}' cannot be written ({error.strerror}); check its permissions."
        ) from error
    return edits


def shorten_number(value: object) -> object:
    """Return a whole number without its decimal point, also in a list."""
    if isinstance(value, list):
        return [shorten_number(each) for each in value]
    return int(value) if isinstance(value, float) and value.is_integer() else value


def format_number_value(value: object) -> str:
    """Return a value as in a file: '3 g', '[1, 0, 0] m/s' or 'true'."""
    quantity = parse_quantity(value)
    if quantity is None:
        return str(value).lower() if isinstance(value, bool) else str(value)
    return f'{quantity["value"]} {quantity["unit"]}'
