"""
A draught: air that moves a little by itself pushes the vehicle about, and nothing is missing.

Its force is horizontal, alike in all horizontal directions of the map (and so ahead and aside as
well), and follows nothing that was measured. It is a finding of its own as long as it is small;
a larger force of this kind is gusts, and those stay unexplained.
"""

from collections.abc import Sequence
import math
from typing import Final, final, NamedTuple

from lta_discovery.fit.evidence import MEMORY
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.unmodeled.latent_series import LatentSeries
from lta_discovery.unmodeled.remainders import CARRIED, Remainder
from lta_discovery.unmodeled.rivals import GenericRival
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

LEVEL: Final = ('surge', 'sway')
LEAST: Final = 0.7  # floors; made flights in still air have 0.3 at most
# Floors; from there a force puts a name in question (`naming.beside.LOUD`). For a GT-MAB it is
# 1.6 mN, as of air at 4 mm/s: a closed room has less, and what a fan or a door makes is gusts.
MOST: Final = 4.0
QUIET: Final = 0.5  # of the horizontal force; what the vertical one stays below
CHANCE: Final = 1e-3  # that a draught differs by as much from one direction to another


@final
class DraughtFinding(NamedTuple):
    """
    Air that moves by itself.

    Attributes
    ----------
    force : float
        Root mean square along each horizontal direction. [N]
    speed : float
        Of air that would exert it, roughly, the same way. [m/s]

    """

    force: float
    speed: float

    @property
    def sentence(self) -> str:
        """For people."""
        return (
            f'a draught: a horizontal force that follows nothing, {1e3 * self.force:.2g} mN, '
            f'as air moving at about {1e3 * self.speed:.2g} mm/s would exert'
        )


def isotropy_probability(pair: Array, count: float) -> float:
    """
    Return the chance that a force alike in all directions of a plane differs as much as this.

    Mauchly's test of sphericity, which is exact for two normal variables of mean 0.

    Parameters
    ----------
    pair : ndarray, shape (N, 2)
        Two components at right angles.
    count : float
        How many independent values that is worth.

    """
    products = pair.T @ pair
    half = 0.5 * float(np.trace(products))
    if half <= 0.0:
        return 1.0
    alike = max(float(np.linalg.det(products)), 0.0) / half**2
    return float(alike ** (0.5 * max(count - 1.0, 0.0)))


def is_horizontal(series: Sequence[LatentSeries]) -> bool:
    """Tell whether a force lies in the horizontal plane and is alike in all its directions."""
    ground = np.concatenate([each.ground for each in series])
    body = np.concatenate([each.body for each in series])
    x, y, z = np.sqrt(np.mean(ground**2, axis=0))
    if z > QUIET * math.sqrt(0.5 * (x**2 + y**2)):
        return False
    # An Ornstein-Uhlenbeck process has one independent square in its memory; air remembers longer.
    count = sum(each.duration for each in series) / (2.0 * MEMORY)
    # What belongs to the body is alike in the map as soon as the heading turns, and the reverse.
    return min(isotropy_probability(each[:, :2], count) for each in (ground, body)) > CHANCE


def is_one_sided(rival: GenericRival) -> bool:
    """
    Tell whether a rival explains one of surge and sway alone.

    Of a force that is alike on both it is no explanation: on two flights of a draught one of
    dozens of them wins by chance.
    """
    return len(rival.axes) == 1 and rival.axes[0] in LEVEL


def estimate_air_speed(force: float, nominal: NominalVehicle) -> float:
    """
    Return how fast air moves that exerts a force, roughly. [m/s]

    Air that gains speed pushes with its acceleration times the displaced and the added mass. Drag
    is a fourth of that for a blimp at 0.5 m/s, and quadratic drag has no slope at rest. A force
    that forgets itself in MEMORY is of air that gains its speed in about as long.

    Parameters
    ----------
    force : float
        Root mean square along one direction. [N]
    nominal : Nominal
        The vehicle.

    """
    masses = np.linalg.inv(np.reshape(nominal.build_model().inverse, (6, 6)))
    moved = 0.5 * (masses[0, 0] + masses[1, 1]) - nominal.mass + nominal.displaced
    return float(force * MEMORY / moved)


def detect_draught(
    deviations: Array,
    floor: Array,
    left: Sequence[Remainder],
    rivals: Sequence[GenericRival],
    series: Sequence[LatentSeries],
    nominal: NominalVehicle,
) -> DraughtFinding | None:
    """
    Return the draught, where what remains is one and nothing else; else None.

    Parameters
    ----------
    deviations, floor : ndarray, shape (6,)
        Of the latent wrench, and what is not worth speaking of. [N, N m]
    left : sequence of Remainder
        Axes that stand clear of the floor, with what they follow by themselves.
    rivals : sequence of Rival
        Those that tell that something is there.
    series : sequence of LatentSeries
        Of all flights.
    nominal : Nominal
        The vehicle.

    """
    floors = (deviations / floor)[:2]
    if floors.min() < LEAST or floors.max() >= MOST:
        return None
    if any(one.axis not in LEVEL or one.carried > CARRIED for one in left):
        return None
    if not all(map(is_one_sided, rivals)) or not is_horizontal(series):
        return None
    force = math.sqrt(float(deviations[0] * deviations[1]))
    return DraughtFinding(force, estimate_air_speed(force, nominal))
