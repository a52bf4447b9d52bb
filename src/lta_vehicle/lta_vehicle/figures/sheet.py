# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Collect all figures derived from a vehicle file."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import final

from lta_config.quantity import format_with_unit, Quantity
from lta_config.schema.vehicle_file import VehicleFile
from lta_model.vehicle import Vehicle
from lta_vehicle.figures.figure import DerivedFigure
from lta_vehicle.figures.helium_leak import derive_helium_figures
from lta_vehicle.figures.mass_budget import (
    build_mass_budget,
    derive_balance_figures,
    derive_weight_figures,
    MassBudgetItem,
)
from lta_vehicle.figures.stability import derive_stability_figures
from lta_vehicle.figures.thrust_envelope import derive_rotor_figures, derive_speed_figures
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


@final
@dataclass(frozen=True, slots=True)
class VehicleSheet:
    """Properties and performance of a vehicle."""

    vehicle: Vehicle
    figures: Sequence[DerivedFigure]  # derived figures, ordered by group
    budget: Sequence[MassBudgetItem]  # masses of the parts
    numbers: Sequence[VehicleFileEntry]  # all numbers of the vehicle file

    @property
    def by_key(self) -> Mapping[str, DerivedFigure]:
        """Return the figures by key."""
        return {figure.key: figure for figure in self.figures}

    @property
    def groups(self) -> Mapping[str, list[DerivedFigure]]:
        """Return the figures by group, in order."""
        groups: dict[str, list[DerivedFigure]] = {}
        for figure in self.figures:
            groups.setdefault(figure.group, []).append(figure)
        return groups

    @property
    def assumed_count(self) -> int:
        """Return the number of file entries that are assumed."""
        return sum(entry.is_assumed for entry in self.numbers)

    def count_inputs(self, figure: DerivedFigure) -> tuple[int, int]:
        """Return the number of inputs of a figure, and how many of them are assumed."""
        used = [
            entry
            for entry in self.numbers
            if any(
                # 'hull' covers 'hull.diameter', but not 'hull_lift'
                entry.place == place or entry.place.startswith(f'{place}.')
                for place in figure.rests
            )
        ]
        return len(used), sum(entry.is_assumed for entry in used)


def build_sheet(vehicle: Vehicle, held: float | None = None) -> VehicleSheet:
    """
    Derive all figures of a vehicle.

    `held`: loss of lift up to which simulated flights stayed stable, if this was tested [kg].
    """
    figures = [
        *derive_weight_figures(vehicle),
        *derive_balance_figures(vehicle),
        *derive_rotor_figures(vehicle),
        *derive_speed_figures(vehicle),
        *derive_stability_figures(vehicle),
        *derive_helium_figures(vehicle, held),
    ]
    return VehicleSheet(vehicle, figures, build_mass_budget(vehicle), list_numbers(vehicle.file))
