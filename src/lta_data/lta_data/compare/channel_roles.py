# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Select the channels that get their own panel on the page, and those of the headline."""

from collections.abc import Sequence
from fnmatch import fnmatchcase
from typing import Final, NamedTuple

from lta_data.compare.channel_comparison import ChannelComparison

POSE_TOPICS: Final = ('ground_truth/odom', 'odom')  # topics whose position is plotted, by priority


class PanelRole(NamedTuple):
    """A panel of the page: name, title, and patterns of matching channels, the best first."""

    name: str
    title: str
    patterns: tuple[str, ...]


PANEL_ROLES: Final = (
    PanelRole('x', 'Position, x', ('{pose}position.x',)),
    PanelRole('y', 'Position, y', ('{pose}position.y',)),
    PanelRole('altitude', 'Altitude', ('{pose}position.z', 'range/range')),
    PanelRole('heading', 'Heading', ('{pose}orientation.yaw', '*orientation.yaw')),
    PanelRole(
        'speed', 'Forward speed', ('{topic}/*linear.x', 'odom/*linear.x', '*twist*linear.x')
    ),
    PanelRole('pitch', 'Pitch', ('{pose}orientation.pitch', '*orientation.pitch')),
    PanelRole('roll', 'Roll', ('{pose}orientation.roll', '*orientation.roll')),
    PanelRole('motors', 'Motors', ('motors/*', 'wrench_command/*')),
    PanelRole('battery', 'Battery', ('battery/voltage', '*battery*/voltage', 'battery/current')),
    PanelRole('light', 'Light', ('light/peaks/snr*', 'light/*', 'illuminance/*', 'photodiodes/*')),
)
FIELDS: Final = {  # ending of a field -> common name
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
MANY_CHANNEL_ROLES: Final = ('motors', 'light')  # roles with several channels
MOTION_ROLES: Final = ('x', 'y', 'altitude', 'heading', 'speed', 'pitch', 'roll', 'motors')


class RoleChannel(NamedTuple):
    """The channel shown for a role: the most divergent of `among` channels."""

    role: PanelRole
    channel: ChannelComparison
    among: int


def find_pose_prefix(channels: Sequence[ChannelComparison]) -> str:
    """Return the prefix of the plotted pose's fields, such as 'odom/pose.pose.', or ''."""
    names = [each.name for each in channels if each.name.endswith('position.x')]
    prefixes = [name.removesuffix('position.x') for name in names]
    for topic in POSE_TOPICS:
        for start in prefixes:
            if start.startswith(f'{topic}/'):
                return start
    # Setpoints and lamps have positions too, but are not the vehicle's.
    free = [start for start in prefixes if not start.startswith(('setpoint', 'light'))]
    return (free or prefixes or [''])[0]


def select_panel_channels(channels: Sequence[ChannelComparison]) -> list[RoleChannel]:
    """Return the channels that get their own panel."""
    pose = find_pose_prefix(channels)
    panels = []
    for role in PANEL_ROLES:
        for pattern in role.patterns:
            # A pattern of the pose without a pose would match anything
            if '{' in pattern and not pose:
                continue
            name = pattern.format(pose=pose, topic=pose.rpartition('/')[0])
            fitting = [
                each
                for each in channels
                if fnmatchcase(each.name, name)
                and each.measures is not None
                and not each.both_constant
            ]
            if fitting:
                count = len(fitting) if role.name in MANY_CHANNEL_ROLES else 1
                # The channels are sorted by divergence, so the first is the largest
                panels.append(RoleChannel(role, fitting[0], count))
                break
    return panels


def select_headline_channels(channels: Sequence[ChannelComparison]) -> list[ChannelComparison]:
    """Return the channels for the headline: motion and commands, otherwise all."""
    moving = [
        panel.channel
        for panel in select_panel_channels(channels)
        if panel.role.name in MOTION_ROLES
    ]
    hull = find_pose_prefix(channels).rpartition('/')[0]
    ordered = [
        each
        for each in channels
        if any(each is one for one in moving)
        or (
            each.name.rpartition('/')[0] == hull
            and each.name.endswith(tuple(FIELDS))
            and not each.both_constant
        )
    ]
    return ordered or [each for each in channels if not each.both_constant] or list(channels)
