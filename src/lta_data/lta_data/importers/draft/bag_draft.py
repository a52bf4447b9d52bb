"""Draft the topics of a bag by their message types and names."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final

from lta_config.errors import BadInput
from lta_data.importers.draft.choices import DraftChoices
from lta_data.importers.draft.name_hints import match_role, parse_column_name
from lta_data.importers.formats import FORMATS

# Message type -> topic; a pose or odometry is truth, estimate or setpoint by its name
BY_TYPE: Final[Mapping[str, str]] = {
    'sensor_msgs/msg/Imu': 'imu',
    'sensor_msgs/msg/BatteryState': 'battery',
    'sensor_msgs/msg/Range': 'range',
    'sensor_msgs/msg/FluidPressure': 'pressure',
    'sensor_msgs/msg/Illuminance': 'illuminance',
    'geometry_msgs/msg/WrenchStamped': 'wrench_command',
}
POSES: Final = (
    'nav_msgs/msg/Odometry',
    'geometry_msgs/msg/PoseStamped',
    'geometry_msgs/msg/TransformStamped',
    'geometry_msgs/msg/PoseWithCovarianceStamped',
)
ROLES: Final = {'truth': 'ground_truth/odom', 'estimate': 'odom', 'setpoint': 'setpoint/pose'}


def draft_bag_topics(path: Path, choices: DraftChoices) -> list[dict[str, Any]]:
    """
    Return the topics of a bag that become ours.

    Raises
    ------
    BadInput
        If no topic has a type that an import can convert.

    """
    raw = FORMATS['bag'].opened(path, None).raw
    candidates: dict[str, list[tuple[str, str]]] = {}
    for name, topic in sorted(raw.items()):
        kind = topic.definition.type_name
        if kind in POSES:
            role = match_role(parse_column_name(name).words)
            ours = ROLES[role] if role else ('odom' if 'Odometry' in kind else ROLES['truth'])
            candidates.setdefault(ours, []).append((name, kind))
        elif kind in BY_TYPE:
            candidates.setdefault(BY_TYPE[kind], []).append((name, kind))
    entries = []
    for ours, fitting in candidates.items():
        table = fitting[0][0]
        if len(fitting) > 1:
            table = choices.decide(
                f'{ours}.table', fitting, f'Several topics of the bag can be {ours}.'
            )
        table = choices.override(f'{ours}.table', table)
        kind = raw[table].definition.type_name if table in raw else ''
        choices.add_reason(ours, [table], kind, 'the message type and the name')
        entries.append({'topic': ours, 'table': table})
    if not entries:
        types = sorted({topic.definition.type_name for topic in raw.values()})
        raise BadInput(
            f"No topic of '{path}' has a type that becomes one of ours; it has "
            f'{", ".join(types)}. It can be imported as it is, without a mapping.'
        )
    return entries
