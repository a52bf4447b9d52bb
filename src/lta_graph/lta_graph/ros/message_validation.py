"""
Whether a message can be meant: numbers that are numbers, and lengths that agree.

What it says is for /diagnostics. A message that is not sound is handed on all the same: in
lockstep somebody waits for its answer, and each node knows what it must not believe. So this is
no guard.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cache
import math
from operator import attrgetter
from typing import Any, Final, final

from builtin_interfaces.msg import Time
from lta_config.topics import Topic
from lta_graph.rejections import RejectionCount

MESSAGES: Final = 'messages'  # the task in which a node tells it
NUMBERS: Final[Mapping[str, tuple[str, ...]]] = {  # by type, the fields that must hold numbers
    'Imu': ('angular_velocity', 'linear_acceleration'),
    'FluidPressure': ('fluid_pressure',),
    'Illuminance': ('illuminance',),
    'BatteryState': ('voltage', 'current'),
    'Odometry': ('pose.pose', 'twist.twist'),
    'JointState': ('effort',),
    'Vector3Stamped': ('vector',),
    'PoseWithCovarianceStamped': ('pose.pose', 'pose.covariance'),
    'PoseStamped': ('pose',),
    'TwistStamped': ('twist',),
    'Float64': ('data',),
    'Joy': ('axes',),
}
Numbers = Callable[[Any], Sequence[float]]
LARGEST: Final = 1e9  # in any unit of ours; more was not measured
JUMP_NS: Final = 2_000_000_000  # from one stamp of a topic to the next


def _iterate_number_paths(value: object, path: str) -> Iterator[str]:
    """Yield where the numbers of a part of a message are, an array as one."""
    if not hasattr(value, 'get_fields_and_field_types'):
        yield path
        return
    for name in value.get_fields_and_field_types():
        yield from _iterate_number_paths(getattr(value, name), f'{path}.{name}')


def _build_reader(empty: object, path: str) -> Numbers:
    """Return what reads all numbers of a part of a message."""
    get = attrgetter(*_iterate_number_paths(attrgetter(path)(empty), path))
    part = get(empty)
    if isinstance(part, tuple):
        return get
    if isinstance(part, float):
        return lambda message: (get(message),)
    return lambda message: get(message).tolist()


@cache
def _list_numeric_parts(kind: Callable[[], object]) -> list[tuple[str, Numbers]]:
    """Return the parts of a type that must hold numbers; worked out once, as all are looked at."""
    name = getattr(kind, '__name__', '')
    return [(path, _build_reader(kind(), path)) for path in NUMBERS.get(name, ())]


def _is_plausible(numbers: Sequence[float]) -> bool:
    # A sum is quick, and no number where one of its terms is none; NaN compares false.
    return sum(map(abs, numbers)) <= LARGEST or all(abs(number) <= LARGEST for number in numbers)


def _find_range_fault(message: Any) -> str:  # noqa: ANN401 - a generated class
    # Infinite is what is not in reach (REP-117).
    meant = math.isinf(message.range) or abs(message.range) <= LARGEST
    return '' if meant else 'its range is not a number, or none that is measured'


def _find_image_fault(message: Any) -> str:  # noqa: ANN401 - a generated class
    return _find_size_fault(len(message.data), message.height * message.step)


def _find_cloud_fault(message: Any) -> str:  # noqa: ANN401 - a generated class
    wrong = _find_size_fault(len(message.data), message.height * message.row_step)
    if not wrong and message.row_step != message.width * message.point_step:
        wrong = 'its points do not fit its rows'
    if not wrong and len({field.name for field in message.fields}) < len(message.fields):
        wrong = 'its fields have one name'
    return wrong


def _find_joint_fault(message: Any) -> str:  # noqa: ANN401 - a generated class
    have, want = len(message.effort), len(message.name)
    return '' if have == want else f'it has {want} names and {have} efforts'


def _find_size_fault(have: int, want: int) -> str:
    return '' if have == want else f'it has {have} bytes and declares {want}'


LENGTHS: Final[Mapping[str, Callable[[Any], str]]] = {
    'Range': _find_range_fault,
    'Image': _find_image_fault,
    'PointCloud2': _find_cloud_fault,
    'JointState': _find_joint_fault,
}


def find_fault(message: Any) -> str:  # noqa: ANN401 - a generated class
    """Return why a message cannot be meant; empty where it can."""
    for path, numbers in _list_numeric_parts(type(message)):
        if not _is_plausible(numbers(message)):
            return f'its {path} holds what is not a number, or none that is measured'
    kind = type(message).__name__
    return LENGTHS[kind](message) if kind in LENGTHS else ''


@final
class MessageValidator:
    """
    What a node has heard that cannot be meant.

    A clock that was set and somebody who speaks of another time look the same, so a stamp that
    jumps is told and no more.

    Parameters
    ----------
    stamps : bool
        Whether to look at the stamps of topics that have a rhythm.

    Attributes
    ----------
    unsound : Refused
        How much that was.

    """

    def __init__(self, stamps: bool) -> None:
        self.unsound = RejectionCount()
        self._stamps = stamps
        self._newest: dict[str, int] = {}

    def validate(self, row: Topic, name: str, message: Any) -> None:  # noqa: ANN401 - see above
        """Count a message of a topic if it cannot be meant."""
        why = find_fault(message)
        if not why and self._stamps and row.stamped and row.period_ns:
            why = self._find_stamp_jump(name, message.header.stamp)
        if why:
            self.unsound.add(f'{name}: {why}')

    def _find_stamp_jump(self, name: str, stamp: Time) -> str:
        """Return by how much a topic's stamp has jumped, in words; empty where it has not."""
        now = int(stamp.sec) * 1_000_000_000 + int(stamp.nanosec)
        by = now - self._newest.get(name, now)
        self._newest[name] = now
        return f'its stamp jumps by {1e-9 * by:.1f} s' if abs(by) > JUMP_NS else ''
