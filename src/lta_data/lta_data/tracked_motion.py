"""Find the tracked pose among the channels of a flight, and the unit of its commands."""

from collections.abc import Collection, Mapping
from typing import Any, Final

from lta_config.errors import BadInput
from lta_config.files import parse_yaml

TRACKERS: Final = ('ground_truth/odom', 'ground_truth/pose', 'pose', 'mocap/pose', 'vrpn/pose')
NO_TRACKER: Final = ('odom', 'setpoint', 'light', 'estimate')  # poses that are not measurements
POSITION: Final = 'position.x'
COMMAND: Final = 'motors/effort.'
MASS: Final = tuple(f'motors/position.moving_mass_{axis}' for axis in 'xyz')
NEWTONS: Final = frozenset({'N', 'mN'})  # units of imported thrust commands


def find_tracker_prefix(channels: Collection[str]) -> str:
    """
    Return the prefix of the tracked pose's channels: 'ground_truth/odom/pose.pose.'.

    Raise `BadInput` if no measured pose was recorded.
    """
    prefixes = [
        name.removesuffix(POSITION)
        for name in channels
        if name.endswith(POSITION) and f'{name.removesuffix(POSITION)}orientation.yaw' in channels
    ]
    # Estimates and setpoints also have poses, but are not measurements
    free = [name for name in prefixes if not name.startswith(NO_TRACKER)]
    for topic in TRACKERS:
        for name in free:
            if name.startswith(f'{topic}/'):
                return name
    if free:
        return free[0]
    raise BadInput(
        'The recording has no measured pose, so no model can be compared with it; record one of '
        f'the topics {", ".join(TRACKERS)}.'
    )


def has_newton_commands(provenance: Mapping[str, str]) -> bool | None:
    """Return whether the commands of an import are in newtons; None if it does not state that."""
    text = provenance.get('mapping_file')
    if not text:
        return None
    # Not validated against the current schema: a recording may be of an older version.
    try:
        mapping = parse_yaml(text, 'The mapping')
    except BadInput:
        return None
    for topic in _list_dicts(mapping, 'topics'):
        if topic.get('topic') == 'motors':
            efforts = [actuator.get('effort') for actuator in _list_dicts(topic, 'actuators')]
            return any(isinstance(each, dict) and each.get('unit') in NEWTONS for each in efforts)
    return None


def _list_dicts(holder: object, name: str) -> list[dict[str, Any]]:
    """Return the entries of a list, or the values of a dictionary, that are dictionaries."""
    content = holder.get(name) if isinstance(holder, dict) else None
    # A mapping by name, or a list
    each = [*content.values()] if isinstance(content, dict) else content
    return [entry for entry in each if isinstance(entry, dict)] if isinstance(each, list) else []
