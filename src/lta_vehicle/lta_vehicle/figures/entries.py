"""List the entries of a vehicle file with path, unit and source."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import final

from lta_config.quantity import format_with_unit, Quantity
from lta_config.schema.vehicle_file import VehicleFile
from pydantic import BaseModel

# Words in a source that mark a number as neither measured nor published
GUESSED = ('assumed', 'unverified', 'from memory')


@final
@dataclass(frozen=True, slots=True)
class VehicleFileEntry:
    """A number or a choice in a vehicle file."""

    place: str  # dotted path, such as 'layers.top.solar_panels.mass'
    value: str  # value as written, with its unit
    source: str = ''  # source of the number; '' for choices such as the hull shape
    numbers: tuple[float, ...] = ()  # SI values; empty for choices
    unit: str = ''  # SI unit of the numbers

    @property
    def is_assumed(self) -> bool:
        """Whether the source marks the number as assumed."""
        return any(word in self.source.lower() for word in GUESSED)


def list_entries(file: VehicleFile) -> list[VehicleFileEntry]:
    """Return all numbers and choices of a vehicle file, in file order."""
    entries = list(_iterate_entries(file, ''))
    # The schema version describes the file format and not the vehicle
    return [entry for entry in entries if entry.place not in ('schema_version',)]


def list_numbers(file: VehicleFile) -> list[VehicleFileEntry]:
    """Return only the numbers, which need a source."""
    return [entry for entry in list_entries(file) if entry.numbers]


def _iterate_entries(value: object, place: str) -> Iterator[VehicleFileEntry]:
    if value is None:
        return
    if isinstance(value, Quantity):
        yield VehicleFileEntry(
            place,
            format_quantity(value),
            value.source or '',
            value.vector,
            # Dimensionless numbers have no unit symbol
            '' if value.dimension == '1' else value.dimension,
        )
    elif isinstance(value, BaseModel):
        for name in type(value).model_fields:
            yield from _iterate_entries(getattr(value, name), _join_path(place, name))
    elif isinstance(value, Mapping):
        for name, part in value.items():
            yield from _iterate_entries(part, _join_path(place, str(name)))
    # Lists without units, such as names
    elif isinstance(value, Sequence) and not isinstance(value, str):
        yield VehicleFileEntry(place, ', '.join(str(item) for item in value))
    else:
        yield VehicleFileEntry(
            place, {True: 'yes', False: 'no'}[value] if isinstance(value, bool) else str(value)
        )


def _join_path(place: str, name: str) -> str:
    return f'{place}.{name}' if place else name


def format_quantity(quantity: Quantity) -> str:
    """Format a quantity in the unit of the file, such as '[0, 0, -39.5] cm'."""
    if isinstance(quantity.value, tuple):
        return format_with_unit(
            f'[{", ".join(f"{number:.6g}" for number in quantity.value)}]', quantity.unit
        )
    return format_with_unit(f'{quantity.value:.6g}', quantity.unit)
