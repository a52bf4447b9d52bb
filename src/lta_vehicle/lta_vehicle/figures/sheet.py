"""Everything that follows from a vehicle file, with what it follows from."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import final

from lta_model.vehicle import Vehicle
from lta_vehicle.figures.entries import Entry, numbers
from lta_vehicle.figures.figure import Figure
from lta_vehicle.figures.pushing import rotor_figures, speed_figures
from lta_vehicle.figures.staying import helium_figures
from lta_vehicle.figures.steadiness import steadiness_figures
from lta_vehicle.figures.weighing import balance_figures, budget, Share, weight_figures


@final
@dataclass(frozen=True, slots=True)
class Sheet:
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
    figures: Sequence[Figure]
    budget: Sequence[Share]
    numbers: Sequence[Entry]

    @property
    def by_key(self) -> Mapping[str, Figure]:
        """The figures by name."""
        return {figure.key: figure for figure in self.figures}

    @property
    def groups(self) -> Mapping[str, list[Figure]]:
        """The figures by heading, in order."""
        found: dict[str, list[Figure]] = {}
        for figure in self.figures:
            found.setdefault(figure.group, []).append(figure)
        return found

    @property
    def assumed(self) -> int:
        """How many numbers of the file nobody measured or published."""
        return sum(entry.assumed for entry in self.numbers)

    def rests_on(self, figure: Figure) -> tuple[int, int]:
        """Return how many numbers a figure rests on, and how many of them are assumed."""
        used = [
            entry
            for entry in self.numbers
            if any(
                entry.place == place or entry.place.startswith(f'{place}.')
                for place in figure.rests
            )
        ]
        return len(used), sum(entry.assumed for entry in used)


def sheet_of(vehicle: Vehicle, held: float | None = None) -> Sheet:
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
        *weight_figures(vehicle),
        *balance_figures(vehicle),
        *rotor_figures(vehicle),
        *speed_figures(vehicle),
        *steadiness_figures(vehicle),
        *helium_figures(vehicle, held),
    ]
    return Sheet(vehicle, figures, budget(vehicle), numbers(vehicle.file))
