"""What a channel is: an instrument's reading, a command, or what was made of readings."""

import re
from typing import Final

from lta_data.bag.channels import SignalChannel

# Of no instrument: constant, held and limited as they should be.
COMMANDS: Final = re.compile(r'^(motors|wrench_command|setpoint/|cmd_|joy|/)')
# What drives the rotors.
DRIVES: Final = re.compile(r'^(motors/effort|wrench_command/.*force)')
# Made of readings by the vehicle's own programs.
DERIVED: Final = re.compile(r'^(odom$|light/|energy/|wind$)')
# Poses of the vehicle: a tracker's, then its own belief, whose place is dead reckoning.
TRACKED: Final = re.compile(r'^(ground_truth/|vicon|mocap|optitrack|qualisys|tracker|pose$)')

POSITION: Final = re.compile(r'(.*position|.*translation|point)\.([xyz])$')
QUATERNION: Final = re.compile(r'(.*orientation|.*rotation|quaternion)\.([xyzw])$')
ANGLE: Final = re.compile(r'(.*orientation|.*rotation|quaternion)\.(yaw|pitch|roll)$')
SPEED: Final = re.compile(r'(.*linear)\.([xyz])$')
TURNING: Final = re.compile(r'(.*angular)\.([xyz])$')
RATES: Final = re.compile(r'(angular_velocity)\.([xyz])$')
FORCE: Final = re.compile(r'(linear_acceleration)\.([xyz])$')
PRESSURE: Final = re.compile(r'(fluid_pressure)()$')
SHINE: Final = re.compile(r'(mean|std)\[(\d+)\]$')

# Quantities in which an instrument never says the same for long.
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
    """Whether a topic is an instrument's."""
    return not COMMANDS.match(topic) and not DERIVED.match(topic)


def is_measured(channel: SignalChannel) -> bool:
    """Whether an instrument says it."""
    return is_instrument_topic(channel.topic)


def find_restless_kind(channel: SignalChannel) -> str | None:
    """Return which of `RESTLESS` a measured channel is; None if none."""
    if not is_measured(channel):
        return None
    found = (name for name, rule in RESTLESS.items() if rule.match(channel.field))
    return next(found, None)


def vector_name(channel: str) -> str:
    """Return the vector that a channel is part of: its name without the last part."""
    head, dot, tail = channel.rpartition('.')
    return head if dot and '/' not in tail else channel
