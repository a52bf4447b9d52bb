"""Extract the stamp of a message."""

from collections.abc import Collection
from typing import Final

SECOND: Final = 1_000_000_000  # ns
# Paths of the stamp: first transform, header, or clock.
PLACES: Final = ('transforms[0].header.stamp', 'header.stamp', 'clock')


def extract_stamp(message: object) -> int | None:
    """
    Return the stamp of a decoded message, from its header, first transform or clock. [ns]

    None if there is no stamp or it is zero, that is, unfilled.
    """
    transforms = getattr(message, 'transforms', None)
    stamped = transforms[0] if transforms else message
    header = getattr(stamped, 'header', None)
    time = getattr(stamped, 'clock', None) if header is None else getattr(header, 'stamp', None)
    seconds, rest = getattr(time, 'sec', None), getattr(time, 'nanosec', None)
    if seconds is None or rest is None:
        return None
    return int(seconds) * SECOND + int(rest) or None


def find_stamp_path(paths: Collection[str]) -> str | None:
    """Return the path of the stamp among the paths of a message's fields; None without a stamp."""
    for place in PLACES:
        if f'{place}.sec' in paths and f'{place}.nanosec' in paths:
            return place
    return None
