"""When a message was measured, as it says itself."""

from collections.abc import Collection
from typing import Final

SECOND: Final = 1_000_000_000  # ns
# Where a message has its stamp: of its first transform, of its header, or its clock.
PLACES: Final = ('transforms[0].header.stamp', 'header.stamp', 'clock')


def extract_stamp(message: object) -> int | None:
    """
    Return the stamp of a message. [ns]

    Parameters
    ----------
    message : object
        Decoded message.

    Returns
    -------
    int or None
        From its header, its first transform or its clock; None where it has none, or where
        nobody filled it in (zero).

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
    """
    Return where messages with some fields have their stamp; None where they have none.

    Parameters
    ----------
    paths : collection of str
        The paths of a message's fields.

    """
    for place in PLACES:
        if f'{place}.sec' in paths and f'{place}.nanosec' in paths:
            return place
    return None
