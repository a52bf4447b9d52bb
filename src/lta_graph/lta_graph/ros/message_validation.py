# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Find the class of messages, and validate them: finite numbers, lengths and continuous stamps.

An invalid message is counted for /diagnostics and passed on nevertheless, because in lockstep some
node waits for the answer to it. `InboxStep.valid` leaves out messages with invalid content.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cache
from importlib import import_module
import math
from operator import attrgetter
import re
from typing import Any, cast, Final, final

from builtin_interfaces.msg import Time
from lta_config.topics import Topic
from lta_graph.health import RejectionCount
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.serialization import deserialize_message

MESSAGES: Final = 'messages'  # health task with the number of invalid messages
# Fields that must hold finite numbers, by message type
NUMERIC_FIELDS: Final[Mapping[str, tuple[str, ...]]] = {
    'Imu': ('angular_velocity', 'linear_acceleration'),
    'FluidPressure': ('fluid_pressure',),
    'Illuminance': ('illuminance',),
    'BatteryState': ('voltage', 'current'),
    'Odometry': ('pose.pose', 'twist.twist'),
    'ActuatorDuty': ('duty',),
    'Vector3Stamped': ('vector',),
    'PoseWithCovarianceStamped': ('pose.pose', 'pose.covariance'),
    'PoseStamped': ('pose',),
    'TwistStamped': ('twist',),
    'TwistWithCovarianceStamped': ('twist.twist',),
    'Float64': ('data',),
    'Joy': ('axes',),
}
Numbers = Callable[[Any], Sequence[float]]
LARGEST_VALUE: Final = 1e9  # in the unit of any field; no sensor measures more
STAMP_JUMP_NS: Final = 2_000_000_000  # largest step between two stamps of a periodic topic


def find_message_type(topic: Topic) -> Any:
    """Return the Python class of a topic's messages."""
    return import_message_type(topic.type)


@cache
def import_message_type(name: str) -> Any:
    """Return the Python class of a message type, such as 'sensor_msgs/msg/Imu'."""
    package, _, message = name.split('/')
    return getattr(import_module(f'{package}.msg'), message)


def decode_message(data: bytes, kind: Any) -> Any:
    """Return the message of a class that the data hold; raise `ValueError` if they hold none."""
    try:
        return deserialize_message(data, kind)
    except rclpy_implementation.RMWError as fault:
        why = str(fault).partition(', at /')[0]
        raise ValueError(f'it is no message of type {kind.__name__} ({why})') from fault


def _iterate_number_paths(value: object, path: str) -> Iterator[str]:
    """Yield the attribute paths of the numbers in a part of a message; an array is one path."""
    # Only generated message classes have it: anything else is a number or an array
    if not hasattr(value, 'get_fields_and_field_types'):
        yield path
        return
    for name in value.get_fields_and_field_types():
        yield from _iterate_number_paths(getattr(value, name), f'{path}.{name}')


def _build_reader(empty: object, path: str) -> Numbers:
    """Return a function that reads all numbers of a part of a message."""
    # Built once per type from an empty message, because every message of a flight is read
    paths = list(_iterate_number_paths(attrgetter(path)(empty), path))
    # The slots behind the properties, whose getters are functions of Python
    get: Any = attrgetter(*(re.sub(r'\b(?=\w)', '_', path) for path in paths))
    part = get(empty)
    if isinstance(part, tuple):
        return cast('Numbers', get)
    if isinstance(part, float):
        return lambda message: (get(message),)
    return lambda message: get(message).tolist()


@cache
def _list_numeric_parts(kind: Callable[[], object]) -> list[tuple[str, Numbers]]:
    """Return the checked parts of a message type and their readers; cached."""
    name = getattr(kind, '__name__', '')
    return [(path, _build_reader(kind(), path)) for path in NUMERIC_FIELDS.get(name, ())]


def _is_plausible(numbers: Sequence[float]) -> bool:
    # The sum is a fast first test. It is NaN if any term is, and NaN compares false
    return sum(map(abs, numbers)) <= LARGEST_VALUE or all(
        abs(number) <= LARGEST_VALUE for number in numbers
    )


def _find_range_fault(message: Any) -> str:
    # REP-117: infinite stands for an object out of range
    meant = math.isinf(message.range) or abs(message.range) <= LARGEST_VALUE
    return '' if meant else 'its range is not a number, or implausibly large'


def _find_duty_fault(message: Any) -> str:
    have, want = len(message.duty), len(message.name)
    return '' if have == want else f'it has {want} names, but {have} duties'


def _find_block_fault(message: Any) -> str:
    counts, diodes = len(message.counts), message.diodes
    whole = diodes and not counts % diodes
    return '' if whole else f'it has {counts} counts, no multiple of its {diodes} diodes'


def _find_peaks_fault(message: Any) -> str:
    want = len(message.axis)
    for beacon in message.beacon:
        for name in ('amplitude', 'snr', 'frequency'):
            if len(getattr(beacon, name)) != want:
                have = len(getattr(beacon, name))
                return f'it has {want} diodes, but {have} values of {name}'
        # The SNR may be infinite: no noise
        if not _is_plausible([*beacon.amplitude, *beacon.frequency]):
            return 'a beacon has a value that is not a number, or implausibly large'
    if not _is_plausible([part for axis in message.axis for part in (axis.x, axis.y, axis.z)]):
        return 'its axis has a value that is not a number, or implausibly large'
    return ''


FAULT_FINDERS: Final[Mapping[str, Callable[[Any], str]]] = {
    'Range': _find_range_fault,
    'ActuatorDuty': _find_duty_fault,
    'LampPeaks': _find_peaks_fault,
    'LightBlock': _find_block_fault,
}


def find_fault(message: Any) -> str:
    """Return why a message is invalid, or an empty string."""
    for path, numbers in _list_numeric_parts(message.__class__):
        if not _is_plausible(numbers(message)):
            return f'its {path} has a value that is not a number, or implausibly large'
    kind = type(message).__name__
    return FAULT_FINDERS[kind](message) if kind in FAULT_FINDERS else ''


@final
class MessageValidator:
    """
    Count the invalid messages that a node receives.

    A jump in the stamps may come from a changed clock or from a wrong sender. They look alike, so
    a jump is only reported.

    `stamps`: whether to check the stamps of periodic topics. Attribute `unsound`: the invalid
    messages.
    """

    def __init__(self, stamps: bool) -> None:
        self.unsound = RejectionCount()
        self._stamps = stamps
        self._newest: dict[str, int] = {}

    def validate(self, row: Topic, name: str, message: Any) -> bool:
        """
        Count a message of a topic if it is invalid, and return whether its content is valid.

        A jump in the stamps is counted, but does not make the content invalid.
        """
        fault = why = find_fault(message)
        if not why and self._stamps and row.stamped and row.period_ns:
            why = self._find_stamp_jump(name, message.header.stamp)
        if why:
            self.unsound.add(f'{name}: {why}')
        return not fault

    def _find_stamp_jump(self, name: str, stamp: Time) -> str:
        """Return a description of a jump in a topic's stamps, or an empty string."""
        now = int(stamp.sec) * 1_000_000_000 + int(stamp.nanosec)
        by = now - self._newest.get(name, now)
        # Also after a jump, so that a changed clock is reported once
        self._newest[name] = now
        return f'its time stamp jumps by {1e-9 * by:.1f} s' if abs(by) > STAMP_JUMP_NS else ''
