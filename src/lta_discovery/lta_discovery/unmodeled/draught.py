"""
Detect a draught: slow air motion that pushes the vehicle, while no effect is missing.

Its force is horizontal, isotropic in the horizontal plane, and follows no measured quantity. A
larger force of this kind is gusts, which stay unexplained.
"""

from collections.abc import Sequence
import math
from typing import Final, final, NamedTuple

from lta_discovery.fit.evidence import MEMORY
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.unmodeled.latent_series import LatentSeries
from lta_discovery.unmodeled.rivals import GenericRival
from lta_discovery.unmodeled.unexplained_force import CARRIED, Remainder
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

LEVEL: Final = ('surge', 'sway')
LEAST: Final = 0.7  # noise floors; simulated flights in still air reach 0.3
# Noise floors; above it names are in question (`residual_guards.LOUD`). For a GT-MAB it is
# 1.6 mN, as of air at 4 mm/s: a closed room has less, a fan or a door more.
MOST: Final = 4.0
QUIET: Final = 0.5  # of the horizontal force; limit of the vertical one
CHANCE: Final = 1e-3  # significance level of the test of isotropy


@final
class DraughtEstimate(NamedTuple):
    """A draught."""

    force: float  # root mean square along each horizontal direction [N]
    speed: float  # approximate speed of the air [m/s]

    @property
    def sentence(self) -> str:
        """Description in words."""
        return (
            f'a draught: a random horizontal force of {1e3 * self.force:.2g} mN, '
            f'as from air moving at about {1e3 * self.speed:.2g} mm/s'
        )


def isotropy_p_value(pair: Array, count: float) -> float:
    """
    Return the probability that an isotropic force differs as much between directions.

    Mauchly's test of sphericity, exact for two normal variables of mean 0.

    `count`: equivalent number of independent values.
    """
    products = pair.T @ pair
    half = 0.5 * float(np.trace(products))
    if half <= 0.0:
        return 1.0
    # 1 for a circle, 0 for a line; rounding may make the determinant negative
    alike = max(float(np.linalg.det(products)), 0.0) / half**2
    return float(alike ** (0.5 * max(count - 1.0, 0.0)))


def is_horizontally_isotropic(series: Sequence[LatentSeries]) -> bool:
    """Return whether a force is horizontal and isotropic in the horizontal plane."""
    ground = np.concatenate([each.ground for each in series])
    body = np.concatenate([each.body for each in series])
    # RMS force along each axis of the map
    x, y, z = np.sqrt(np.mean(ground**2, axis=0))
    if z > QUIET * math.sqrt(0.5 * (x**2 + y**2)):
        return False
    # An Ornstein-Uhlenbeck process has one independent square per memory; air has a longer one.
    count = sum(each.duration for each in series) / (2.0 * MEMORY)
    # Test both frames: turning makes a body-fixed force isotropic in the map, and vice versa.
    return min(isotropy_p_value(each[:, :2], count) for each in (ground, body)) > CHANCE


def is_one_sided(rival: GenericRival) -> bool:
    """
    Return whether a rival explains only one of surge and sway.

    This does not explain an isotropic force: with dozens of rivals, one fits two flights by
    chance.
    """
    return len(rival.axes) == 1 and rival.axes[0] in LEVEL


def estimate_air_speed(force: float, nominal: NominalVehicle) -> float:
    """
    Estimate the speed of air that exerts a force. [m/s]

    Accelerating air pushes with its acceleration times displaced plus added mass. Drag is a
    quarter of that for a blimp at 0.5 m/s, and quadratic drag has no slope at rest. The air
    changes its speed within MEMORY, as the force does.

    `force`: root mean square along one direction [N].
    """
    masses = np.linalg.inv(np.reshape(nominal.build_model().inverse, (6, 6)))
    # Mean horizontal added mass plus displaced air; the rigid mass is subtracted
    moved = 0.5 * (masses[0, 0] + masses[1, 1]) - nominal.mass + nominal.displaced
    return float(force * MEMORY / moved)


def detect_draught(
    deviations: Array,
    floor: Array,
    left: Sequence[Remainder],
    rivals: Sequence[GenericRival],
    series: Sequence[LatentSeries],
    nominal: NominalVehicle,
) -> DraughtEstimate | None:
    """Return the draught if it explains the whole remainder, else None."""
    floors = (deviations / floor)[:2]
    # Too weak to report, or strong enough to put names in question
    if floors.min() < LEAST or floors.max() >= MOST:
        return None
    if any(one.axis not in LEVEL or one.carried > CARRIED for one in left):
        return None
    if not all(map(is_one_sided, rivals)) or not is_horizontally_isotropic(series):
        return None
    # Geometric mean of surge and sway
    force = math.sqrt(float(deviations[0] * deviations[1]))
    return DraughtEstimate(force, estimate_air_speed(force, nominal))
