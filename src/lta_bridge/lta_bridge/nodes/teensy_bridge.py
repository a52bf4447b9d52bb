"""
The bridge to the light board: plays the vehicle's photodiodes with real ones.

A lifecycle node: configure opens the link and learns the board's clock, activate publishes,
deactivate stops publishing, cleanup gives the link back. It commands nothing.
"""

import time

from lta_bridge.teensy.condition import condition, TASK
from lta_bridge.teensy.light_board import LightBlock, LightBoard
from lta_bridge.teensy.reader import Reader
from lta_config.errors import BadInput
from lta_config.settings import setting, Settings
from lta_config.vehicle_file import load_vehicle_file
from lta_graph.health import Level
from lta_graph.ros.device import DeviceNode
from lta_graph.ros.node import run, to_stamp
from lta_graph.ros.parameters import Parameters
from lta_sim.messages import light_block
from lta_vlc.diodes import diodes_of
from rclpy.lifecycle import LifecycleState, TransitionCallbackReturn

RIVALS = 'others'
AGAIN = 0.2  # s between two looks for a port that is not there yet


class TeensyBridgeSettings(Settings):
    """Where the board hangs, and on which vehicle."""

    vehicle: str = setting('gtmab', 'Vehicle name or file.', fixed=True)
    port: str = setting(
        '/dev/ttyACM0', 'Serial port of the board, or udp://HOST:PORT to listen on.', fixed=True
    )
    patience: float = setting(
        0.0,
        'How long to wait for a port that is not there yet.',
        unit='s',
        low=0.0,
        high=600.0,
        fixed=True,
    )
    autostart: bool = setting(True, 'Whether to configure and activate by itself.', fixed=True)


class TeensyBridge(DeviceNode):
    """Publish the light board's blocks as `photodiodes`."""

    def __init__(self) -> None:
        super().__init__('teensy_bridge', 'light board')
        self._photodiodes = self.output('photodiodes')
        self._settings = Parameters(self, TeensyBridgeSettings).value
        vehicle = load_vehicle_file(self._settings.vehicle)
        self._diodes = len(diodes_of(vehicle.sensors.diodes).axes)
        self._reader: Reader | None = None
        self._refusal = ''
        self._rivalled = False

    def on_configure(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Open the link."""
        try:
            self._reader = self._opened()
        except BadInput as error:
            self._refusal = str(error)
            self.health.report(TASK, Level.ERROR, self._refusal)
            self.get_logger().error(self._refusal)
            return TransitionCallbackReturn.FAILURE
        return super().on_configure(state)

    def _opened(self) -> Reader:
        """Return the open link, after some patience; `BadInput` where it stays away."""
        port, until = self._settings.port, time.monotonic() + self._settings.patience
        board = LightBoard(self.table.light, self._diodes)
        while True:
            try:
                return Reader(port, board, self._publish, self._now_ns)
            except BadInput:
                if time.monotonic() >= until or not self.running:
                    raise
                time.sleep(AGAIN)

    def work(self) -> None:
        """Start by itself where that is wanted, and work."""
        if self._settings.autostart:
            if self.trigger_configure() != TransitionCallbackReturn.SUCCESS:
                raise BadInput(self._refusal)
            self.trigger_activate()
        super().work()

    def publish_health(self) -> None:
        """Tell how the board and its link are."""
        if self._reader is not None or not self._refusal:
            fact = condition(self._reader, self._now_ns(), self.active)
            self.health.report(fact.task, fact.level, fact.message, **fact.values)
        if (others := self.count_publishers(self._photodiodes.topic_name) - 1) > 0:
            self.health.report(
                RIVALS, Level.ERROR, f'{others} more publish photodiodes; stop all but one'
            )
        elif self._rivalled:
            self.health.report(RIVALS, Level.OK, 'nobody else publishes photodiodes')
        self._rivalled |= others > 0
        super().publish_health()

    def _publish(self, block: LightBlock) -> None:
        """Publish a block; called in the reader's thread."""
        if self.active:
            self._photodiodes.publish(light_block(to_stamp(block.stamp_ns), block.samples))

    def _now_ns(self) -> int:
        return int(self.get_clock().now().nanoseconds)

    def let_go(self) -> None:
        """Give the link back."""
        self.active = False
        if self._reader is not None:
            self._reader.close()
            self._reader = None


def main(args: list[str] | None = None) -> None:
    """Run the node until it is told to stop."""
    run(TeensyBridge, args)
