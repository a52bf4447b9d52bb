"""What a person's hands say, whatever they hold."""

from collections.abc import Collection, Sequence
from typing import NamedTuple, Protocol

from lta_config.settings import setting, Settings


class Sticks(NamedTuple):
    """
    Deflections and buttons at one time.

    Attributes
    ----------
    forward, turn, climb : float
        Ahead, to the left, up: from -1 to 1, exactly 0 at rest.
    take, give_back, stop : bool
        Whether the helm is taken, handed back, or everything stopped.

    """

    forward: float = 0.0
    turn: float = 0.0
    climb: float = 0.0
    take: bool = False
    give_back: bool = False
    stop: bool = False

    @property
    def is_deflected(self) -> bool:
        """Whether any stick is out of its rest."""
        return any((self.forward, self.turn, self.climb))


class StickDevice(Protocol):
    """What a person holds."""

    def read_sticks(self, now: float) -> Sticks | None:
        """Return what it says at a time [s], on a clock that only goes on; None: it is dead."""

    def close(self) -> None:
        """Give it back as it was."""


class GamepadLayout(Settings):
    """Which axis and button of a gamepad is which; these are an Xbox pad's under Linux."""

    forward: int = setting(4, 'Axis: right stick, up is ahead.', low=0, high=63, fixed=True)
    turn: int = setting(0, 'Axis: left stick, left is left.', low=0, high=63, fixed=True)
    climb: int = setting(1, 'Axis: left stick, up is up.', low=0, high=63, fixed=True)
    take: int = setting(0, 'Button that takes the helm (A).', low=0, high=63, fixed=True)
    give_back: int = setting(1, 'Button that hands it back (B).', low=0, high=63, fixed=True)
    stop: int = setting(
        2, 'Button that stops the motors for good (X).', low=0, high=63, fixed=True
    )
    rest: float = setting(0.1, 'Deflection that counts as none.', low=0.0, high=0.9, fixed=True)


def to_sticks(
    layout: GamepadLayout,
    axes: Sequence[float],
    buttons: Sequence[int],
    tapped: Collection[int] = (),
) -> Sticks | None:
    """
    Return what a gamepad says.

    Parameters
    ----------
    layout : Layout
        Which is which.
    axes : sequence of float
        From -1 to 1; left and up are positive, as in sensor_msgs/Joy.
    buttons : sequence of int
        1 where pressed.
    tapped : collection of int
        Buttons that have been pressed since the last look, though they may be up again.

    Returns
    -------
    Sticks or None
        None where it has fewer axes or buttons than the layout names: it is another gamepad.

    """
    wanted = (layout.forward, layout.turn, layout.climb)
    pressed = (layout.take, layout.give_back, layout.stop)
    if max(wanted) >= len(axes) or max(pressed) >= len(buttons):
        return None
    forward, turn, climb = (apply_dead_zone(axes[axis], layout.rest) for axis in wanted)
    take, give_back, stop = (buttons[button] == 1 or button in tapped for button in pressed)
    return Sticks(forward, turn, climb, take, give_back, stop)


def apply_dead_zone(raw: float, rest: float) -> float:
    """Return a stick's deflection without the play about its rest, again from -1 to 1."""
    size = (min(abs(raw), 1.0) - rest) / (1.0 - rest)
    if not size > 0.0:  # what is no number is none either
        return 0.0
    return size if raw > 0.0 else -size
