"""Joy messages as a device, and the estimate as a person at the helm needs it."""

from typing import Final, final

from lta_bridge.teleop.helm import Felt
from lta_bridge.teleop.sticks import Layout, of_gamepad, Sticks
from lta_control.messages import to_measured
from nav_msgs.msg import Odometry
from sensor_msgs.msg import Joy

SILENT: Final = 0.5  # s; joy_node repeats itself 20 times a second


@final
class JoyDevice:
    """The newest Joy message, for as long as they come."""

    def __init__(self, layout: Layout) -> None:
        self._layout = layout
        self._newest: Joy | None = None
        self._heard = 0.0

    def heard(self, message: Joy, now: float) -> None:
        """Take a message at a time. [s]"""
        self._newest, self._heard = message, now

    def sticks(self, now: float) -> Sticks | None:
        """Return what it says; None where nothing has come for `SILENT`."""
        if self._newest is None or now - self._heard > SILENT:
            return None
        return of_gamepad(self._layout, self._newest.axes, self._newest.buttons)

    def close(self) -> None:
        """Do nothing: the subscription is the node's."""


def to_felt(odom: Odometry) -> Felt | None:
    """Return heading and altitude; None while the estimator still learns."""
    measured = to_measured(odom)
    return None if measured is None else Felt(measured.heading, measured.altitude)
