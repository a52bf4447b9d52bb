"""Every number of a vehicle file, with its place in the file, its unit and its source."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import final

from lta_config.quantity import add_unit, Quantity
from lta_config.schema.vehicle_file import VehicleFile
from pydantic import BaseModel

# What says in a source that nobody measured or published the number.
GUESSED = ('assumed', 'unverified', 'from memory')


@final
@dataclass(frozen=True, slots=True)
class VehicleFileEntry:
    """
    One number, or one choice, of a file.

    Attributes
    ----------
    place : str
        Dotted, as in the file: 'layers.top.solar_panels.mass'.
    value : str
        As people write it, with its unit.
    source : str
        Where it comes from; '' for choices such as the shape of a hull.
    numbers : tuple of float
        In SI; empty for choices.
    unit : str
        SI unit of the numbers.

    """

    place: str
    value: str
    source: str = ''
    numbers: tuple[float, ...] = ()
    unit: str = ''

    @property
    def is_assumed(self) -> bool:
        """Whether the source says that nobody measured it."""
        return any(word in self.source.lower() for word in GUESSED)


def list_entries(file: VehicleFile) -> list[VehicleFileEntry]:
    """Return every number and choice of a vehicle file, in the order of the file."""
    found = list(_walk_entries(file, ''))
    return [entry for entry in found if entry.place not in ('schema_version',)]


def list_numbers(file: VehicleFile) -> list[VehicleFileEntry]:
    """Return the numbers alone: what must have a source."""
    return [entry for entry in list_entries(file) if entry.numbers]


def _walk_entries(value: object, place: str) -> Iterator[VehicleFileEntry]:
    if value is None:
        return
    if isinstance(value, Quantity):
        yield VehicleFileEntry(
            place,
            format_quantity(value),
            value.source or '',
            value.vector,
            '' if value.dimension == '1' else value.dimension,
        )
    elif isinstance(value, BaseModel):
        for name in type(value).model_fields:
            yield from _walk_entries(getattr(value, name), _join_path(place, name))
    elif isinstance(value, Mapping):
        for name, part in value.items():
            yield from _walk_entries(part, _join_path(place, str(name)))
    elif isinstance(value, Sequence) and not isinstance(value, str):
        yield VehicleFileEntry(place, ', '.join(str(item) for item in value))
    else:
        yield VehicleFileEntry(
            place, {True: 'yes', False: 'no'}[value] if isinstance(value, bool) else str(value)
        )


def _join_path(place: str, name: str) -> str:
    return f'{place}.{name}' if place else name


def format_quantity(quantity: Quantity) -> str:
    """Return a quantity as the file has it: '[0, 0, -39.5] cm'."""
    if isinstance(quantity.value, tuple):
        return add_unit(
            f'[{", ".join(f"{number:.6g}" for number in quantity.value)}]', quantity.unit
        )
    return add_unit(f'{quantity.value:.6g}', quantity.unit)
