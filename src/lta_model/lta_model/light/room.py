r"""
A closed box with reflecting surfaces, and the light between them.

Of a flux :math:`\Phi` that falls on its surfaces the mean albedo :math:`\varrho` goes on each
time; if that is the same everywhere and from all sides (Sumpner, Phil. Mag. 35, 1893), on a plane
anywhere lie

.. math:: E = \frac{\Phi}{A} \sum_{k \ge 1} \varrho^k = \frac{\Phi \varrho}{A (1 - \varrho)}
"""

from dataclasses import dataclass
import math
from typing import final, NamedTuple

from lta_model.light.light_checks import require

Vector = tuple[float, float, float]


class Albedo(NamedTuple):
    """Reflected share of the light on floor, walls and ceiling, each 0 to below 1."""

    floor: float
    walls: float
    ceiling: float


def uniform_albedo(albedo: float) -> Albedo:
    """Return the same albedo for all surfaces. [1]"""
    return Albedo(albedo, albedo, albedo)


@final
@dataclass(frozen=True, slots=True)
class Room:
    """A box on the floor around the map's origin: length, width and height [m], and albedo."""

    size: Vector
    albedo: Albedo

    def __post_init__(self) -> None:
        """Refuse an impossible room."""
        require(
            all(math.isfinite(side) and side > 0.0 for side in self.size),
            f'The room measures {self.size} m; make every side positive.',
        )
        for name, albedo in self.albedo._asdict().items():
            require(
                0.0 <= albedo < 1.0,
                f'The {name} of the room has an albedo of {albedo}; the albedo must be at least '
                '0 and below 1.',
            )

    @property
    def surface_area(self) -> float:
        """Of all surfaces. [m2]"""
        length, width, height = self.size
        return 2.0 * (length * width + length * height + width * height)

    @property
    def mean_albedo(self) -> float:
        """Albedo of all surfaces, each by its area."""
        length, width, height = self.size
        flat, upright = length * width, 2.0 * height * (length + width)
        floor, walls, ceiling = self.albedo
        return (flat * (floor + ceiling) + upright * walls) / self.surface_area

    def diffuse_illuminance(self, flux: float) -> float:
        """Return the illuminance by light between the surfaces, by a flux on them in lm. [lx]"""
        # Sum of the geometric series of reflections
        return flux * self.mean_albedo / (self.surface_area * (1.0 - self.mean_albedo))
