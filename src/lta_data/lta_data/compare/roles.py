"""Which channels matter most to people: those with a place of their own on the page."""

from collections.abc import Sequence
from fnmatch import fnmatchcase
from typing import Final, NamedTuple

from lta_data.compare.apart import Apart

POSES: Final = ('ground_truth/odom', 'odom')  # whose position is drawn, in this order


class Role(NamedTuple):
    """A place on the page: name, title, and patterns of the channels that fit, the best first."""

    name: str
    title: str
    patterns: tuple[str, ...]


ROLES: Final = (
    Role('x', 'Position, x', ('{pose}position.x',)),
    Role('y', 'Position, y', ('{pose}position.y',)),
    Role('altitude', 'Altitude', ('{pose}position.z', 'range/range')),
    Role('heading', 'Heading', ('{pose}orientation.yaw', '*orientation.yaw')),
    Role('speed', 'Forward speed', ('{topic}/*linear.x', 'odom/*linear.x', '*twist*linear.x')),
    Role('pitch', 'Pitch', ('{pose}orientation.pitch', '*orientation.pitch')),
    Role('roll', 'Roll', ('{pose}orientation.roll', '*orientation.roll')),
    Role('motors', 'Motors', ('motors/*', 'wrench_command/*')),
    Role('battery', 'Battery', ('battery/voltage', '*battery*/voltage', 'battery/current')),
    Role('light', 'Light', ('light/peaks/snr*', 'light/*', 'illuminance/*', 'photodiodes/*')),
)
FIELDS: Final = {  # how a field ends, and what people call it
    'position.x': 'x',
    'position.y': 'y',
    'position.z': 'altitude',
    'orientation.yaw': 'heading',
    'orientation.pitch': 'pitch',
    'orientation.roll': 'roll',
    'linear.x': 'forward speed',
    'linear.y': 'sideways speed',
    'linear.z': 'climb',
    'angular.z': 'yaw rate',
}
ENDS: Final = tuple(FIELDS)
MANY: Final = ('motors', 'light')  # roles that several channels fill
MOTION: Final = ('x', 'y', 'altitude', 'heading', 'speed', 'pitch', 'roll', 'motors')


class Shown(NamedTuple):
    """A channel in its place, and of how many it is the one that parts most."""

    role: Role
    channel: Apart
    among: int


def pose_of(channels: Sequence[Apart]) -> str:
    """Return where the fields of the pose to draw begin: 'odom/pose.pose.'; '' without one."""
    found = [each.name.removesuffix('position.x') for each in channels if is_x(each)]
    for topic in POSES:
        for start in found:
            if start.startswith(f'{topic}/'):
                return start
    # A setpoint or a lamp has a place as well, but does not move as the hull does.
    free = [start for start in found if not start.startswith(('setpoint', 'light'))]
    return (free or found or [''])[0]


def is_x(each: Apart) -> bool:
    """Tell whether a channel is the x of a position."""
    return each.name.endswith('position.x')


def main_channels(channels: Sequence[Apart]) -> list[Shown]:
    """Return the channels that have a place of their own on the page."""
    pose = pose_of(channels)
    found = []
    for role in ROLES:
        for pattern in role.patterns:
            if '{' in pattern and not pose:
                continue
            wanted = pattern.format(pose=pose, topic=pose.rpartition('/')[0])
            fitting = [
                each
                for each in channels
                if fnmatchcase(each.name, wanted) and each.measures is not None and not each.still
            ]
            if fitting:
                count = len(fitting) if role.name in MANY else 1
                found.append(Shown(role, fitting[0], count))
                break
    return found


def headline(channels: Sequence[Apart]) -> list[Apart]:
    """Return what a sentence speaks of: the hull's motion and the commands, else all."""
    moving = [shown.channel for shown in main_channels(channels) if shown.role.name in MOTION]
    hull = pose_of(channels).rpartition('/')[0]
    ordered = [
        each
        for each in channels
        if any(each is one for one in moving)
        or (
            each.name.rpartition('/')[0] == hull
            and each.name.endswith(tuple(FIELDS))
            and not each.still
        )
    ]
    return ordered or [each for each in channels if not each.still] or list(channels)
