# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
The light board bridge: it publishes the readings of real photodiodes.

It is a lifecycle node: `configure` opens the link and synchronizes with the board's clock,
`activate` starts and `deactivate` stops publishing, `cleanup` closes the link.
"""

import time
from typing import Unpack

from builtin_interfaces.msg import Time
from lta_bridge.parameters import TeensyBridgeSettings
from lta_bridge.teensy.light_board import LightBlock, LightBoard, LightPeaks
from lta_bridge.teensy.reader import BoardReader, describe_health, LIGHT_BOARD_TASK
from lta_config.errors import BadInput
from lta_config.schema.crazyflie_file import hash_diodes
from lta_config.schema.vehicle_file import load_vehicle_file
from lta_graph.health import HealthLevel
from lta_graph.ros.contained_node import NodeOptions
from lta_graph.ros.device import DeviceNode
from lta_graph.ros.parameters import NodeParameters
from lta_graph.ros.process import run_node
from lta_graph.ros.stamps import to_stamp
from lta_graph.ros.vehicle_messages import build_light_block_message
from lta_vlc.demodulation import Peaks
from lta_vlc.diodes import build_diode_array
from lta_vlc.lamp import LampFinder
from lta_vlc.messages import from_bearing, from_lamp, from_peaks
from rclpy.lifecycle import LifecycleState, TransitionCallbackReturn
from std_msgs.msg import Header

PORT_RETRY_PERIOD = 0.2  # s between two attempts to open a missing port


class TeensyBridge(DeviceNode):
    """Publish the light board's blocks, or the results of its own peak detection."""

    def __init__(self, **options: Unpack[NodeOptions]) -> None:
        super().__init__('teensy_bridge', 'light board', **options)
        self._settings = NodeParameters(self, TeensyBridgeSettings).value
        if self._settings.peaks:  # as a demodulator
            answers = self.table.published_by('demodulator')
            self._outputs = {name: self.create_output(name) for name in answers}
        else:
            self._outputs = {'photodiodes': self.create_output('photodiodes')}
        file = load_vehicle_file(self._settings.vehicle)
        self._entry, self._hash = file.sensors.diodes, hash_diodes(file)
        self._finder = LampFinder(build_diode_array(self._entry))
        if self._settings.peaks:
            # Compile now, or the first block would wait for it
            self._finder.prepare()
        self._reader: BoardReader | None = None
        self.autostart = self._settings.autostart

    def on_configure(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Open the link."""
        try:
            self._reader = self._open_reader()
        except BadInput as error:
            self.refusal = str(error)
            self.health.report(LIGHT_BOARD_TASK, HealthLevel.ERROR, self.refusal)
            return TransitionCallbackReturn.FAILURE
        return super().on_configure(state)

    def _open_reader(self) -> BoardReader:
        """Open the link, retrying for some time; raise `BadInput` if it stays missing."""
        port, until = self._settings.port, time.monotonic() + self._settings.patience
        entry, peaks = self._entry, self._settings.peaks
        board = LightBoard(self.table.light, entry.count, peaks, entry.bits, self._hash)
        while True:
            try:
                return BoardReader(port, board, self._publish_light, self.graph_time_ns)
            except BadInput:
                if time.monotonic() >= until or not self.running:
                    raise
                time.sleep(PORT_RETRY_PERIOD)

    def update_health(self) -> None:
        """Report the health of the board and its link."""
        # A refusal was reported in on_configure; do not replace it
        if self._reader is not None or not self.refusal:
            fact = describe_health(self._reader, self.graph_time_ns(), self.active)
            self.health.report(fact.task, fact.level, fact.message, **fact.values)

    def _publish_light(self, came: LightBlock | LightPeaks) -> None:
        """Publish a block or peaks; called in the reader's thread."""
        if not self.active:
            return
        stamp = to_stamp(came.stamp_ns)
        if isinstance(came, LightPeaks):
            if self._settings.peaks:
                self._publish_peaks(stamp, came.peaks)
        elif not self._settings.peaks:
            self._outputs['photodiodes'].publish(build_light_block_message(stamp, came.samples))

    def _publish_peaks(self, stamp: Time, peaks: Peaks) -> None:
        """Publish the same messages as a demodulator."""
        header = Header(stamp=stamp, frame_id=self.table['light/peaks'].frame)
        lamp = self._finder.find_lamp(peaks, self._settings.threshold, self._settings.prior)
        out = self._outputs
        out['light/bearing'].publish(from_bearing(header, lamp.towards))
        out['light/peaks'].publish(from_peaks(header, (peaks,), self._finder.diodes.axes))
        out['light/estimate'].publish(from_lamp(header, lamp.lamp))

    def release_device(self) -> None:
        """Close the link."""
        self.active = False
        if self._reader is not None:
            self._reader.close()
            self._reader = None


def main(args: list[str] | None = None) -> None:
    """Run the node until it is stopped."""
    run_node(TeensyBridge, args)
