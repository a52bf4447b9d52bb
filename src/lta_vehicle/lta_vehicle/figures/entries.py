"""Every number of a vehicle file, with its place in the file, its unit and its source."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import final

from lta_config.quantity import Quantity, with_unit
from lta_config.schema.vehicle_file import VehicleFile
from pydantic import BaseModel

# What says in a source that nobody measured or published the number.
GUESSED = ('assumed', 'unverified', 'from memory')


@final
@dataclass(frozen=True, slots=True)
class Entry:
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
    def assumed(self) -> bool:
        """Whether the source says that nobody measured it."""
        return any(word in self.source.lower() for word in GUESSED)


def entries(file: VehicleFile) -> list[Entry]:
    """Return every number and choice of a vehicle file, in the order of the file."""
    found = list(_walk(file, ''))
    return [entry for entry in found if entry.place not in ('schema_version',)]


def numbers(file: VehicleFile) -> list[Entry]:
    """Return the numbers alone: what must have a source."""
    return [entry for entry in entries(file) if entry.numbers]


def _walk(value: object, place: str) -> Iterator[Entry]:
    if value is None:
        return
    if isinstance(value, Quantity):
        yield Entry(
            place,
            written(value),
            value.source or '',
            value.vector,
            '' if value.dimension == '1' else value.dimension,
        )
    elif isinstance(value, BaseModel):
        for name in type(value).model_fields:
            yield from _walk(getattr(value, name), _below(place, name))
    elif isinstance(value, Mapping):
        for name, part in value.items():
            yield from _walk(part, _below(place, str(name)))
    elif isinstance(value, Sequence) and not isinstance(value, str):
        yield Entry(place, ', '.join(str(item) for item in value))
    else:
        yield Entry(
            place, {True: 'yes', False: 'no'}[value] if isinstance(value, bool) else str(value)
        )


def _below(place: str, name: str) -> str:
    return f'{place}.{name}' if place else name


def written(quantity: Quantity) -> str:
    """Return a quantity as the file has it: '[0, 0, -39.5] cm'."""
    if isinstance(quantity.value, tuple):
        return with_unit(
            f'[{", ".join(f"{number:.6g}" for number in quantity.value)}]', quantity.unit
        )
    return with_unit(f'{quantity.value:.6g}', quantity.unit)
