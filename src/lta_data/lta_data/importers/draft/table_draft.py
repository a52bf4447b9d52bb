# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Draft the topics of one table: which group is state, estimate, command or sensor."""

from collections.abc import Mapping, Sequence
import re
from typing import Any, Final, final, NamedTuple

from lta_data.importers.draft.bodies import choose_body
from lta_data.importers.draft.choices import DraftChoices
from lta_data.importers.draft.column_groups import group_columns
from lta_data.importers.draft.generic_commands import (
    ask_for_meanings,
    explain_lacking,
    LINEAR,
    list_generic_commands,
)
from lta_data.importers.draft.motion_draft import draft_motion, MotionDraft
from lta_data.importers.draft.motion_kinds import find_state_vectors, settle_kinds
from lta_data.importers.draft.scalar_draft import draft_scalars
from lta_data.importers.draft.time_base import find_time_base, find_time_column, TimeBase
from lta_data.importers.draft.vertical import find_axes, name_axes, spread_axes, VerticalAxes
from lta_data.importers.protocol import Numbers
from lta_data.interpretation.column_group import ATTITUDES, ColumnGroup, Columns, measure_length
from lta_data.interpretation.column_names import match_role, parse_column_name, UNIT_WORDS
from lta_data.interpretation.commands import is_held
from lta_data.interpretation.kinematics import find_sensor_axes, MotionEvidence, SENSOR_AXES
import numpy as np
import pandas as pd

ROLE_TOPICS: Final = {
    'truth': 'ground_truth/odom',
    'estimate': 'odom',
    'setpoint': 'setpoint/pose',
}
WRENCH_UNITS: Final = {'force': 'N', 'torque': 'N m'}
INERTIAL_WORDS: Final = frozenset(
    ['imu', 'gyro', 'gyr', 'gyros', 'gyroscope', 'g', 'acc', 'accel', 'accelerometer']
)
# Topics whose axes PX4 fixes; a program that exports them writes the name of the log before them
PX4_POSES: Final = re.compile(r'(.*_)?vehicle_(local_position|odometry)(_\d+)?')
FRESH_PERIODS: Final = 5.0  # age of an attitude that still is that of a place
FRESH_SHARE: Final = 0.95  # of the rows of two tables on one clock, at least
SHARED_ROWS: Final = 0.1  # share of the rows of a sensor with a pose; fewer are coincidence
MOTION_PARTS: Final = frozenset(['position', 'attitude', 'velocity'])
Groups = dict[str, ColumnGroup]


@final
class TableDraft(NamedTuple):
    """The entries of a table, its time, and the axes that its motion shows."""

    entries: list[dict[str, Any]]
    time: TimeBase
    axes: VerticalAxes | None
    groups: list[ColumnGroup]
    unused: list[str]
    generic: list[str]  # commands whose names do not say what they drive
    motion: MotionDraft | None  # of the first topic with a pose or a velocity


def draft_table(
    name: str, table: Columns, choices: DraftChoices, time: TimeBase | None = None
) -> TableDraft:
    """
    Return the topics that a table fills.

    `name`: '' for a single table. `time`: of the rows, where no column has it.
    """
    numbers: Columns = {
        column: cells for column, cells in table.items() if cells.dtype.kind in 'fiub'
    }
    answers = {column: choices.find_answer(f'{column}.command') for column in numbers}
    generic = list_generic_commands([parse_column_name(one) for one in numbers])
    # Of a1, a2, a3, the numbers tell an acceleration from what a controller puts out
    sensed = group_columns({column: numbers[column] for column in generic})[0]
    felt = [column for one in sensed if one.kind == 'acceleration' for column in one.columns]
    generic = [column for column in generic if column not in felt]
    decided = [column for column in numbers if answers[column] or column in generic]
    groups, singles = group_columns(
        {one: numbers[one] for one in numbers if one not in decided},
        has_linear=any(answer in LINEAR for answer in answers.values()),
    )
    open_ = ask_for_meanings(generic, '', choices)
    singles += [parse_column_name(column) for column in decided if column not in open_]
    time = time or find_time_base(name, table, groups, choices)
    if name:
        # The file of a sensor often says what it is
        whole = parse_column_name(name.replace('/', '_') + '_columns')
        singles = [single._replace(stem=(*whole.stem, *single.stem)) for single in singles
                   if single.stem] if len(table) > 2 else singles  # fmt: skip
    numbers, at = _join_rows(groups, numbers, time)
    grouped = {column for group in groups for column in group.columns}
    times = [time.entry.get(key) for key in ('column', 'fraction')]
    arrays = [column for column in numbers if column not in (*grouped, *times)]
    groups += find_state_vectors(arrays, numbers, at.seconds)
    candidates = groups
    groups = choose_body(settle_kinds(groups, numbers, at.seconds), numbers, choices)
    lost = {c for one in candidates for c in one.columns if not one.kind} - {
        c for one in groups for c in one.columns
    }
    singles += [parse_column_name(column) for column in lost]
    topics = _sort_groups(name, groups, numbers, choices)
    entries: list[dict[str, Any]] = []
    axes = None
    inertial = topics.pop('imu', {})
    primary: MotionDraft | None = None
    for topic, members in sorted(topics.items(), key=lambda one: one[0] != ROLE_TOPICS['truth']):
        if topic == 'wrench_command':
            entries.append(_draft_wrench(topic, members, choices))
            continue
        borrowed = dict(inertial) if topic != ROLE_TOPICS['setpoint'] and primary is None else {}
        if (rates := borrowed.pop('rates', None)) is not None:
            borrowed['sensed'] = rates
        drafted = _draft_topic(topic, members | borrowed, at, numbers, choices)
        if topic != ROLE_TOPICS['setpoint'] and primary is None:
            primary = drafted
            if drafted.turn is not None or drafted.evidence.position is not None:
                convention = 'px4' if PX4_POSES.fullmatch(name) else drafted.axis_names
                axes = find_axes(drafted.evidence, drafted.turn, convention, choices)
        parts = {k: v for k, v in drafted.parts.items() if k != 'acceleration'}
        if parts:
            entries.append({'topic': topic} | parts)
    if inertial:
        sensor = draft_inertial(inertial, at, numbers, primary, axes, choices)
        entries += [sensor] if len(sensor) > 1 else []
        axes = axes or _inertial_axes(inertial, at, numbers, choices)
    entries = [entry | ({'table': name} if name else {}) for entry in entries]
    taken = [column for group in groups for column in group.columns]
    rest = [single for single in singles if single.column not in (*times, *taken)]
    entries += draft_scalars(name, table, rest, time.seconds, choices)
    used = {column for entry in entries for column in list_columns(entry)}
    unused = [c for c in table if c not in used and c not in times]
    return TableDraft(entries, time, axes, groups, unused, generic, primary)


def _join_rows(
    groups: Sequence[ColumnGroup], numbers: Columns, time: TimeBase
) -> tuple[Columns, TimeBase]:
    """
    Return the rows with a pose, with the latest numbers of other sensors, and their times.

    All rows, unless other sensors have rows of their own, as topics of a bag do in one table.
    """
    filled = {
        kind: np.isfinite(one.stack(numbers)).all(axis=1)
        for one in groups for kind in [one.kind] if len(one.columns) > 1
    }  # fmt: skip
    filled = {kind: rows for kind, rows in filled.items() if rows.any()}
    pose = next((filled[kind] for kind in (*ATTITUDES, 'position') if kind in filled), None)
    if pose is None or all(
        (rows & pose).sum() > SHARED_ROWS * rows.sum() for rows in filled.values()
    ):
        return numbers, time
    table = pd.DataFrame(dict(numbers)).ffill()[pose]
    joined = {column: table[column].to_numpy() for column in table}
    return joined, time._replace(seconds=time.seconds[pose])


def join_pose_tables(
    tables: Mapping[str, dict[str, Any]],
) -> tuple[dict[str, dict[str, Any]], dict[str, str]]:
    """
    Return tables in which that of the places also has the attitudes, if another table has them.

    Only if both have one clock: nearly every row of one has a row of the other shortly before it.
    Each row gets the latest attitude before it, in columns 'other.column'; the second result has
    the name of that other table by the name of the first. Exports of PX4 have such tables.
    """
    groups: dict[str, list[ColumnGroup]] = {}
    for name, table in tables.items():
        numbers = {one: cells for one, cells in table.items() if cells.dtype.kind in 'fiub'}
        groups[name] = [one for one in group_columns(numbers)[0] if one.role != 'setpoint']
    placed, turned = (
        [name for name, some in groups.items() if any(one.kind in kinds for one in some)]
        for kinds in (('position',), ATTITUDES)
    )
    if len(placed) != 1 or len(turned) != 1 or placed == turned:
        return {**tables}, {}
    name, other = placed[0], turned[0]
    # Rates and gravity tell how to read an attitude, and stay beside it
    if any(one.kind in ('rates', 'acceleration') for one in groups[other]):
        return {**tables}, {}
    clocks = [find_time_column(tables[one], groups[one]) for one in (name, other)]
    columns = [c for one in groups[other] if one.kind in ATTITUDES for c in one.columns]
    if (
        not clocks[0]
        or clocks[0] != clocks[1]
        or any(tables[one][clocks[0]].dtype.kind not in 'fiu' for one in (name, other))
    ):
        return {**tables}, {}
    times, theirs = (tables[one][clocks[0]] for one in (name, other))
    if not (_has_fresh_rows(times, theirs) and _has_fresh_rows(theirs, times)):
        return {**tables}, {}
    rows = np.searchsorted(theirs, times, side='right') - 1
    attitudes = {
        f'{other}.{c}': np.where(rows >= 0, tables[other][c][rows], np.nan) for c in columns
    }
    rest = {c: cells for c, cells in tables[other].items() if c not in columns}
    return {**tables, name: tables[name] | attitudes, other: rest}, {name: other}


def _has_fresh_rows(times: Numbers, others: Numbers) -> bool:
    """
    Return whether the rows of another table are recent at nearly all times.

    The times of the other table have to rise.
    """
    steps = np.diff(others)
    if not len(steps) or not (steps > 0).all():
        return False
    ages = times - others[np.maximum(np.searchsorted(others, times, side='right') - 1, 0)]
    fresh = (ages >= 0) & (ages <= FRESH_PERIODS * np.median(steps))
    return bool(np.mean(fresh) >= FRESH_SHARE)


def _sort_groups(
    name: str, groups: list[ColumnGroup], table: Columns, choices: DraftChoices
) -> dict[str, Groups]:
    """Return the groups by topic and kind."""
    topics: dict[str, Groups] = {}
    words = parse_column_name(name).words if name else frozenset[str]()
    nameless_role = _role_of_nameless(groups)
    for group in groups:
        kind = _part_of(group)
        if kind in ('force', 'torque'):
            topic = 'wrench_command'
        elif kind == 'acceleration' or (
            kind == 'rates' and (group.words | words) & INERTIAL_WORDS
        ):
            topic = 'imu'
        else:
            role = group.role or match_role(words)
            role = role or _role_by_motion(group, topics, table, nameless_role)
            topic = choices.override(f'{group.columns[0]}.topic', ROLE_TOPICS[role])
            if role == 'setpoint' and kind in ('velocity', 'rates'):
                topic = 'setpoint/velocity'
        members = topics.setdefault(topic, {})
        # Of an attitude in several forms, the one with the least to guess
        if kind not in members or (
            kind == 'attitude'
            and ATTITUDES.index(group.kind) < ATTITUDES.index(members[kind].kind)
        ):
            members[kind] = group
            why = group.reason + _describe_length(group, table)
            reading = group.kind
            if topic == 'wrench_command':
                named = UNIT_WORDS.get(group.unit, (f'{WRENCH_UNITS[kind]} (assumed)',))[0]
                reading = choices.override(f'{topic}.{kind}.unit', named)
                lacking = [axis for axis in 'xyz' if axis not in group.axes]
                # Of a vector, the components have numbers
                why += explain_lacking(lacking) if len(lacking) < len('xyz') else ''
            choices.add_reason(f'{topic}: {kind}', group.columns, reading, why)
    return topics


def _part_of(group: ColumnGroup) -> str:
    """Return the part of a message that a group is."""
    return 'attitude' if group.kind in ATTITUDES else group.kind


def _role_of_nameless(groups: Sequence[ColumnGroup]) -> str:
    """
    Return whether groups without a role in their names are those of the tracker or of an estimate.

    They belong to the one source whose names say what it is, and which lacks just these parts.
    """
    parts = {
        role: {_part_of(one) for one in groups if one.role == role and one.kind}
        for role in ('', 'truth', 'estimate')
    }
    fits = (
        bool(parts['estimate'] & MOTION_PARTS) and not parts['estimate'] & parts[''] & MOTION_PARTS
    )
    return 'estimate' if fits and not parts['truth'] else 'truth'


def _describe_length(group: ColumnGroup, table: Columns) -> str:
    """Return what a reason adds on a quaternion that has not length one."""
    if group.kind != 'quaternion':
        return ''
    length = measure_length(group.stack(table))
    return '' if length == 1.0 else f'; they have the length {length:g}, and are divided by it'


def _role_by_motion(
    group: ColumnGroup, topics: Mapping[str, Groups], table: Columns, usual: str
) -> str:
    """Return the role of a group whose names do not say it."""
    members, part = topics.get(ROLE_TOPICS[usual], {}), _part_of(group)
    # An attitude in another form is the same one
    if part not in members or (part == 'attitude' and members[part].kind != group.kind):
        return usual
    return 'setpoint' if is_held(group.stack(table)) else 'estimate'


def _draft_topic(
    topic: str, members: Groups, time: TimeBase, table: Columns, choices: DraftChoices
) -> MotionDraft:
    """Return the parts of an odometry or setpoint topic."""
    numbers = {kind: group.stack(table) for kind, group in members.items()}
    return draft_motion(topic, time.seconds, members, numbers, choices)


def draft_inertial(
    members: Groups,
    time: TimeBase,
    table: Columns,
    primary: MotionDraft | None,
    axes: VerticalAxes | None,
    choices: DraftChoices,
) -> dict[str, Any]:
    """Return the entry of an IMU; its body axes may differ from those of the tracker."""
    numbers = {kind: group.stack(table) for kind, group in members.items()}
    alone = {kind: group for kind, group in members.items() if kind in ('rates', 'acceleration')}
    turn = None if primary is None else primary.turn
    entry: dict[str, Any] = {'topic': 'imu'}
    if turn is None or 'rates' not in alone:
        drafted = draft_motion('imu', time.seconds, alone, numbers, choices)
        return entry | drafted.parts
    turned, fit = find_sensor_axes(numbers['rates'], turn, time.seconds)
    if turned is not SENSOR_AXES[0]:
        entry['body'] = name_axes(spread_axes('FLU' if axes is None else axes.body) @ turned)
        choices.add_reason('imu: axes', alone['rates'].columns, str(entry['body']),
                           'in these axes, the rates are the derivative of the attitude by '
                           f'{100 * fit.share:.0f} %')  # fmt: skip
        numbers = {kind: values @ turned.T for kind, values in numbers.items()}
    return entry | draft_motion('imu', time.seconds, alone, numbers, choices, turn).parts


def _inertial_axes(
    members: Groups, time: TimeBase, table: Columns, choices: DraftChoices
) -> VerticalAxes | None:
    """Return the body axes of an IMU alone, by gravity."""
    if 'acceleration' not in members:
        return None
    values: Numbers = members['acceleration'].stack(table)
    evidence = MotionEvidence(time.seconds, None, None, None, values)
    return find_axes(evidence, None, '', choices)


def _draft_wrench(topic: str, members: Groups, choices: DraftChoices) -> dict[str, Any]:
    """Return the entry of commanded force and torque."""
    entry: dict[str, Any] = {'topic': topic}
    for kind, group in members.items():
        named = UNIT_WORDS.get(group.unit, (WRENCH_UNITS[kind],))[0]
        unit = choices.override(f'{topic}.{kind}.unit', named)
        by_axis = dict(zip(group.axes, group.columns, strict=True))
        # A component that the log lacks is null, and zero in the bag
        partial = not {*group.axes} - {*'xyz'}
        columns = [by_axis.get(axis) for axis in 'xyz'] if partial else list(group.columns)
        entry[kind] = {'columns': columns, 'unit': unit}
    return entry


def list_columns(part: Any) -> list[str]:
    """Return all columns that an entry names."""
    if isinstance(part, dict):
        return [
            column
            for key, value in part.items()
            if key != 'topic'
            for column in ([value] if key == 'column' else list_columns(value))
        ]
    if isinstance(part, list):
        inside = [column for one in part if isinstance(one, dict) for column in list_columns(one)]
        return [one for one in part if isinstance(one, str)] + inside
    return []
