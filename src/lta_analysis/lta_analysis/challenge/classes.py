"""What no data of a kind can tell apart, frozen before anything is scored."""

from typing import Final

# One constant force at the hull centre; one delay between what the vehicle and what the tracker
# says. A class is named by its first member.
CLASSES: Final[tuple[tuple[str, ...], ...]] = (
    ('net_lift.force', 'ballast.mass', 'payload.mass', 'gas_purity.purity'),
    ('tracker_delay.delay', 'clock_offset.offset'),
)
_OF: Final = {name: members[0] for members in CLASSES for name in members}


def class_of(knob: str) -> str:
    """Return the class that a knob belongs to; itself where nothing looks like it."""
    return _OF.get(knob, knob)
