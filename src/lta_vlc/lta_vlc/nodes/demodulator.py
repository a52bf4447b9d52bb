# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Demodulate ADC blocks to peaks, bearing and lamp position in a ROS node."""

from typing import Unpack

from lta_config.schema.vehicle_file import load_vehicle_file
from lta_config.settings import setting
from lta_graph.health import HealthLevel
from lta_graph.lockstep import InboxStep
from lta_graph.ros.contained_node import NodeOptions
from lta_graph.ros.node import GraphNode
from lta_graph.ros.parameters import NodeParameters
from lta_graph.ros.process import run_node
from lta_vlc.demodulation import DemodulatedBlock, Peaks
from lta_vlc.diodes import build_diode_array
from lta_vlc.lamp import LampDetection, LampFinder, LampPrior
from lta_vlc.messages import (
    describe_beacons,
    from_bearing,
    from_lamp,
    from_peaks,
    to_block,
    WANTED_TASK,
)
from lta_vlc.receiver import BeaconReceiver, BlockSequence
from lta_vlc.settings import DemodulationSettings
from std_msgs.msg import Header


class DemodulatorParameters(DemodulationSettings):
    """The beacon to detect, and the prior on its lamp."""

    vehicle: str = setting('gtmab', fixed=True)
    """Vehicle name or file."""
    prior: LampPrior = setting(LampPrior())
    """Assumed distance, height and brightness of the lamp before it is detected."""


class Demodulator(GraphNode):
    """Answer each ADC block with peaks, the paper's bearing vector and the lamp position."""

    def __init__(self, **options: Unpack[NodeOptions]) -> None:
        super().__init__('demodulator', **options)
        self._peaks = self.create_output('light/peaks')
        self._bearing = self.create_output('light/bearing')
        self._estimate = self.create_output('light/estimate')
        self._settings = NodeParameters(
            self, DemodulatorParameters, changed=self._apply_settings, check=self._build_receiver
        )
        self._apply_settings(self._settings.value)
        self._sequence = BlockSequence(self.table['photodiodes'].period_ns)
        self._refused = 0
        # After the outputs: messages published before a subscriber is there are lost in real time.
        settings = self._settings.value
        entry = load_vehicle_file(settings.vehicle).sensors.diodes
        self._finder = LampFinder(build_diode_array(entry))
        self._listener.prepare()  # the first block must be answered at once
        self._finder.prepare()
        self.subscribe_inputs(
            ['photodiodes', 'light/beacon'], trigger='photodiodes', on_step=self._on_step
        )

    def _build_receiver(self, settings: DemodulatorParameters) -> BeaconReceiver:
        light, entry = self.table.light, load_vehicle_file(settings.vehicle).sensors.diodes
        return BeaconReceiver(settings, light.sample_rate.si, light.samples, entry.largest_reading)

    def _apply_settings(self, settings: DemodulatorParameters) -> None:
        self._listener = self._build_receiver(settings)

    def _on_step(self, step: InboxStep) -> None:
        message = step.last_message('photodiodes')
        try:
            # Before demodulating: trackers must know of the gap
            self._listener.skip_blocks(self._sequence.count_missing_blocks(step.stamp_ns))
            # The last request wins
            for wish in step.messages['light/beacon']:
                self._listener.prioritize_beacon(wish.data)
            block = to_block(message)
            # A block of another vehicle would be fitted with wrong axes
            self._finder.diodes.check_diode_count(block.shape[1])
            hearing = self._listener.demodulate_next_block(block)
        except ValueError as error:
            self._refused += 1
            self.health.report(
                WANTED_TASK, HealthLevel.ERROR, str(error), blocks_refused=self._refused
            )
            if self.lockstep:  # otherwise the lockstep would wait forever
                self._publish_results(message.header, (), LampDetection())
            return
        settings = self._settings.value
        lamp = self._finder.find_lamp(hearing.peaks[0], settings.threshold, settings.prior)
        self._publish_results(message.header, hearing.peaks, lamp)
        self._report_health(hearing)

    def _report_health(self, hearing: DemodulatedBlock) -> None:
        """Report the state of the light reception."""
        for fact in describe_beacons(
            hearing,
            self._listener.beacons,
            tuple(self._listener.presences[one] for one in self._listener.beacons),
            self._sequence.missing,
            self._refused,
        ):
            self.health.report(fact.task, fact.level, fact.message, **fact.values)

    def _publish_results(
        self, header: Header, peaks: tuple[Peaks, ...], detection: LampDetection
    ) -> None:
        self._bearing.publish(from_bearing(header, detection.towards))
        self._peaks.publish(from_peaks(header, peaks, self._finder.diodes.axes))
        self._estimate.publish(from_lamp(header, detection.lamp))


def main(args: list[str] | None = None) -> None:
    """Run the node until it is stopped."""
    run_node(Demodulator, args)
