# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Classify channels: measurements, commands or derived quantities, and their possible values."""

import re
from typing import Final, NamedTuple

from lta_data.flight import Channel
from lta_data.interpretation.commands import is_command_topic

# Commands to the rotors.
DRIVEN: Final = re.compile(r'^(motors/effort|wrench_command/.*force)')
# Estimates of the vehicle's own programs.
DERIVED: Final = re.compile(r'^(odom$|light/|energy/|wind$)')
# External tracking; the vehicle's own odometry is dead reckoning and does not match.
TRACKED: Final = re.compile(r'^(ground_truth/|vicon|mocap|optitrack|qualisys|tracker|pose$)')

POSITION_PATTERN: Final = re.compile(r'(.*position|.*translation|point)\.([xyz])$')
QUATERNION_FIELD: Final = re.compile(r'(.*orientation|.*rotation|quaternion)\.([xyzw])$')
ANGLE: Final = re.compile(r'(.*orientation|.*rotation|quaternion)\.(yaw|pitch|roll)$')
SPEED: Final = re.compile(r'(.*linear)\.([xyz])$')
TURNING_FIELD: Final = re.compile(r'(.*angular)\.([xyz])$')
RATES_FIELD: Final = re.compile(r'(angular_velocity)\.([xyz])$')
FORCE_FIELD: Final = re.compile(r'(linear_acceleration)\.([xyz])$')
# The empty group stands for the missing axis, as all these patterns have two groups
PRESSURE: Final = re.compile(r'(fluid_pressure)()$')
SHINE: Final = re.compile(r'(mean|std)\[(\d+)\]$')

# Quantities whose measured values never repeat for long.
RESTLESS: Final = {
    'position': POSITION_PATTERN,
    'attitude': ANGLE,
    'velocity': SPEED,
    'turning': TURNING_FIELD,
    'rates': RATES_FIELD,
    'force': FORCE_FIELD,
    'pressure': PRESSURE,
}


def is_instrument_topic(topic: str) -> bool:
    """Return whether a topic holds measurements; constant, held, limited commands are normal."""
    return not is_command_topic(topic) and not DERIVED.match(topic)


def is_measured(channel: Channel) -> bool:
    """Return whether a channel is a measurement."""
    return is_instrument_topic(channel.topic)


def match_noisy_quantity(channel: Channel) -> str | None:
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


class ValidRange(NamedTuple):
    """The possible values of a channel, whatever the flight."""

    names: re.Pattern[str]
    low: float
    high: float
    reason: str


INFINITE: Final = float('inf')
RANGES: Final = tuple(
    ValidRange(re.compile(names), low, high, reason)
    for names, low, high, reason in (
        (r'^motors/effort\.|^motors/effort\[', -1.0, 1.0, 'a duty is between -1 and 1'),
        (r'(^|/)range/range$', 0.0, INFINITE, 'a distance cannot be negative'),
        (r'(^|/)illuminance/illuminance$', 0.0, 2e5,
         'an illuminance cannot be negative, nor far above sunlight (1.3e5 lx)'),
        (r'/percentage$', 0.0, 1.0, 'a state of charge is between 0 and 1'),
        (r'/fluid_pressure$', 3e4, 1.1e5,
         'the air pressure below 9 km altitude is between 3e4 and 1.1e5 Pa'),
        (r'linear_acceleration\.[xyz]$', -320.0, 320.0,
         'no accelerometer measures more than 32 g'),
        (r'angular(_velocity)?\.[xyz]$', -70.0, 70.0,
         'no gyroscope measures more than 4000 deg/s (70 rad/s)'),
        (r'linear\.[xyz]$', -60.0, 60.0, 'no indoor vehicle is faster than 60 m/s'),
        # 7 is just above 2 pi
        (r'\.(yaw|pitch|roll)$', -7.0, 7.0, 'an angle in radians is between -2 pi and 2 pi'),
        (r'^light/peaks/snr\[', 0.0, INFINITE, 'a signal-to-noise ratio cannot be negative'),
        (r'/temperature$', -60.0, 150.0,
         'a temperature in flight is between -60 and 150 degrees Celsius'),
    )
)  # fmt: skip
COUNT_CHANNELS: Final = re.compile(r'^photodiodes/(min|max|mean)\[|^light/peaks/amplitude\[')
SPREAD_CHANNELS: Final = re.compile(r'^photodiodes/std\[')
# Single cells and packs; no battery has less than 2.5 V or 4.4 to 5 V. [V]
CELLS: Final = ((2.5, 4.4), (5.0, 61.0))


def build_light_ranges(top: float | None) -> tuple[ValidRange, ...]:
    """
    Return the possible readings of light.

    `top` is the largest reading of the ADC [counts]; None if unknown.
    """
    if top is None:
        return tuple(
            ValidRange(n, 0.0, INFINITE, 'an ADC reading cannot be negative')
            for n in (COUNT_CHANNELS, SPREAD_CHANNELS)
        )
    return (
        ValidRange(COUNT_CHANNELS, 0.0, top, f'the ADC counts from 0 to {top:.0f}'),
        # The standard deviation of bounded values is at most half their range
        ValidRange(
            SPREAD_CHANNELS,
            0.0,
            (top + 1.0) / 2.0,
            'a standard deviation is at most half of the range of the ADC '
            f'({top + 1.0:.0f} counts)',
        ),
    )
