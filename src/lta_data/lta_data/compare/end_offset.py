"""Where B ends relative to A, and since when they turn differently, in words."""

from collections.abc import Mapping
import math
from typing import Final

from lta_data.compare.channel_comparison import ChannelComparison
from lta_data.compare.channel_roles import find_pose_prefix
from lta_data.compare.comparison import ComparisonResult

WORDS: Final = (('ahead of', 'behind'), ('left of', 'right of'), ('above', 'below'))
NOTABLE: Final = 0.5  # a smaller part of the largest component is not mentioned


def find_pose_channels(comparison: ComparisonResult) -> Mapping[str, ChannelComparison]:
    """Return the channels of position and heading: x, y, z, yaw, as far as there are any."""
    pose = find_pose_prefix(comparison.channels)
    fields = {f'{pose}position.{axis}': axis for axis in 'xyz'} | {f'{pose}orientation.yaw': 'yaw'}
    return {
        fields[each.name]: each
        for each in comparison.channels
        if pose and each.name in fields and each.measures is not None
    }


def end_offset(channels: Mapping[str, ChannelComparison]) -> tuple[float, float, float] | None:
    """
    Return the position of B relative to A at the end of the common time.

    Returns
    -------
    tuple of 3 float, optional
        Ahead, left and up in A's heading; None without position or heading. [m]

    """
    if not channels.keys() >= set('xyz') | {'yaw'}:
        return None
    x, y, z = (float(_read_valid(channels[axis], 'difference')[-1]) for axis in 'xyz')
    heading = float(_read_valid(channels['yaw'], 'a')[-1])
    ahead = x * math.cos(heading) + y * math.sin(heading)
    left = y * math.cos(heading) - x * math.sin(heading)
    return ahead, left, z


def _read_valid(channel: ChannelComparison, part: str) -> list[float]:
    both = channel.both
    return list(getattr(both, part)[both.both_valid])


def format_direction(offset: tuple[float, float, float]) -> str:
    """Return the direction of an offset: 'behind', or 'behind and left of' for instance."""
    largest = max(map(abs, offset))
    words = [
        plus if part > 0.0 else minus
        for part, (plus, minus) in zip(offset, WORDS, strict=True)
        if abs(part) >= NOTABLE * largest
    ]
    return ' and '.join(words) if len(words) < 3 else f'{words[0]}, {words[1]} and {words[2]}'
