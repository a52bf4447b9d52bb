"""What a navigation strategy is: from what the light says to where to go."""

from typing import NamedTuple, Protocol

from lta_config.settings import setting, Settings


class Sight(NamedTuple):
    """
    What the light of one block says, at the middle of the block.

    Attributes
    ----------
    bearing : float or None
        Of the lamp in the body frame, counter-clockwise; None when no diode is trusted. [rad]
    heading : float
        Of the drone, in the odom frame, at the same instant. [rad]
    amplitudes : tuple of float
        Light at the beacon's frequency by diode. [ADC counts]
    interval : float
        Time since the last sight. [s]

    """

    bearing: float | None
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


class Strategy(Protocol):
    """
    A navigation strategy: pure, with its memory handed in and out.

    A new one is one file with one class and one line in the registry.
    """

    def start(self, heading: float) -> tuple[float, ...]:
        """Return the memory before the first sight."""
        ...

    def steer(
        self, settings: CruiseSettings, memory: tuple[float, ...], sight: Sight
    ) -> tuple[Course, tuple[float, ...]]:
        """Return where to go now, and the new memory."""
        ...
