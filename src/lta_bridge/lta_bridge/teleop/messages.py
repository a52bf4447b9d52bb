# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Use Joy and Twist messages as stick devices, and get heading and altitude from odometry."""

from collections.abc import Callable, Collection
from typing import Final, final

from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import TwistStamped
from lta_bridge.teleop.steering import HeadingAltitude, TeleopRates
from lta_bridge.teleop.sticks import GamepadLayout, Sticks, to_sticks
from lta_control.messages import to_cascade_measurement
from lta_graph.health import RejectionCount, stamp_age
from lta_graph.ros.command_mux import COMMAND_SOURCE_TASK, HELD_VALUE
from lta_graph.ros.message_validation import find_fault
from lta_graph.ros.stamps import from_stamp
from nav_msgs.msg import Odometry
from sensor_msgs.msg import Joy

# s; joy_node repeats its message at 20 Hz, and so does who sends cmd_vel
SILENT_SENDER: Final = 0.5


@final
class JoyDevice:
    """
    Keep the newest Joy message and the buttons pressed since the last reading.

    Attribute `unsound`: messages that do not fit the layout, or whose axes are not finite.
    """

    def __init__(self, layout: GamepadLayout) -> None:
        self._layout = layout
        self.unsound = RejectionCount()
        self._newest: Joy | None = None
        self._received_at = 0.0
        self._tapped: set[int] = set()

    def receive(self, message: Joy, now: float) -> None:
        """Store a message that arrives at a time [s]."""
        self._newest, self._received_at = message, now
        if to_sticks(self._layout, message.axes, message.buttons) is None:
            have = f'{len(message.axes)} axes and {len(message.buttons)} buttons'
            self.unsound.add(f'joy: {have}, fewer than the parameter layout uses')
            return
        self._tapped |= {number for number, level in enumerate(message.buttons) if level == 1}
        if why := find_fault(
            message
        ):  # an invalid axis counts as at rest; the buttons still count
            self.unsound.add(f'joy: {why}')

    def read_sticks(self, now: float) -> Sticks | None:
        """Return the sticks at a time [s]; None after `SILENT` without a message."""
        tapped, self._tapped = self._tapped, set()
        # A pressed button counts even if the device is lost right after it
        silent = now - self._received_at > SILENT_SENDER and not tapped
        if self._newest is None or silent:
            return None
        return to_sticks(self._layout, self._newest.axes, self._newest.buttons, tapped)

    def close(self) -> None:
        """Do nothing: the subscription belongs to the node."""


@final
class TwistDevice:
    """
    Follow velocities in the body frame, in place of a person; `rates` returns the largest ones.

    Forward velocity (through the air), climb and turn rate count; what goes sideways does not, as
    these vehicles steer by their heading. Who sends them has control while messages come. Then the
    drone holds and lands, as without a gamepad. `frames`: names of the body frame. Attribute
    `unsound`: messages in another frame, late or not finite, which count as none.
    """

    def __init__(self, rates: Callable[[], TeleopRates], frames: Collection[str]) -> None:
        self._rates, self._frames = rates, frames
        self.unsound = RejectionCount()
        self._newest = Sticks()
        self._received_at = -SILENT_SENDER

    def receive(self, message: TwistStamped, now: float, graph_ns: int) -> None:
        """
        Take a message.

        `now`: time at which it came [s]. `graph_ns`: the graph's time then, with which its stamp
        is compared; a message without a stamp counts as new.
        """
        stamp_ns = from_stamp(message.header.stamp)
        v, w = message.twist.linear, message.twist.angular
        age = stamp_age(stamp_ns, graph_ns) if stamp_ns else 0.0
        if why := find_fault(message):
            self.unsound.add(f'cmd_vel: {why}')
        elif message.header.frame_id not in self._frames:
            self.unsound.add(f"cmd_vel: in the frame '{message.header.frame_id}', not base_link")
        elif age > SILENT_SENDER:
            self.unsound.add(f'cmd_vel: its stamp is {age:.1f} s old, or of another clock')
        else:
            rates = self._rates()
            full = (v.x, rates.speed), (w.z, rates.turn), (v.z, rates.climb)
            forward, turn, climb = (max(-1.0, min(1.0, value / most)) for value, most in full)
            self._newest, self._received_at = Sticks(forward, turn, climb, take=True), now

    def read_sticks(self, now: float) -> Sticks | None:
        """Return the sticks at a time [s]; None after `SILENT` without a message."""
        return self._newest if now - self._received_at < SILENT_SENDER else None

    def close(self) -> None:
        """Do nothing: the subscription belongs to the node."""


@final
class SetpointFollowers:
    """
    Track from diagnostics whose setpoints a drone's nodes follow.

    `robot` is the drone's namespace.
    """

    def __init__(self, robot: str) -> None:
        self._robot = robot.strip('/')
        self._held: dict[str, bool] = {}

    def add_diagnostics(self, array: DiagnosticArray) -> None:
        """Add a diagnostics message."""
        for status in array.status:
            if status.hardware_id == self._robot and status.name.endswith(
                f': {COMMAND_SOURCE_TASK}'
            ):
                values = {item.key: item.value for item in status.values}
                if HELD_VALUE in values:
                    # Diagnostics values are texts
                    self._held[status.name] = values[HELD_VALUE] == str(True)

    @property
    def is_operator_steering(self) -> bool | None:
        """Whether any node follows the operator's setpoints; None if none has reported."""
        return any(self._held.values()) if self._held else None


def to_heading_altitude(odom: Odometry) -> HeadingAltitude | None:
    """Return heading and altitude; None while the estimate is not usable."""
    measured = None if find_fault(odom) else to_cascade_measurement(odom)
    return None if measured is None else HeadingAltitude(measured.heading, measured.altitude)
