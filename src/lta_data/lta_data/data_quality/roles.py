"""Classify channels: measurements, commands, or derived quantities."""

import re
from typing import Final

from lta_data.bag.channels import SignalChannel

# Commands: constant, held and limited values are normal.
COMMANDS: Final = re.compile(r'^(motors|wrench_command|setpoint/|cmd_|joy|/)')
# Commands to the rotors.
DRIVES: Final = re.compile(r'^(motors/effort|wrench_command/.*force)')
# Estimates of the vehicle's own programs.
DERIVED: Final = re.compile(r'^(odom$|light/|energy/|wind$)')
# External tracking; the vehicle's own odometry is dead reckoning and does not match.
TRACKED: Final = re.compile(r'^(ground_truth/|vicon|mocap|optitrack|qualisys|tracker|pose$)')

POSITION: Final = re.compile(r'(.*position|.*translation|point)\.([xyz])$')
QUATERNION: Final = re.compile(r'(.*orientation|.*rotation|quaternion)\.([xyzw])$')
ANGLE: Final = re.compile(r'(.*orientation|.*rotation|quaternion)\.(yaw|pitch|roll)$')
SPEED: Final = re.compile(r'(.*linear)\.([xyz])$')
TURNING: Final = re.compile(r'(.*angular)\.([xyz])$')
RATES: Final = re.compile(r'(angular_velocity)\.([xyz])$')
FORCE: Final = re.compile(r'(linear_acceleration)\.([xyz])$')
# The empty group stands for the missing axis, as all these patterns have two groups
PRESSURE: Final = re.compile(r'(fluid_pressure)()$')
SHINE: Final = re.compile(r'(mean|std)\[(\d+)\]$')

# Quantities whose measured values never repeat for long.
RESTLESS: Final = {
    'position': POSITION,
    'attitude': ANGLE,
    'velocity': SPEED,
    'turning': TURNING,
    'rates': RATES,
    'force': FORCE,
    'pressure': PRESSURE,
}


def is_instrument_topic(topic: str) -> bool:
    """Return whether a topic holds measurements."""
    return not COMMANDS.match(topic) and not DERIVED.match(topic)


def is_measured(channel: SignalChannel) -> bool:
    """Return whether a channel is a measurement."""
    return is_instrument_topic(channel.topic)


def match_noisy_quantity(channel: SignalChannel) -> str | None:
    """Return which of `RESTLESS` a measured channel is; None if none."""
    if not is_measured(channel):
        return None
    matches = (name for name, rule in RESTLESS.items() if rule.match(channel.field))
    return next(matches, None)


def vector_name(channel: str) -> str:
    """Return the vector of a channel: its name without the last part."""
    head, dot, tail = channel.rpartition('.')
    # A dot in the topic's name separates no component
    return head if dot and '/' not in tail else channel
