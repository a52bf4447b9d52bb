"""Draft the topics of a bag: poses by type and physics, commands by name and by the user."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, Final, final, NamedTuple

from lta_config.errors import BadInput, unknown_name_error
from lta_config.schema.import_file import FIELD_AXES, ImportMapping
from lta_data.importers.axes import signed_permutation
from lta_data.importers.draft.array_commands import ask_for_columns
from lta_data.importers.draft.bodies import STILL
from lta_data.importers.draft.choices import DraftChoices
from lta_data.importers.draft.clock_alignment import TimedTable
from lta_data.importers.draft.column_groups import ColumnGroup
from lta_data.importers.draft.draft_vehicle import BODY_AXES
from lta_data.importers.draft.motion_draft import draft_motion, MotionDraft
from lta_data.importers.draft.name_hints import (
    ACTUATORS,
    COMMANDS,
    JOYSTICKS,
    match_role,
    parse_column_name,
    TIMES,
)
from lta_data.importers.draft.scalar_draft import draft_scalars
from lta_data.importers.draft.vertical import CONFLICT, find_axes, VerticalAxes
from lta_data.importers.formats import FORMATS
from lta_data.importers.log_table import LogTable, Numbers
from lta_data.importers.message_parts import SHAPES
from lta_data.importers.protocol import LogReader
from lta_data.importers.readers.bag_tables import BagTableLog, BODIES, CHILD, FURTHER
import numpy as np
from scipy.spatial.transform import Rotation

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
POSES: Final = (
    'nav_msgs/msg/Odometry',
    'geometry_msgs/msg/PoseStamped',
    'geometry_msgs/msg/Pose',
    'geometry_msgs/msg/TransformStamped',
    'geometry_msgs/msg/PoseWithCovarianceStamped',
)
ROLES: Final = {'truth': 'ground_truth/odom', 'estimate': 'odom', 'setpoint': 'setpoint/pose'}
CLOCK: Final = 1.0  # between stamp and log time; more is another clock, not a delay [s]
RISES: Final = 0.9  # share of the steps of a clock
ARRAY: Final = 'data['  # in the columns of an array
NO_NUMBERS: Final = ('header.', 'layout.')  # beginnings of columns that command nothing
KINDS: Final = {'position': 'position', 'orientation': 'attitude'}


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
    log = FORMATS['bag'].opened(path, None)
    types = {name: topic.definition.type_name for name, topic in sorted(log.raw.items())}
    if not any(kind in POSES for kind in types.values()):
        types |= _choose_body(path, log, types, choices)
    chosen = _choose_topics(types, choices)
    commands = [] if 'wrench_command' in chosen else _list_command_topics(types)
    poses = {ours: name for ours, name in chosen.items() if ours in ROLES.values()}
    read = [name for ours, name in chosen.items() if ours in (*poses, 'wrench_command')]
    tables, foreign = _replace_foreign_stamps(_read_tables(path, [*read, *commands]), choices)
    entries, groups, tracked = [], dict[str, list[ColumnGroup]](), None
    # ROS states metres and z up; a log shows where that is not so
    choices.settled.setdefault('position.unit', 'm')
    choices.settled.setdefault(CONFLICT, 'up')
    for ours, name in chosen.items():
        choices.add_reason(ours, [name], types[name], 'the message type and the name')
        entry = {'topic': ours, 'table': name}
        if ours in poses and name in tables:
            pose_groups = _group_pose(types[name], tables[name])
            if 'attitude' not in pose_groups:
                why = 'all its quaternions are NaN: the attitude was never measured'
                choices.add_reason(f'{ours}: orientation', [name], 'left out', why)
            groups[name] = [*pose_groups.values()]
            drafted, axes = _draft_pose(ours, pose_groups, tables[name], choices)
            entry |= _list_differences(drafted, axes)
            if tracked is None and ours != ROLES['setpoint']:
                tracked = _place_in_our_axes(name, tables[name], drafted, axes)
        entries.append(entry)
    entries += _draft_commands({one: tables[one] for one in commands if one in tables},
                               tracked, choices)  # fmt: skip
    entries = [
        entry | ({'stamps': 'log'} if entry['table'] in foreign else {}) for entry in entries
    ]
    if not entries:
        raise BadInput(
            f"No topic of '{path}' has a type that becomes one of ours; it has "
            f'{", ".join(sorted({*types.values()}))}. It can be imported as it is, without a '
            'mapping.'
        )
    return BagDraft(entries, groups, tables)


def _choose_body(
    path: Path, log: LogReader, types: Mapping[str, str], choices: DraftChoices
) -> dict[str, str]:
    """Return the table of the vehicle in a topic of several bodies, such as /tf, and its type."""
    assert isinstance(log, BagTableLog)
    tables = {
        name: kind
        for topic, kind in types.items()
        if kind in BODIES and not topic.endswith('_static')
        for name in log.list_bodies(topic)
    }
    if not tables:
        return {}
    extents = {}
    for name, table in _read_tables(path, [*tables]).items():
        place = [f'{FURTHER[tables[name]]["position"].place}.{axis}' for axis in 'xyz']
        rows = np.stack([table.columns[one] for one in place], axis=1)
        low, high = np.nanpercentile(rows, [2.0, 98.0], axis=0)
        extents[name] = float(np.max(high - low))
    names = sorted(extents, key=lambda name: -extents[name])
    options = [(name, f'moves over {extents[name]:.3g}') for name in names]
    key = f'{ROLES["truth"]}.table'
    others = [name for name in names[1:] if extents[name] > STILL * extents[names[0]]]
    if others and key not in choices.answers:
        chosen = choices.decide(key, options, 'The bag has the poses of several bodies.')
    else:
        chosen = choices.override(key, names[0])
        listed = ', '.join(f'{name} ({words})' for name, words in options)
        choices.add_reason('body', [chosen], chosen, f'of {listed}')
    if chosen not in tables:
        raise unknown_name_error(f'answer to {key}', chosen, names)
    return {chosen: tables[chosen]}


def _replace_foreign_stamps(
    tables: Mapping[str, LogTable], choices: DraftChoices
) -> tuple[Mapping[str, LogTable], set[str]]:
    """Return tables whose stamps are of one clock, and those that got the times of the log."""
    late = {
        name: float(np.median(one.log_times - one.stamps)) * 1e-9 for name, one in tables.items()
    }
    if not late or max(late.values()) - min(late.values()) < CLOCK:
        return tables, set()
    foreign = {name: seconds for name, seconds in late.items() if abs(seconds) > CLOCK}
    for name, seconds in foreign.items():
        side = 'before' if seconds > 0.0 else 'after'
        why = f'its stamps are {abs(seconds):.1f} s {side} the log, and those of others are not'
        choices.add_reason('times', [name], 'as logged', why)
    moved = {name: replace(tables[name], stamps=tables[name].log_times) for name in foreign}
    return {**tables, **moved}, {*foreign}


def count_changing_commands(path: Path) -> int:
    """Return the number of columns with more than one value in the topics of commands."""
    raw = FORMATS['bag'].opened(path, None).raw
    types = {name: topic.definition.type_name for name, topic in raw.items()}
    wrenches = [name for name, kind in types.items() if BY_TYPE.get(kind) == 'wrench_command']
    tables = _read_tables(path, [*wrenches, *_list_command_topics(types)])
    return sum(_changes(column) for table in tables.values() for name, column in
               table.columns.items() if not name.startswith(NO_NUMBERS)
               and not _is_time(name, column))  # fmt: skip


def _choose_topics(types: Mapping[str, str], choices: DraftChoices) -> dict[str, str]:
    """Return the topics whose types say what they are, by our topic."""
    candidates: dict[str, list[tuple[str, str]]] = {}
    for name, kind in types.items():
        if kind in POSES or CHILD in name:
            words = parse_column_name(name).words
            # /optitrack/odom is no estimate
            role = match_role(words - {'odom'}) or match_role(words)
            ours = ROLES[role] if role else ('odom' if 'Odometry' in kind else ROLES['truth'])
            candidates.setdefault(ours, []).append((name, kind))
        elif kind in BY_TYPE:
            candidates.setdefault(BY_TYPE[kind], []).append((name, kind))
    chosen = {}
    for ours, fitting in candidates.items():
        table = fitting[0][0]
        if len(fitting) > 1:
            question = f'Several topics of the bag can be {ours}.'
            table = choices.decide(f'{ours}.table', fitting, question)
        chosen[ours] = choices.override(f'{ours}.table', table)
    return {ours: name for ours, name in chosen.items() if name in types}


def _list_command_topics(types: Mapping[str, str]) -> list[str]:
    """Return the topics of other types that are named after commands, actuators or a stick."""
    return [
        name
        for name, kind in types.items()
        if kind not in POSES and kind not in BY_TYPE and kind not in BODIES
        and parse_column_name(name).words & (ACTUATORS | COMMANDS | JOYSTICKS)
    ]  # fmt: skip


def _read_tables(path: Path, names: Sequence[str]) -> Mapping[str, LogTable]:
    """Return topics as tables, with a column for each number; those without a message lack."""
    if not names:
        return {}
    number = {'effort': {'column': '-'}}
    topics = [{'topic': 'motors', 'table': one, 'actuators': {'any': number}} for one in names]
    head = {'schema': 1, 'name': 'draft', 'about': 'A draft.', 'format': 'bag', 'data': 'measured'}
    log = FORMATS['bag'].opened(path, ImportMapping.model_validate({**head, 'topics': topics}))
    there = {name: set[str]() for name in names if name in log.columns}
    return next(iter(log.iterate_tables(there, lambda _: None)))


def _group_pose(kind: str, table: LogTable) -> dict[str, ColumnGroup]:
    """Return the parts of a pose or odometry message; a twist of zeros was never filled in."""
    groups = {}
    for name, part in (FURTHER.get(kind) or SHAPES[kind]).items():
        letters = 'xyzw' if part.kind == 'attitude' else 'xyz'
        columns = tuple(f'{part.place}.{axis}' for axis in letters)
        values = [table.columns[one] for one in columns if one in table.columns]
        filled = any(np.any(one) for one in values)
        # A tracker that knows no attitude sends NaN
        if any(np.isfinite(one).any() for one in values) and (filled or name in KINDS):
            group = 'quaternion' if part.kind == 'attitude' else name
            groups[KINDS.get(name, name)] = ColumnGroup(
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


def _count_seconds(table: LogTable) -> Numbers:
    """Return the stamps since the first. [s]"""
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
    differences = dict(drafted.parts) if differs else {}
    if axes is not None and axes.world != 'ENU':
        differences['world'] = axes.world
    if axes is not None and axes.body != 'FLU':
        differences['body'] = axes.body
    return differences


def _place_in_our_axes(
    name: str, table: LogTable, drafted: MotionDraft, axes: VerticalAxes | None
) -> TimedTable | None:
    """Return the poses in our axes; None without place or attitude."""
    place, turn = drafted.evidence.position, drafted.turn
    if place is None or turn is None or axes is None:
        return None
    world, body = (
        signed_permutation(FIELD_AXES[one] if isinstance(one, str) else one)
        for one in (axes.world, axes.body)
    )
    count = min(len(place), len(turn))
    ours = Rotation.from_matrix(world @ turn.as_matrix()[:count] @ body.T)
    seconds = _count_seconds(table)[:count]
    return TimedTable(name, float(table.stamps[0]) * 1e-9, seconds, None, place[:count] @ world.T,
                      ours)  # fmt: skip


def _is_time(name: str, values: Numbers) -> bool:
    """Return whether a number of a message is its clock."""
    rises = len(values) > 1 and bool(np.mean(np.diff(values) > 0.0) > RISES)
    return bool(parse_column_name(name).words & TIMES) and rises


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
    entries = draft_scalars(topic, columns[topic], named, choices)
    return [one for one in entries if one['topic'] in ('motors', 'wrench_command')][:1]
