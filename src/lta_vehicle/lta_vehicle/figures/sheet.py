"""Everything that follows from a vehicle file, with what it follows from."""

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
    """
    What a vehicle is and can do.

    Attributes
    ----------
    vehicle : Vehicle
        The vehicle.
    figures : sequence of Figure
        What follows, group by group.
    budget : sequence of Share
        What its mass is made of.
    numbers : sequence of Entry
        Every number of its file.

    """

    vehicle: Vehicle
    figures: Sequence[DerivedFigure]
    budget: Sequence[MassBudgetItem]
    numbers: Sequence[VehicleFileEntry]

    @property
    def by_key(self) -> Mapping[str, DerivedFigure]:
        """The figures by name."""
        return {figure.key: figure for figure in self.figures}

    @property
    def groups(self) -> Mapping[str, list[DerivedFigure]]:
        """The figures by heading, in order."""
        found: dict[str, list[DerivedFigure]] = {}
        for figure in self.figures:
            found.setdefault(figure.group, []).append(figure)
        return found

    @property
    def assumed_count(self) -> int:
        """How many numbers of the file nobody measured or published."""
        return sum(entry.is_assumed for entry in self.numbers)

    def count_inputs(self, figure: DerivedFigure) -> tuple[int, int]:
        """Return how many numbers a figure rests on, and how many of them are assumed."""
        used = [
            entry
            for entry in self.numbers
            if any(
                entry.place == place or entry.place.startswith(f'{place}.')
                for place in figure.rests
            )
        ]
        return len(used), sum(entry.is_assumed for entry in used)


def build_sheet(vehicle: Vehicle, held: float | None = None) -> VehicleSheet:
    """
    Return what a vehicle is and can do.

    Parameters
    ----------
    vehicle : Vehicle
        The vehicle.
    held : float or None
        Loss of lift up to which its gains held in flight, where that was asked for. [kg]

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
