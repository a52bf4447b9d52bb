# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Convert a flight in one process to the messages of the graph."""

from collections.abc import Callable, Mapping
from typing import Any

from lta_bag.metadata import build_offered_qos
from lta_bag.schemas import encode_message
from lta_bag.writer import BagWriter
from lta_bridge.description.messages import iterate_descriptions
from lta_bridge.log_time_assigner import LogTimeAssigner
from lta_config.topics import robot_topic, TopicTable
from lta_control.messages import from_duties, from_setpoint
from lta_control.motion import Setpoint
from lta_control.odometry.messages import from_airspeed, from_estimate
from lta_energy.messages import from_charge, from_energy_balance, from_reserve
from lta_energy.monitoring.meters import PowerSystem
from lta_energy.monitoring.report import report_energy
from lta_flight.closed_loop import ClosedLoop, EnergyObservation, LightObservation
from lta_graph.quality import select_quality
from lta_graph.ros.stamps import to_stamp
from lta_graph.ros.transforms import from_odometry, from_start
from lta_msgs.msg import LightBlock
from lta_sim.messages import iterate_motion, iterate_rest
from lta_vlc.diodes import build_diode_array
from lta_vlc.messages import from_bearing, from_lamp, from_peaks
from std_msgs.msg import Float64

Write = Callable[[str, Any], None]


class LoopRecorder:
    """
    Write the steps of a loop as messages, with the log times of their publications.

    Topics that are not repeatable depend on the wall clock and are left out.

    `writer`: writes the bag. `loop`: the flight. `robot`: namespace.
    """

    def __init__(self, writer: BagWriter, loop: ClosedLoop, table: TopicTable, robot: str) -> None:
        self._writer = writer
        self._loop = loop
        self._table = table
        # Assigns log times in the order in which the graph would publish
        self._books = LogTimeAssigner(table, lockstep=True)
        self._names = {}
        self._rotors = loop.world.vehicle.rotor_names
        self._axes = build_diode_array(loop.world.vehicle.file.sensors.diodes).axes
        self._aboard = PowerSystem.from_entry(loop.world.vehicle.file.energy)
        for name, topic in table.topics.items():
            # The same topics as the graph's recorder, so that the bags are equal
            if topic.recorded and topic.repeatable:
                depth, reliability, durability = select_quality(topic, lockstep=True)
                offered = build_offered_qos(reliability, durability, depth)
                self._names[name] = robot_topic(robot, name)
                writer.add_topic(self._names[name], topic.type, [offered])
        # As the drone knows itself: a bag must not disclose what a challenge hides
        for name, message in iterate_descriptions(loop.nominal_vehicle, loop.world.scenario):
            self._write_message(name, message)
        self._write_message('/tf_static', from_start(loop.world.start_pose))

    def record_step(self) -> None:
        """Write the messages of the newest step; call it before the simulation advances."""
        loop, readings = self._loop, self._loop.readings
        stamp, estimate = to_stamp(readings.stamp_ns), loop.estimate
        for name, message in iterate_motion(loop.world, readings):
            self._write_message(name, message)
        rest = dict(iterate_rest(loop.world, readings))
        self._write_message('airspeed', from_airspeed(stamp, estimate, loop.ground))
        odom = from_estimate(stamp, estimate, loop.ground)
        self._write_message('odom', odom)
        self._write_message('/tf', from_odometry(odom))
        self._write_message('motors', from_duties(stamp, self._rotors, loop.duties))
        if 'ground_truth/odom' in rest:
            self._write_message('ground_truth/odom', rest['ground_truth/odom'])
        block = rest.get('photodiodes')
        if block is not None and loop.light is not None and loop.next_setpoint is not None:
            self._write_light(block, loop.light, loop.next_setpoint)
        if 'battery' in rest and loop.energy is not None:
            self._write_energy(rest, loop.energy)

    def _write_message(self, name: str, message: Any) -> None:
        if name in self._names:
            data = encode_message(message, self._table[name].type)
            self._writer.write(self._names[name], data, self._books.assign_log_time(name, data))

    def _write_light(self, block: LightBlock, light: LightObservation, setpoint: Setpoint) -> None:
        """Write a light block and the outputs of demodulator and navigator."""
        # All answers to a block carry its stamp
        header, stamp = block.header, block.header.stamp
        self._write_message('photodiodes', block)
        self._write_message('light/bearing', from_bearing(header, light.bearing))
        self._write_message('light/peaks', from_peaks(header, light.hearing.peaks, self._axes))
        self._write_message('light/estimate', from_lamp(header, light.lamp))
        pose, velocity = from_setpoint(stamp, setpoint)
        self._write_message('setpoint/pose', pose)
        self._write_message('setpoint/velocity', velocity)
        self._write_message('light/beacon', Float64(data=self._loop.beacon))

    def _write_energy(self, rest: Mapping[str, Any], energy: EnergyObservation) -> None:
        """Write the readings of the meters and the output of the energy monitor."""
        loop, measured = self._loop, rest['battery']
        for name in ('wind', 'illuminance', 'panel', 'battery'):
            self._write_message(name, rest[name])
        reading, estimate = energy.reading, energy.estimate
        # The monitor uses the message, whose fields have 32 bits
        measured.voltage, measured.current = reading.voltage, reading.current
        self._write_message('energy/battery', from_charge(self._aboard.cell, estimate, measured))
        settings = loop.policy.energy
        report = report_energy(settings, self._aboard.cell, estimate)
        status = from_energy_balance(settings, self._aboard, report, reading, measured)
        self._write_message('energy/status', status)
        self._write_message('energy/reserve', from_reserve(estimate))
