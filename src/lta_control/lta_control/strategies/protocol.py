"""What a navigation strategy is: from what the light says to where to go."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, final, NamedTuple, TYPE_CHECKING

from lta_config.settings import setting, Settings

if TYPE_CHECKING:
    from lta_control.strategies.settings import StrategySettings

Memory = tuple[Any, ...]  # numbers and tuples of such; the first is the heading asked for last


class LightSight(NamedTuple):
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
    deviation : float
        Standard deviation of the bearing. [rad]
    strength : float
        Light on a diode that faces the lamp, without the pedestal, whichever resistor is selected;
        0 where it is not seen. [ADC counts by the largest resistor]
    elevation : float
        Of the lamp over the horizon of the body; 0 where it is not known. [rad]
    position : tuple of float
        x and y by dead reckoning through the air: wind does not show in it. [m, odom]
    drift : tuple of float
        Estimated airspeed forward and to the left. [m/s, body]

    """

    seen: bool
    bearing: float
    heading: float
    amplitudes: tuple[float, ...]
    interval: float
    deviation: float = 0.0
    strength: float = 0.0
    elevation: float = 0.0
    position: tuple[float, float] = (0.0, 0.0)
    drift: tuple[float, float] = (0.0, 0.0)


class SteeringCommand(NamedTuple):
    """
    Where to go.

    Attributes
    ----------
    heading : float
        In the odom frame. [rad]
    speed : float
        Forward airspeed. [m/s]
    arrived : bool
        Whether the strategy takes itself to be at the lamp.

    """

    heading: float
    speed: float
    arrived: bool = False


class CruiseSettings(Settings):
    """What every strategy needs to know."""

    speed: float = setting(0.5, 'Forward airspeed.', unit='m/s', low=0.0, high=3.0)
    search_rate: float = setting(
        0.3, 'Turn rate of the search when no lamp is seen.', unit='rad/s', low=0.0, high=2.0
    )


@final
@dataclass(frozen=True, slots=True)
class NavigationStrategy:
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
    watch : callable, optional
        `watch(settings, memory, sight) -> memory` while the drone climbs: what it learns before it
        may steer. It keeps the heading.
    onward : callable, optional
        `onward(memory) -> memory` when the drone has arrived and is to go to another lamp; only
        who ever says that it has arrived has it, and can fly a route.
    ranges : bool
        Whether it looks at `LightSight.strength`, for which the selected resistor must be known.

    """

    name: str
    start: Callable[[float], Memory]
    steer: Callable[['StrategySettings', Any, LightSight], tuple[SteeringCommand, Memory]]
    watch: Callable[['StrategySettings', Any, LightSight], Memory] | None = None
    onward: Callable[[Any], Memory] | None = None
    ranges: bool = False

    @property
    def arrives(self) -> bool:
        """Whether it ever says that it has arrived."""
        return self.onward is not None
