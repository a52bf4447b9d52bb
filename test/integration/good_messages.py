# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""One good message of every topic, of a drone that hovers before a lamp."""

from typing import Any

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from lta_control.estimator import MotionEstimate
from lta_control.messages import from_duties, from_setpoint
from lta_control.motion import Setpoint
from lta_control.odometry.ground_state import GroundSettings, start_ground_motion
from lta_control.odometry.messages import from_airspeed, from_estimate
from lta_graph.ros import vehicle_messages as messages
from lta_graph.ros.message_validation import find_message_type
from lta_graph.ros.stamps import to_stamp
from lta_model.sensors.imu import error_bounds, ImuSettings
from lta_vlc.demodulation import Peaks
from lta_vlc.lamp import LampEstimate
from lta_vlc.messages import from_bearing, from_lamp, from_peaks
import numpy as np
from rosgraph_msgs.msg import Clock
from std_msgs.msg import Bool, Float64, Header

from .peer import TABLE

ROTORS = ['up_left', 'up_right', 'forward_left', 'forward_right']
DIODES = 8
AXES = [(np.cos(a), np.sin(a), 0.0) for a in 2.0 * np.pi * np.arange(DIODES) / DIODES]
BEACON = 150.0  # Hz
BLOCK = np.full((TABLE.light.samples, DIODES), 200, np.uint16)
PEAKS = Peaks(*(np.full(DIODES, x) for x in (100.0, 20.0, BEACON, 5.0)))
LAMP = LampEstimate(3.0, 0.5, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0, 1.0)
NOISE = error_bounds(ImuSettings()).noise
HOVER = MotionEstimate(ready=True)
STANDING = start_ground_motion(GroundSettings())
AHEAD = Setpoint(1.0, 0.0, 0.2)


def health(task: str, **values: object) -> DiagnosticArray:
    """Return what a node says of one task."""
    pairs = [KeyValue(key=key, value=str(value)) for key, value in values.items()]
    status = DiagnosticStatus(name=task, message='well', hardware_id='lta1', values=pairs)
    return DiagnosticArray(status=[status])


def good(name: str, stamp_ns: int) -> Any:
    """Return a message of a topic, stamped [ns]."""
    stamp = to_stamp(stamp_ns)
    header = Header(stamp=stamp, frame_id=TABLE[name].frame)
    made = {
        'imu': lambda: messages.build_imu_message(stamp, (0.0, 0.0, 9.81), (0.0, 0.0, 0.0), NOISE),
        'range': lambda: messages.build_range_message(stamp, 1.0, (0.04, 4.0), 27.0),
        'pressure': lambda: messages.build_pressure_message(stamp, 101325.0, 1.0),
        'photodiodes': lambda: messages.build_light_block_message(stamp, BLOCK),
        'illuminance': lambda: messages.build_illuminance_message(stamp, 300.0),
        'battery': lambda: messages.build_battery_state(stamp, 3.9, -0.3, 'battery'),
        'panel': lambda: messages.build_battery_state(stamp, 2.0, 0.01, 'panel'),
        'odom': lambda: odom(stamp),
        'airspeed': lambda: from_airspeed(stamp, HOVER, STANDING),
        'ground_truth/odom': lambda: odom(stamp),
        'tracker/odom': lambda: odom(stamp),
        'motors': lambda: from_duties(stamp, ROTORS, (0.1, 0.1, 0.1, 0.1)),
        'light/peaks': lambda: from_peaks(header, (PEAKS,), AXES),
        'light/bearing': lambda: from_bearing(header, None),
        'light/estimate': lambda: from_lamp(header, LAMP),
        'setpoint/pose': lambda: from_setpoint(stamp, AHEAD)[0],
        'teleop/pose': lambda: from_setpoint(stamp, AHEAD)[0],
        'setpoint/velocity': lambda: from_setpoint(stamp, AHEAD)[1],
        'teleop/velocity': lambda: from_setpoint(stamp, AHEAD)[1],
        'light/beacon': lambda: Float64(data=BEACON),
        'teleop/held': lambda: Bool(data=False),
        'energy/reserve': lambda: Bool(data=False),
        'energy/battery': lambda: messages.build_battery_state(stamp, 3.9, -0.3, 'battery'),
        'wind': lambda: messages.build_wind_message(stamp, (0.1, 0.0, 0.0)),
        '/clock': lambda: Clock(clock=stamp),
        '/diagnostics': lambda: health('controller: links', motors=2, held=False),
    }
    message = made[name]() if name in made else find_message_type(TABLE[name])()
    if hasattr(message, 'header'):
        message.header.stamp = stamp
    return message


def odom(stamp: Any) -> Any:
    """Return an estimate of a hover at a metre."""
    message = from_estimate(stamp, HOVER, STANDING)
    message.pose.pose.position.z = 1.0
    return message
