"""Stick deflections and buttons, independent of the device."""

from collections.abc import Collection, Sequence
from typing import NamedTuple, Protocol

from lta_config.settings import setting, Settings


class Sticks(NamedTuple):
    """Deflections and buttons at an instant."""

    # Ahead, to the left, up: from -1 to 1, exactly 0 at rest
    forward: float = 0.0
    turn: float = 0.0
    climb: float = 0.0
    # Whether to take control, hand it back, or stop the motors
    take: bool = False
    give_back: bool = False
    stop: bool = False

    @property
    def is_deflected(self) -> bool:
        """Whether any stick is deflected."""
        return any((self.forward, self.turn, self.climb))


class StickDevice(Protocol):
    """A device with sticks."""

    def read_sticks(self, now: float) -> Sticks | None:
        """Return the sticks at a monotonic time [s]; None if the device has failed."""

    def close(self) -> None:
        """Close the device."""


class GamepadLayout(Settings):
    """Axis and button numbers of a gamepad; the defaults fit an Xbox gamepad under Linux."""

    forward: int = setting(
        4, 'Number of the axis for forward flight (right stick up).', low=0, high=63, fixed=True
    )
    turn: int = setting(
        0, 'Number of the axis for turning left (left stick left).', low=0, high=63, fixed=True
    )
    climb: int = setting(
        1, 'Number of the axis for climbing (left stick up).', low=0, high=63, fixed=True
    )
    take: int = setting(
        0, 'Number of the button that takes control (A).', low=0, high=63, fixed=True
    )
    give_back: int = setting(
        1, 'Number of the button that hands control back (B).', low=0, high=63, fixed=True
    )
    stop: int = setting(
        2,
        'Number of the emergency-stop button, which locks the motors (X).',
        low=0,
        high=63,
        fixed=True,
    )
    rest: float = setting(
        0.1,
        'Dead zone: a smaller stick deflection, from 0 to 1, counts as zero.',
        low=0.0,
        high=0.9,
        fixed=True,
    )


def to_sticks(
    layout: GamepadLayout,
    axes: Sequence[float],
    buttons: Sequence[int],
    tapped: Collection[int] = (),
) -> Sticks | None:
    """
    Return the sticks of a gamepad.

    Parameters
    ----------
    axes : sequence of float
        From -1 to 1; left and up are positive, as in sensor_msgs/Joy.
    buttons : sequence of int
        1 if pressed.
    tapped : collection of int
        Buttons pressed since the last reading, which may be released again.

    Returns
    -------
    Sticks or None
        None if it has fewer axes or buttons than the layout names.

    """
    axis_indices = (layout.forward, layout.turn, layout.climb)
    pressed = (layout.take, layout.give_back, layout.stop)
    if max(axis_indices) >= len(axes) or max(pressed) >= len(buttons):
        return None
    forward, turn, climb = (apply_dead_zone(axes[axis], layout.rest) for axis in axis_indices)
    # `tapped` has buttons that were pressed and released since the last read
    take, give_back, stop = (buttons[button] == 1 or button in tapped for button in pressed)
    return Sticks(forward, turn, climb, take, give_back, stop)


def apply_dead_zone(raw: float, rest: float) -> float:
    """Remove the dead zone of a stick and rescale its deflection to -1 to 1."""
    size = (min(abs(raw), 1.0) - rest) / (1.0 - rest)
    if not size > 0.0:  # true for NaN too
        return 0.0
    # Zero at the edge of the dead zone, so that the command does not jump
    return size if raw > 0.0 else -size
