"""Collect all figures derived from a vehicle file."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import final

from lta_model.vehicle import Vehicle
from lta_vehicle.figures.entries import list_numbers, VehicleFileEntry
from lta_vehicle.figures.figure import DerivedFigure
from lta_vehicle.figures.leak_endurance import derive_helium_figures
from lta_vehicle.figures.mass_budget import (
    build_mass_budget,
    derive_balance_figures,
    derive_weight_figures,
    MassBudgetItem,
)
from lta_vehicle.figures.stability import derive_stability_figures
from lta_vehicle.figures.thrust_envelope import derive_rotor_figures, derive_speed_figures


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
        """The figures by key."""
        return {figure.key: figure for figure in self.figures}

    @property
    def groups(self) -> Mapping[str, list[DerivedFigure]]:
        """The figures by group, in order."""
        groups: dict[str, list[DerivedFigure]] = {}
        for figure in self.figures:
            groups.setdefault(figure.group, []).append(figure)
        return groups

    @property
    def assumed_count(self) -> int:
        """Number of file entries that are assumed."""
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
