# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Draft the topics of a bag: poses by type and physics, commands by name and by the user."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, Final, final, NamedTuple

from lta_config.errors import BadInput
from lta_data.importers.draft.bodies import choose_bag_body, choose_moving, read_tables
from lta_data.importers.draft.choices import BODY_AXES, DraftChoices
from lta_data.importers.draft.clock_alignment import build_timed_table, TimedTable
from lta_data.importers.draft.command_motion import ask_for_columns
from lta_data.importers.draft.motion_draft import draft_motion, MotionDraft
from lta_data.importers.draft.motion_kinds import MIN_MOTION_ROWS
from lta_data.importers.draft.scalar_draft import draft_scalars
from lta_data.importers.draft.table_draft import draft_inertial, draft_table, ROLE_TOPICS
from lta_data.importers.draft.time_base import TimeBase
from lta_data.importers.draft.vertical import CONFLICT, find_axes, VerticalAxes
from lta_data.importers.entry_plan import MESSAGE_SHAPES
from lta_data.importers.formats import LOG_FORMATS
from lta_data.importers.protocol import LogTable, Numbers
from lta_data.importers.readers.bag_tables import BODY_TYPES, CHILD_MARK, FURTHER
from lta_data.interpretation.column_group import ColumnGroup
from lta_data.interpretation.column_names import (
    ACTUATOR_WORDS,
    COMMAND_WORDS,
    JOYSTICKS,
    match_kind,
    match_role,
    parse_column_name,
    tells_uncertainty,
    TIME_WORDS,
)
from lta_data.interpretation.kinematics import AGREEING_SHARE, find_sensor_axes
import numpy as np

# Message type -> topic; a pose or odometry is truth, estimate or setpoint by its name
BY_TYPE: Final[Mapping[str, str]] = {
    'sensor_msgs/msg/Imu': 'imu',
    'sensor_msgs/msg/BatteryState': 'battery',
    'sensor_msgs/msg/Range': 'range',
    'sensor_msgs/msg/FluidPressure': 'pressure',
    'sensor_msgs/msg/Illuminance': 'illuminance',
    'geometry_msgs/msg/WrenchStamped': 'wrench_command',
    'geometry_msgs/msg/Wrench': 'wrench_command',
}
POSE_TYPES: Final = (
    'nav_msgs/msg/Odometry',
    'geometry_msgs/msg/PoseStamped',
    'geometry_msgs/msg/Pose',
    'geometry_msgs/msg/TransformStamped',
    'geometry_msgs/msg/PoseWithCovarianceStamped',
)
LOG_DATA_GENERIC: Final = 'crazyflie_interfaces/msg/LogDataGeneric'  # values without names
# Between stamp and log time; more is another clock, not a delay [s]
OTHER_CLOCK_DELAY: Final = 1.0
RISES: Final = 0.9  # share of the steps of a clock
ARRAY: Final = 'data['  # in the columns of an array
NO_STATES: Final = ('rcl_interfaces/', 'diagnostic_msgs/', 'rosgraph_msgs/')  # of a graph
SENSED_WORDS: Final = frozenset(
    ['vbat', 'battery', 'bat', 'pm', 'imu', 'range', 'status', 'state']
)
NO_NUMBERS: Final = ('header.', 'layout.')  # beginnings of columns that command nothing
POSE_KINDS: Final = {'position': 'position', 'orientation': 'attitude'}


@final
class BagDraft(NamedTuple):
    """The entries of a bag, and its tables of poses and commands."""

    entries: list[dict[str, Any]]
    groups: dict[str, list[ColumnGroup]]  # by topic of the bag
    tables: Mapping[str, LogTable]


def draft_bag_topics(path: Path, choices: DraftChoices) -> BagDraft:
    """
    Return the topics of a bag that become ours.

    Raise `BadInput` if no topic has a type that an import can convert.
    """
    log = LOG_FORMATS['bag'].opened(path, None)
    types = {name: topic.definition.type_name for name, topic in sorted(log.raw.items())}
    if not any(kind in POSE_TYPES for kind in types.values()):
        types |= choose_bag_body(path, log, types, f'{ROLE_TOPICS["truth"]}.table', choices)
    chosen = _choose_topics(path, types, choices)
    commands = [] if 'wrench_command' in chosen else _list_command_topics(types)
    poses = {ours: name for ours, name in chosen.items() if ours in ROLE_TOPICS.values()}
    if poses and not commands and 'wrench_command' not in chosen:
        commands = _ask_for_commands(types, choices)
    read = [name for ours, name in chosen.items() if ours in (*poses, 'wrench_command', 'imu')]
    tables, foreign = _replace_foreign_stamps(read_tables(path, [*read, *commands]), choices)
    entries, groups, tracked = [], dict[str, list[ColumnGroup]](), None
    inertial: dict[str, Any] = {}
    # ROS states metres and z up; a log shows where that is not so
    choices.settled.setdefault('position.unit', 'm')
    choices.settled.setdefault(CONFLICT, 'up')
    for ours, name in chosen.items():
        choices.add_reason(ours, [name], types[name], 'the message type and the name')
        entry = {'topic': ours, 'table': name}
        if ours in poses and name in tables:
            pose_groups = _group_pose(types[name], tables[name])
            groups[name] = [*pose_groups.values()]
            drafted, axes = _draft_pose(ours, pose_groups, tables[name], choices)
            entry |= _list_differences(drafted, axes)
            if tracked is None and ours != ROLE_TOPICS['setpoint']:
                inertial = _draft_inertial(
                    chosen.get('imu', ''), name, tables, drafted, axes, choices
                )
                first = float(tables[name].stamps[0]) * 1e-9
                seconds = _count_seconds(tables[name])
                tracked = build_timed_table(name, first, seconds, drafted, axes)
        entries.append(entry)
    for entry in entries:
        entry |= inertial if entry['topic'] == 'imu' else {}
    if not poses:
        entries += _draft_nameless(path, types, [*chosen.values(), *commands], choices)
    entries += _draft_commands({one: tables[one] for one in commands if one in tables},
                               tracked, choices)  # fmt: skip
    entries = [
        entry | ({'stamps': 'log'} if entry['table'] in foreign else {}) for entry in entries
    ]
    if not entries:
        raise BadInput(
            f"No topic of '{path}' becomes one of ours by its type and name; it has "
            f'{", ".join(sorted({*types.values()}))}. It can be imported as it is, without a '
            'mapping.'
        )
    return BagDraft(entries, groups, tables)


def _ask_for_commands(types: Mapping[str, str], choices: DraftChoices) -> list[str]:
    """Return the topic of values without names that the user says are commands, if any."""
    topics = [
        name for name, kind in types.items()
        if kind == LOG_DATA_GENERIC and not match_kind(words := parse_column_name(name).words)
        and not words & SENSED_WORDS
    ]  # fmt: skip
    if not topics:
        return []
    options = [('none', 'none of them'), *((name, 'its values are commands') for name in topics)]
    question = 'The names of values in a log block are not in the bag. Which are the commands?'
    chosen = choices.decide('commands.table', options, question)
    return [] if chosen == 'none' else [chosen]


def _draft_nameless(
    path: Path, types: Mapping[str, str], others: Sequence[str], choices: DraftChoices
) -> list[dict[str, Any]]:
    """Return the entries of topics whose types say nothing, by the names and motion of fields."""
    names = [
        name for name, kind in types.items()
        if name not in others and kind not in BODY_TYPES and not kind.startswith(NO_STATES)
        and not _is_uncertainty(name)
    ]  # fmt: skip
    drafts = []
    for name, table in read_tables(path, names).items():
        columns = {
            one: cells for one, cells in table.columns.items()
            if not one.startswith(NO_NUMBERS) and not _is_time(one, cells)
        }  # fmt: skip
        if columns and len(table) > 1:
            drafts.append(draft_table(name, columns, choices, TimeBase(_count_seconds(table), {})))
    entries: dict[str, dict[str, Any]] = {}
    # The topic with the most parts of a motion before the others
    for draft in sorted(drafts, key=lambda draft: -len(draft.groups)):
        for entry in draft.entries:
            # Rotors only where a topic is named after them
            if entry['topic'] not in (*entries, 'motors'):
                entries[entry['topic']] = _list_axes(draft.axes) | entry
    return [*entries.values()]


def _replace_foreign_stamps(
    tables: Mapping[str, LogTable], choices: DraftChoices
) -> tuple[Mapping[str, LogTable], set[str]]:
    """Return tables whose stamps are of one clock, and those that got the times of the log."""
    late = {
        name: float(np.median(one.log_times - one.stamps)) * 1e-9 for name, one in tables.items()
    }
    if not late or max(late.values()) - min(late.values()) < OTHER_CLOCK_DELAY:
        return tables, set()
    foreign = {name: seconds for name, seconds in late.items() if abs(seconds) > OTHER_CLOCK_DELAY}
    for name, seconds in foreign.items():
        side = 'before' if seconds > 0.0 else 'after'
        why = f'its stamps are {abs(seconds):.1f} s {side} the log, and those of others are not'
        choices.add_reason('times', [name], 'as logged', why)
    moved = {name: replace(tables[name], stamps=tables[name].log_times) for name in foreign}
    return {**tables, **moved}, {*foreign}


def count_changing_commands(path: Path) -> int:
    """Return the number of columns with more than one value in the topics of commands."""
    raw = LOG_FORMATS['bag'].opened(path, None).raw
    types = {name: topic.definition.type_name for name, topic in raw.items()}
    wrenches = [name for name, kind in types.items() if BY_TYPE.get(kind) == 'wrench_command']
    tables = read_tables(path, [*wrenches, *_list_command_topics(types)])
    return sum(_changes(column) for table in tables.values() for name, column in
               table.columns.items() if not name.startswith(NO_NUMBERS)
               and not _is_time(name, column))  # fmt: skip


def _choose_topics(path: Path, types: Mapping[str, str], choices: DraftChoices) -> dict[str, str]:
    """Return the topics whose types say what they are, by our topic."""
    candidates: dict[str, list[tuple[str, str]]] = {}
    for name, kind in types.items():
        words = parse_column_name(name).words
        if _is_uncertainty(name):
            continue
        if kind in POSE_TYPES or CHILD_MARK in name:
            # /optitrack/odom is no estimate
            role = match_role(words - {'odom'}) or match_role(words)
            ours = (
                ROLE_TOPICS[role]
                if role
                else ('odom' if 'Odometry' in kind else ROLE_TOPICS['truth'])
            )
            candidates.setdefault(ours, []).append((name, kind))
        elif kind in BY_TYPE:
            candidates.setdefault(BY_TYPE[kind], []).append((name, kind))
    chosen = {}
    for ours, fitting in candidates.items():
        table = fitting[0][0]
        question = f'Several topics of the bag can be {ours}.'
        if len(fitting) > 1 and ours in ROLE_TOPICS.values():
            table = choose_moving(path, dict(fitting), f'{ours}.table', question, choices)
        elif len(fitting) > 1:
            table = choices.decide(f'{ours}.table', fitting, question)
        chosen[ours] = choices.override(f'{ours}.table', table)
    return {ours: name for ours, name in chosen.items() if name in types}


def _is_uncertainty(topic: str) -> bool:
    """Return whether a topic says how well a quantity is known; a pose may come with it."""
    return tells_uncertainty(parse_column_name(topic).words - {'covariance', 'cov'})


def _list_command_topics(types: Mapping[str, str]) -> list[str]:
    """Return the topics of other types that are named after commands, actuators or a stick."""
    return [
        name
        for name, kind in types.items()
        if kind not in POSE_TYPES and kind not in BY_TYPE and kind not in BODY_TYPES
        and parse_column_name(name).words & (ACTUATOR_WORDS | COMMAND_WORDS | JOYSTICKS)
    ]  # fmt: skip


def _group_pose(kind: str, table: LogTable) -> dict[str, ColumnGroup]:
    """Return the parts of a pose or odometry message; a twist of zeros was never filled in."""
    groups = {}
    for name, part in (FURTHER.get(kind) or MESSAGE_SHAPES[kind]).items():
        letters = 'xyzw' if part.kind == 'attitude' else 'xyz'
        columns = tuple(f'{part.place}.{axis}' for axis in letters)
        values = [table.columns[one] for one in columns if one in table.columns]
        if any(np.any(one) for one in values) or (values and name in POSE_KINDS):
            group = 'quaternion' if part.kind == 'attitude' else name
            groups[POSE_KINDS.get(name, name)] = ColumnGroup(
                group, '', columns, tuple(letters), '', 'the message type'
            )
    return groups


def _draft_pose(
    ours: str, groups: Mapping[str, ColumnGroup], table: LogTable, choices: DraftChoices
) -> tuple[MotionDraft, VerticalAxes | None]:
    """Return units, directions and axes of a pose, by the physics of its numbers."""
    seconds = _count_seconds(table)
    numbers = {kind: group.stack(table.columns) for kind, group in groups.items()}
    drafted = draft_motion(ours, seconds, groups, numbers, choices)
    if drafted.turn is None and drafted.evidence.position is None:
        return drafted, None
    return drafted, find_axes(drafted.evidence, drafted.turn, '', choices)


def _draft_inertial(
    sensor: str,
    pose: str,
    tables: Mapping[str, LogTable],
    drafted: MotionDraft,
    axes: VerticalAxes | None,
    choices: DraftChoices,
) -> dict[str, Any]:
    """Return what an entry must say of an IMU whose rates are clearly those of a pose."""
    if sensor not in tables or drafted.turn is None or not len(tables[sensor]):
        return {}
    imu, stamps = tables[sensor], tables[pose].stamps[: len(drafted.turn)]
    members = _group_pose('sensor_msgs/msg/Imu', imu)
    attitude = members.pop('attitude', None)
    inside = (stamps >= imu.stamps[0]) & (stamps <= imu.stamps[-1])
    # The latest message of the sensor before each pose
    rows = np.searchsorted(imu.stamps, stamps, side='right').clip(1) - 1
    latest = {
        name: np.where(inside, values[rows], np.nan) for name, values in imu.columns.items()
        if name in {column for group in members.values() for column in group.columns}
    }  # fmt: skip
    seconds = drafted.evidence.seconds[: len(stamps)]
    if 'rates' not in members or inside.sum() < MIN_MOTION_ROWS:
        return {}
    _, fit = find_sensor_axes(members['rates'].stack(latest), drafted.turn, seconds)
    if fit.share < AGREEING_SHARE:
        return {}
    time = TimeBase(seconds, {})
    entry = draft_inertial(members, time, latest, drafted, axes, choices)
    usual = {'rates': 'rad/s', 'acceleration': 'm/s2'}
    differs = any({**entry[name], 'columns': 0} != {'columns': 0, 'unit': unit}
                  for name, unit in usual.items() if name in entry)  # fmt: skip
    # One orientation throughout is none
    differs |= attitude is not None and not np.ptp(attitude.stack(imu.columns), axis=0).any()
    body = {key: value for key, value in _list_axes(axes).items() if key == 'body'}
    return {key: value for key, value in (body | entry).items() if key == 'body' or differs}


def _count_seconds(table: LogTable) -> Numbers:
    """Return the stamps since the first [s]."""
    return np.asarray((table.stamps - table.stamps[0]) * 1e-9)


def _list_differences(drafted: MotionDraft, axes: VerticalAxes | None) -> dict[str, Any]:
    """Return what an entry must say of a pose that is not in m, ENU and FLU."""
    usual = {
        'position': {'unit': 'm'}, 'orientation': {'direction': 'body to world'},
        'velocity': {'unit': 'm/s'}, 'rates': {'unit': 'rad/s'},
    }  # fmt: skip
    fixed = ('columns', 'quaternion', 'order')
    differs = any(
        {key: value for key, value in part.items() if key not in fixed} != usual[name]
        for name, part in drafted.parts.items()
    )
    return (dict(drafted.parts) if differs else {}) | _list_axes(axes)


def _list_axes(axes: VerticalAxes | None) -> dict[str, Any]:
    """Return the axes of an entry, where they are not ours."""
    if axes is None:
        return {}
    ours = {'world': 'ENU', 'body': 'FLU'}
    return {key: getattr(axes, key) for key in ours if getattr(axes, key) != ours[key]}


def _is_time(name: str, values: Numbers) -> bool:
    """Return whether a number of a message is its clock."""
    rises = len(values) > 1 and bool(np.mean(np.diff(values) > 0.0) > RISES)
    return bool(parse_column_name(name).words & TIME_WORDS) and rises


def _changes(values: Numbers) -> bool:
    return bool(np.nanmin(values) < np.nanmax(values))


def _draft_commands(
    tables: Mapping[str, LogTable], tracked: TimedTable | None, choices: DraftChoices
) -> list[dict[str, Any]]:
    """Return the entry of the commands, of the one topic that the user or the names choose."""
    columns = {
        topic: {
            name: one
            for name, one in table.columns.items()
            if not _is_time(name, one)
            and not name.startswith(NO_NUMBERS)
            # A stick has axes that nobody moves; an array has none that nothing needs
            and (ARRAY in name or np.nan_to_num(one).any())
        }
        for topic, table in tables.items()
    }
    changing = [
        topic for topic, numbers in columns.items() if any(map(_changes, numbers.values()))
    ]
    if not changing:
        return []
    topic = changing[0]
    if len(changing) > 1:
        options = [(one, f'{len(columns[one])} numbers that change') for one in changing]
        question = 'Several topics of the bag can be the commands.'
        topic = choices.decide('commands.table', options, question)
    names = [parse_column_name(column) for column in columns[topic]]
    words = parse_column_name(topic).words
    names = ask_for_columns(topic, names, tables[topic], columns[topic], tracked, choices)
    # What the topic is called, its numbers are
    named = [
        one if one.stem[:1] and one.stem[0] in BODY_AXES
        else one._replace(stem=(*one.stem, 'motor', *words))
        for one in names
    ]  # fmt: skip
    seconds = _count_seconds(tables[topic])
    entries = draft_scalars(topic, columns[topic], named, seconds, choices)
    return [one for one in entries if one['topic'] in ('motors', 'wrench_command')][:1]
