"""
Light of sun and sky over level ground.

The sky is uniformly bright, the ground reflects its albedo, and the sun is a small disc. The sun
gives up to some 100 klx on a facing plane, a clear sky 10 to 20 klx on level ground; daylight has
105 lm/W (all from memory).
"""

from dataclasses import dataclass
import math
from typing import final

from lta_model.light.light_checks import require, require_efficacy, require_lux

Vector = tuple[float, float, float]


@final
@dataclass(frozen=True, slots=True)
class Daylight:
    """
    Sun and sky.

    Parameters
    ----------
    sun, sky : float
        Illuminance by the sun on a facing plane, and by the sky on level ground. [lx]
    azimuth, elevation : float
        Of the sun: from map x towards y, and above the horizon. [rad]
    ground : float
        Albedo of the ground, 0 to below 1.
    efficacy : float
        Luminous by radiant flux. [lm/W]

    """

    sun: float
    azimuth: float
    elevation: float
    sky: float
    ground: float
    efficacy: float

    def __post_init__(self) -> None:
        """Refuse impossible daylight."""
        require_lux('The illuminance by the sun', self.sun)
        require_lux('The illuminance by the sky', self.sky)
        require_efficacy(self.efficacy)
        require(
            math.isfinite(self.azimuth) and 0.0 < self.elevation <= math.pi / 2.0,
            f'The sun is {math.degrees(self.elevation):g} degrees above the horizon; its '
            'elevation must be above 0 and at most 90 degrees.',
        )
        require(
            0.0 <= self.ground < 1.0,
            f'The ground has an albedo of {self.ground}; the albedo must be at least 0 and '
            'below 1.',
        )

    @property
    def sun_direction(self) -> Vector:
        """Unit vector to the sun. [map]"""
        # Horizontal component of the unit vector
        level = math.cos(self.elevation)
        return (
            level * math.cos(self.azimuth),
            level * math.sin(self.azimuth),
            math.sin(self.elevation),
        )

    @property
    def ground_illuminance(self) -> float:
        """Illuminance of level ground. [lx]"""
        # Lambert's cosine law on level ground
        return self.sun * math.sin(self.elevation) + self.sky
