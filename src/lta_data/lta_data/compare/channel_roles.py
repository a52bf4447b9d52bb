"""Which channels matter most to people: those with a place of their own on the page."""

from collections.abc import Sequence
from fnmatch import fnmatchcase
from typing import Final, NamedTuple

from lta_data.compare.channel_comparison import ChannelComparison

POSES: Final = ('ground_truth/odom', 'odom')  # whose position is drawn, in this order


class PageRole(NamedTuple):
    """A place on the page: name, title, and patterns of the channels that fit, the best first."""

    name: str
    title: str
    patterns: tuple[str, ...]


ROLES: Final = (
    PageRole('x', 'Position, x', ('{pose}position.x',)),
    PageRole('y', 'Position, y', ('{pose}position.y',)),
    PageRole('altitude', 'Altitude', ('{pose}position.z', 'range/range')),
    PageRole('heading', 'Heading', ('{pose}orientation.yaw', '*orientation.yaw')),
    PageRole('speed', 'Forward speed', ('{topic}/*linear.x', 'odom/*linear.x', '*twist*linear.x')),
    PageRole('pitch', 'Pitch', ('{pose}orientation.pitch', '*orientation.pitch')),
    PageRole('roll', 'Roll', ('{pose}orientation.roll', '*orientation.roll')),
    PageRole('motors', 'Motors', ('motors/*', 'wrench_command/*')),
    PageRole('battery', 'Battery', ('battery/voltage', '*battery*/voltage', 'battery/current')),
    PageRole('light', 'Light', ('light/peaks/snr*', 'light/*', 'illuminance/*', 'photodiodes/*')),
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


class RoleChannel(NamedTuple):
    """A channel in its place, and of how many it is the one that parts most."""

    role: PageRole
    channel: ChannelComparison
    among: int


def find_pose_prefix(channels: Sequence[ChannelComparison]) -> str:
    """Return where the fields of the pose to draw begin: 'odom/pose.pose.'; '' without one."""
    found = [each.name.removesuffix('position.x') for each in channels if is_x_position(each)]
    for topic in POSES:
        for start in found:
            if start.startswith(f'{topic}/'):
                return start
    # A setpoint or a lamp has a place as well, but does not move as the hull does.
    free = [start for start in found if not start.startswith(('setpoint', 'light'))]
    return (free or found or [''])[0]


def is_x_position(each: ChannelComparison) -> bool:
    """Tell whether a channel is the x of a position."""
    return each.name.endswith('position.x')


def select_main_channels(channels: Sequence[ChannelComparison]) -> list[RoleChannel]:
    """Return the channels that have a place of their own on the page."""
    pose = find_pose_prefix(channels)
    found = []
    for role in ROLES:
        for pattern in role.patterns:
            if '{' in pattern and not pose:
                continue
            wanted = pattern.format(pose=pose, topic=pose.rpartition('/')[0])
            fitting = [
                each
                for each in channels
                if fnmatchcase(each.name, wanted)
                and each.measures is not None
                and not each.is_still
            ]
            if fitting:
                count = len(fitting) if role.name in MANY else 1
                found.append(RoleChannel(role, fitting[0], count))
                break
    return found


def select_headline_channels(channels: Sequence[ChannelComparison]) -> list[ChannelComparison]:
    """Return what a sentence speaks of: the hull's motion and the commands, else all."""
    moving = [
        shown.channel for shown in select_main_channels(channels) if shown.role.name in MOTION
    ]
    hull = find_pose_prefix(channels).rpartition('/')[0]
    ordered = [
        each
        for each in channels
        if any(each is one for one in moving)
        or (
            each.name.rpartition('/')[0] == hull
            and each.name.endswith(tuple(FIELDS))
            and not each.is_still
        )
    ]
    return ordered or [each for each in channels if not each.is_still] or list(channels)
