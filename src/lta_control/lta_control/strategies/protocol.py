"""What a navigation strategy is: from what the light says to where to go."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import final, NamedTuple

from lta_config.settings import setting, Settings

Memory = tuple[float, ...]


class Sight(NamedTuple):
    """
    What the light of one block says, at the middle of the block.

    Attributes
    ----------
    seen : bool
        Whether any diode is trusted.
    bearing : float
        Of the lamp in the body frame, counter-clockwise; 0 where it is not seen. [rad]
    heading : float
        Of the drone, in the odom frame, at the same instant. [rad]
    amplitudes : tuple of float
        Light at the beacon's frequency by diode. [ADC counts]
    interval : float
        Time since the last sight. [s]

    """

    seen: bool
    bearing: float
    heading: float
    amplitudes: tuple[float, ...]
    interval: float


class Course(NamedTuple):
    """Where to go: a heading in the odom frame [rad] and a forward airspeed [m/s]."""

    heading: float
    speed: float


class CruiseSettings(Settings):
    """What every strategy needs to know."""

    speed: float = setting(0.5, 'Forward airspeed.', unit='m/s', low=0.0, high=3.0)
    search_rate: float = setting(
        0.3, 'Turn rate of the search when no lamp is seen.', unit='rad/s', low=0.0, high=2.0
    )


@final
@dataclass(frozen=True, slots=True)
class Strategy:
    """
    A navigation strategy: two plain functions of scalars and tuples, memory handed in and out.

    A new one is one file with its functions and a `STRATEGY`, and one line in the registry.

    Parameters
    ----------
    name : str
        Name in launch files.
    start : callable
        `start(heading) -> memory` before the first sight.
    steer : callable
        `steer(settings, memory, sight) -> (course, memory)`.

    """

    name: str
    start: Callable[[float], Memory]
    steer: Callable[[CruiseSettings, Memory, Sight], tuple[Course, Memory]]
