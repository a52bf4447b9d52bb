"""A flight in one process as the messages that the graph's nodes would have sent."""

from collections.abc import Callable
from typing import Any

from lta_bridge.bag.qos import offered_qos
from lta_bridge.bag.writer import BagWriter
from lta_bridge.bookkeeping import Bookkeeping
from lta_bridge.cdr import serialise
from lta_config.topics import robot_topic, TopicTable
from lta_control.cascade import Setpoint
from lta_control.messages import from_duties, from_estimate, from_setpoint
from lta_energy.messages import from_books, from_charge, from_reserve
from lta_energy.monitoring.aboard import Aboard
from lta_flight.loop import Energy, Light, Loop
from lta_graph.ros.qos import profile
from lta_graph.ros.stamps import to_stamp
from lta_model import messages as sensed
from lta_sim.readings import Readings
from lta_vlc.diodes import diodes_of
from lta_vlc.messages import from_bearing, from_lamp, from_peaks
from sensor_msgs.msg import BatteryState
from std_msgs.msg import Float64, Header

Write = Callable[[str, Any], None]


class LoopRecorder:
    """
    Turn a loop's steps into messages and write them, each under its own publication's time.

    Topics that are not repeatable follow the wall clock of a graph and have no place here.

    Parameters
    ----------
    writer : BagWriter
        Where to.
    loop : Loop
        The flight.
    table : TopicTable
        The topics.
    robot : str
        Namespace.

    """

    def __init__(self, writer: BagWriter, loop: Loop, table: TopicTable, robot: str) -> None:
        self._writer = writer
        self._loop = loop
        self._table = table
        self._books = Bookkeeping(table, lockstep=True)
        self._names = {}
        self._rotors = loop.world.vehicle.rotor_names
        self._axes = diodes_of(loop.world.vehicle.file.sensors.diodes).axes
        self._aboard = Aboard.of(loop.world.vehicle.file.energy)
        for name, topic in table.topics.items():
            if topic.recorded and topic.repeatable:
                offered = profile(topic, lockstep=True)
                words = offered.reliability.name.lower(), offered.durability.name.lower()
                self._names[name] = robot_topic(robot, name)
                writer.add_topic(
                    self._names[name], topic.type, [offered_qos(*words, offered.depth)]
                )

    def take(self) -> None:
        """Write what the loop's newest step would have sent; call it before the world goes on."""
        loop, readings = self._loop, self._loop.readings
        stamp = to_stamp(readings.stamp_ns)
        self._write_motion(readings)
        self._write('odom', from_estimate(stamp, loop.estimate))
        self._write('motors', from_duties(stamp, self._rotors, loop.duties))
        if readings.truth is not None:
            self._write('ground_truth/odom', sensed.truth(stamp, readings.truth))
        if readings.block is not None and loop.light is not None and loop.asked is not None:
            self._write_light(readings.block, loop.light, loop.asked)
        if loop.energy is not None:
            self._write_energy(readings, loop.energy)

    def _write(self, name: str, message: Any) -> None:  # noqa: ANN401 - of any type
        if name in self._names:
            data = serialise(message)
            self._writer.write(self._names[name], data, self._books.log_time(name, data))

    def _write_motion(self, readings: Readings) -> None:
        """Write what the simulator sends for the estimator."""
        world, stamp = self._loop.world, to_stamp(readings.stamp_ns)
        for taken_ns, distance in readings.ranges:
            message = sensed.range_(to_stamp(taken_ns), distance, world.range_settings)
            self._write('range', message)
        if readings.pressure is not None:
            noise = world.pressure_settings.noise
            self._write('pressure', sensed.pressure(stamp, readings.pressure, noise))
        noises = world.imu_errors.noise
        self._write('imu', sensed.imu(stamp, readings.force, readings.rates, noises))

    def _write_light(self, block: tuple[int, Any], light: Light, asked: Setpoint) -> None:
        """Write a light block and what demodulator and navigator make of it."""
        stamp = to_stamp(block[0])
        self._write('photodiodes', sensed.light_block(stamp, block[1]))
        header = Header(stamp=stamp, frame_id=self._table['photodiodes'].frame)
        self._write('light/bearing', from_bearing(header, light.bearing))
        self._write('light/peaks', from_peaks(header, light.hearing.peaks, self._axes))
        self._write('light/estimate', from_lamp(header, light.lamp))
        pose, velocity = from_setpoint(stamp, asked)
        self._write('setpoint/pose', pose)
        self._write('setpoint/velocity', velocity)
        self._write('light/beacon', Float64(data=self._loop.beacon))

    def _write_energy(self, readings: Readings, energy: Energy) -> None:
        """Write what the meters say and what the energy monitor makes of it."""
        if readings.illuminance is None or readings.battery is None or readings.panel is None:
            return
        loop, stamp = self._loop, to_stamp(readings.stamp_ns)
        measured: BatteryState = sensed.branch(stamp, *readings.battery, 'battery')
        self._write('wind', sensed.wind(stamp, loop.world.wind))
        self._write('illuminance', sensed.illuminance(stamp, readings.illuminance))
        self._write('panel', sensed.branch(stamp, *readings.panel, 'panel'))
        self._write('battery', measured)
        reading, estimate = energy.reading, energy.estimate
        # The monitor answers the message, which carries 32 bits.
        measured.voltage, measured.current = reading.voltage, reading.current
        self._write('energy/battery', from_charge(self._aboard.cell, estimate, measured))
        status = from_books(loop.policy.energy, self._aboard, estimate, reading, measured)
        self._write('energy/status', status)
        self._write('energy/reserve', from_reserve(estimate))
