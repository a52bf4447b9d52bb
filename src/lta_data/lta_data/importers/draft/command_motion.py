# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Find by the motion what commands drive: body axes or rotors, FLU or FRD axes, N or mN.

Only names that do not say it, or that the motion contradicts, are read by it.
"""

from collections.abc import Mapping, Sequence
from typing import Any, Final, final, NamedTuple

from lta_data.even_grid import build_uniform_time_grid
from lta_data.importers.draft.choices import BODY_AXES, DraftChoices
from lta_data.importers.draft.clock_alignment import (
    ALIGNED_STEP,
    AlignedClock,
    find_motion,
    find_rising,
    read_timed_tables,
    sum_residuals,
    TimedTable,
)
from lta_data.importers.draft.generic_commands import (
    ask_for_meanings,
    COMMAND_UNITS,
    WRENCH_UNIT_KEY,
)
from lta_data.importers.draft.table_draft import list_columns, TableDraft
from lta_data.importers.protocol import LogTable, Numbers
from lta_data.interpretation.column_group import Columns
from lta_data.interpretation.column_names import (
    ANGLE_WORDS,
    ColumnName,
    NUMBERED,
    parse_column_name,
    SERVOS,
)
from lta_data.interpretation.commands import DRIVES
import numpy as np

# A twist or a force in a message: linear.x is surge
MESSAGE_PARTS: Final = {
    f'{part}.{axis}': BODY_AXES[k + offset]
    for offset, parts in ((0, ('linear', 'force')), (3, ('angular', 'torque')))
    for part in parts
    for k, axis in enumerate('xyz')
}
STICK_RANGE: Final = 1.05  # a command that has both signs and stays below it is that of a stick
REACTION_DELAYS: Final = (0.0, 0.2, 0.4, 0.6)  # of a reaction, that are tried [s]
TELLING_SHARE: Final = 0.03  # share of an acceleration that is worth telling
MIN_MOTION_POINTS: Final = 100  # points of the grid
ACCELERATION_WORDS: Final = ('forward', 'up', 'yaw')


def ask_for_columns(
    topic: str,
    names: Sequence[ColumnName],
    table: LogTable,
    columns: Mapping[str, Numbers],
    tracked: TimedTable | None,
    choices: DraftChoices,
) -> list[ColumnName]:
    """
    Return the names of the numbers of a topic that command something, as far as they are known.

    An array says nothing of its numbers: they are asked for, if the vehicle is known or if they
    can be those of a stick.
    """
    parts = [_name_part(name) for name in names]
    nameless = [one for one in names if NUMBERED.fullmatch(one.column)]
    values = np.concatenate([columns[one.column] for one in nameless]) if nameless else np.zeros(1)
    stick = float(np.nanmin(values)) < 0.0 and float(np.nanmax(np.abs(values))) <= STICK_RANGE
    if nameless and (stick or choices.vehicle is not None):
        choices.follows = find_motion_of(table, columns, tracked)
        ask_for_meanings([one.column for one in nameless], f' of {topic}', choices)
    return [one for one in parts if choices.find_answer(f'{one.column}.command') != 'none']


def _name_part(name: ColumnName) -> ColumnName:
    """Return the name of a part of a twist or a force with its body axis."""
    end = '.'.join(name.column.split('.')[-2:])
    return name._replace(stem=(MESSAGE_PARTS[end],), axis='') if end in MESSAGE_PARTS else name


def find_motion_of(
    table: LogTable, columns: Mapping[str, Numbers], tracked: TimedTable | None
) -> dict[str, str]:
    """Return for each command the accelerations that it explains, as a sentence."""
    if tracked is None:
        return {}
    stamps: Numbers = np.asarray(table.stamps * 1e-9 - tracked.first, dtype=np.float64)
    values: Numbers = np.array([*columns.values()], dtype=np.float64).T
    effects = measure_effects(tracked, stamps, values)
    if effects is None:
        return {}
    return {name: describe_shares(row) for name, row in zip(columns, effects.shares, strict=True)}


@final
class CommandEffects(NamedTuple):
    """What commands do to the accelerations forward, up and yaw; shape (commands, 3) each."""

    shares: Numbers  # of the variance, that the command alone explains
    factors: Numbers  # acceleration by a number of the command [m/s2, rad/s2]


def measure_effects(
    tracked: TimedTable, stamps: Numbers, values: Numbers
) -> CommandEffects | None:
    """
    Return what commands do, at the delay at which they explain most; None for too few poses.

    The accelerations are regressed on all commands, the velocities and a constant.

    Parameters
    ----------
    tracked
        The poses.
    stamps, values : arrays, shapes (m,) and (m, k)
        Times since the first pose [s], and commands in any unit.

    """
    # A row without any command is that of another sensor
    seconds, rising = tracked.seconds, find_rising(stamps) & np.isfinite(values).any(axis=1)
    if tracked.position is None or tracked.turn is None or not rising.any():
        return None
    stamps, values = stamps[rising], np.nan_to_num(values[rising])
    first, last = max(np.nanmin(seconds), stamps[0]), min(np.nanmax(seconds), stamps[-1])
    grid = build_uniform_time_grid(first, last, ALIGNED_STEP, len(seconds))
    if len(grid) < MIN_MOTION_POINTS:
        return None
    speed, pull = find_motion(seconds, tracked.position, tracked.turn, grid)
    base = np.column_stack([speed, np.ones(len(grid))])
    best: CommandEffects | None = None
    for delay in REACTION_DELAYS:
        held = values[np.clip(np.searchsorted(stamps + delay, grid, side='right') - 1, 0, None)]
        shares = np.array([
            [lose_without(base, held, column, one[:, None]) for one in pull.T]
            for column in range(held.shape[1])
        ])  # fmt: skip
        if best is None or shares.sum() > best.shares.sum():
            fit = np.linalg.lstsq(np.column_stack([base, held]), pull, rcond=None)[0]
            best = CommandEffects(shares, fit[base.shape[1] :])
    return best


def lose_without(base: Numbers, held: Numbers, column: int, pull: Numbers) -> float:
    """Return the share of an acceleration's variance that a command explains and no other does."""
    alone = sum_residuals(base, pull)
    whole = sum_residuals(np.column_stack([base, held]), pull)
    others = sum_residuals(np.column_stack([base, np.delete(held, column, axis=1)]), pull)
    return (others - whole) / alone if alone > 0.0 else 0.0


def describe_shares(shares: Numbers) -> str:
    """Return a sentence on the accelerations that follow a command; '' if none does."""
    shares_text = [
        f'{100.0 * share:.0f} % of the {word} acceleration'
        for share, word in sorted(zip(shares, ACCELERATION_WORDS, strict=True), reverse=True)
        if share > TELLING_SHARE
    ]
    return f' It alone explains {" and ".join(shares_text)}.' if shares_text else ''


DRIVEN_AXES: Final = ('surge', 'heave', 'yaw')  # of the accelerations forward, up, yaw
# Share of an acceleration; a command that explains less does not decide
DECIDING_SHARE: Final = 0.1
ALONE: Final = 0.25  # of the largest share: what a command may explain of another acceleration
REACHED_CORRELATION: Final = 0.8  # correlation of a setpoint with what reaches it
REACHED_SIZES: Final = (
    0.5,
    2.0,
)  # of the spread of what reaches a setpoint over that of the setpoint
ARRIVALS: Final = (0.0, 0.5, 1.0, 2.0, 3.0)  # that a vehicle may take to reach it [s]


@final
class DrivenAxis(NamedTuple):
    """What the motion shows of a command."""

    axis: str  # 'surge', 'heave', 'yaw', 'rotor', or '' if it decides nothing
    text: str  # what the command explains, as a sentence; '' if nothing


def find_driven_axes(
    tables: Mapping[str, Columns],
    drafts: Mapping[str, TableDraft],
    clocks: Mapping[str, AlignedClock],
) -> dict[str, DrivenAxis]:
    """
    Return what the generic commands of all tables drive, by column.

    A command drives a body axis if it explains that acceleration, hardly another one, and no other
    command does. Numbered commands that explain the same acceleration are those of rotors.
    """
    timed = read_timed_tables(tables, drafts)
    pose = next((one for one in timed.values() if one.position is not None), None)
    driven: dict[str, DrivenAxis] = {}
    for name, draft in drafts.items():
        if not draft.generic or pose is None:
            continue
        others = [
            column for entry in draft.entries if entry['topic'] in DRIVES
            for column in list_columns(entry) if column not in draft.generic
        ]  # fmt: skip
        columns = [*draft.generic, *others]
        values = np.column_stack([tables[name][one] for one in columns]).astype(float)
        late = clocks[name].seconds if name in clocks else 0.0
        stamps = draft.time.seconds + draft.time.first - pose.first + late
        if (effects := measure_effects(pose, stamps, values)) is not None:
            shares = effects.shares
            axes = _choose_axes(shares, draft.generic)
            for k, column in enumerate(draft.generic):
                reached = axes[k] != 'rotor' and _is_reached(pose, stamps, values[:, k])
                axis = '' if reached or _contradicts(column, axes[k]) else axes[k]
                driven[column] = DrivenAxis(axis, describe_shares(shares[k]))
    return driven


def _choose_axes(shares: Numbers, generic: Sequence[str]) -> list[str]:
    """Return the axis of each generic command; shares have a row for each command."""
    stems = [parse_column_name(column).stem for column in generic]
    count = len(generic)
    mixed = {
        stems[i] for i in range(count) for j in range(i)
        if stems[i] == stems[j] and (np.minimum(shares[i], shares[j]) > DECIDING_SHARE).any()
    }  # fmt: skip
    axes = []
    for k, row in enumerate(shares[:count]):
        best = int(row.argmax())
        rivals = [*np.delete(row, best), *np.delete(shares[:, best], k)]
        is_clear = row[best] > max(DECIDING_SHARE, max(rivals) / ALONE)
        axes.append('rotor' if stems[k] in mixed else DRIVEN_AXES[best] if is_clear else '')
    return axes


def _contradicts(column: str, axis: str) -> bool:
    """Return whether a name says another axis than the motion, as cmd_yaw that lifts."""
    if parse_column_name(column).words & SERVOS:
        return True  # what it turns pushes
    named = {
        **dict.fromkeys(ANGLE_WORDS.values(), ''),
        'x': 'surge',
        'y': '',
        'z': 'heave',
        'yaw': 'yaw',
    }
    return bool(axis) and named.get(parse_column_name(column).axis, axis) != axis


def _is_reached(pose: TimedTable, stamps: Numbers, command: Numbers) -> bool:
    """Return whether a command is a place, heading or speed that the vehicle then reaches."""
    if pose.position is None or pose.turn is None:
        return False
    rows = find_rising(pose.seconds) & np.isfinite(pose.position).all(axis=1)
    seconds, position, turn = pose.seconds[rows], pose.position[rows], pose.turn[rows]
    heading = np.unwrap(turn.as_euler('ZYX')[:, 0])
    speed, _ = find_motion(seconds, position, turn, seconds)
    states = np.column_stack([position, heading, speed])
    for delay in ARRIVALS:
        for state in states.T:
            later = np.interp(stamps + delay, seconds, state)
            good = np.isfinite(command) & np.isfinite(later)
            sent, reached = command[good], later[good]
            if not np.ptp(sent) or not np.ptp(reached):
                continue
            near = abs(sent.mean() - reached.mean()) < max(sent.std(), reached.std())
            size = reached.std() / sent.std()
            alike = np.corrcoef(sent, reached)[0, 1] > REACHED_CORRELATION
            if near and alike and REACHED_SIZES[0] < size < REACHED_SIZES[1]:
                return True
    return False


def list_answers(driven: Mapping[str, DrivenAxis]) -> dict[str, str]:
    """Return what the motion decides, by the keys with which a user would decide it."""
    axes = {
        f'{column}.command': one.axis for column, one in driven.items() if one.axis in DRIVEN_AXES
    }
    rotors = {f'{column}.topic': 'motors' for column, one in driven.items() if one.axis == 'rotor'}
    return axes | rotors


FORWARD_AXIS: Final = 0  # of the accelerations forward, up, yaw
UP_AXIS: Final = 1  # of the accelerations forward, up, yaw
YAW: Final = 2
UNIT_SIZES: Final = {unit: COMMAND_UNITS[unit] for unit in ('N', 'mN')}
# Masses of the vehicles that fly in a room, with the air that moves along; a command whose force
# would accelerate another mass is in another unit [kg]
MASSES: Final = (0.01, 30.0)


def check_wrenches(
    tables: Mapping[str, Columns],
    drafts: Mapping[str, TableDraft],
    clocks: Mapping[str, AlignedClock],
    choices: DraftChoices,
) -> None:
    """
    Set `body` and the unit of a commanded wrench where the vehicle follows it otherwise.

    A force along z that lifts is along FLU axes, whatever the axes of the tracker. Nothing is set
    if heave and yaw contradict each other: a calibration finds the sign of each axis. A force by
    an acceleration is a mass, which says whether the numbers are N or mN.
    """
    timed = read_timed_tables(tables, drafts)
    pose = next((one for one in timed.values() if one.position is not None), None)
    axes = next((one.axes for one in drafts.values() if one.axes), None)
    if pose is None or axes is None:
        return
    usual = axes.body if axes.body in ('FLU', 'FRD') else 'FLU'
    for name, draft in drafts.items():
        for entry in draft.entries:
            if entry['topic'] != 'wrench_command':
                continue
            late = clocks[name].seconds if name in clocks else 0.0
            stamps = draft.time.seconds + draft.time.first - pose.first + late
            factors = _fit_accelerations(pose, stamps, entry, tables[name])
            _check_unit(entry, factors, choices)
            if 'body' in entry:
                continue
            signs = {float(np.sign(factors[axis])) for axis in (UP_AXIS, YAW) if axis in factors}
            body = {1.0: 'FLU', -1.0: 'FRD'}.get(next(iter(signs), 0.0))
            if len(signs) == 1 and body not in (None, usual):
                entry['body'] = body
                way = 'up or to the left' if body == 'FLU' else 'down or to the right'
                choices.add_reason('wrench_command: axes', list_columns(entry), str(body),
                                   f'the vehicle accelerates {way} with them')  # fmt: skip


def _check_unit(
    entry: dict[str, Any], factors: Mapping[int, float], choices: DraftChoices
) -> None:
    """Read forces as N or mN by the mass that they accelerate; ask if the names say otherwise."""
    forces = entry.get('forces') or [entry[key] for key in ('force',) if key in entry]
    size = _find_size(forces[0]) if forces else None
    pulls = [abs(factors[axis]) for axis in (FORWARD_AXIS, UP_AXIS) if axis in factors]
    if size not in UNIT_SIZES.values() or not pulls or WRENCH_UNIT_KEY in choices.answers:
        return
    # Per number in the log; the lighter axis has less air to move along
    named = {one: UNIT_SIZES[one] / max(pulls) for one in UNIT_SIZES}
    unit = next(one for one in UNIT_SIZES if UNIT_SIZES[one] == size)
    fitting = [one for one, mass in named.items() if MASSES[0] < mass < MASSES[1]]
    if unit in fitting or len(fitting) != 1:
        return
    other = fitting[0]
    why = (
        f'a force of 1 accelerates the vehicle by {max(pulls):.2g} m/s2: that is a mass of '
        f'{named[other]:.2g} kg if it is in {other}, and of {named[unit]:.2g} kg in {unit}'
    )
    options = [(other, f'{named[other]:.2g} kg'), (unit, f'{named[unit]:.2g} kg')]
    if any(parse_column_name(column).unit for column in list_columns(entry)):
        other = choices.decide(WRENCH_UNIT_KEY, options, f'The names say {unit}, but {why}.')
    for one in [*forces, *([entry['torque']] if 'torque' in entry else [])]:
        one.pop('scale', None)
        one['unit'] = other + ' m' * one['unit'].endswith(' m')
    choices.add_reason('wrench_command: unit', list_columns(entry), other, why)


def _find_size(vector: Mapping[str, Any]) -> float | None:
    """Return the size of a number of a force [N]; None if it differs between axes."""
    scale = vector.get('scale', 1.0)
    return None if isinstance(scale, list) else COMMAND_UNITS[vector['unit']] * scale


def _fit_accelerations(
    pose: TimedTable, stamps: Numbers, entry: Mapping[str, Any], table: Columns
) -> dict[int, float]:
    """
    Return by how much a number of force ahead, force up and moment in yaw accelerates, by axis.

    Only of the commands that clearly explain the acceleration. [m/s2, rad/s2]
    """
    columns = list_columns(entry)
    values = np.column_stack([table[one] for one in columns]).astype(float)
    effects = measure_effects(pose, stamps, values)
    if effects is None:
        return {}
    forces = entry.get('forces') or [entry.get('force', {})]
    out = {}
    for vectors, place, axis in (
        (forces, 0, FORWARD_AXIS), (forces, 2, UP_AXIS), ([entry.get('torque', {})], 2, YAW)
    ):  # fmt: skip
        named = [one['columns'][place] for one in vectors if one.get('columns')]
        column = next((one for one in named if one is not None), None)
        if column is None:
            continue
        k = columns.index(column)
        if effects.shares[k, axis] > DECIDING_SHARE:
            out[axis] = float(effects.factors[k, axis])
    return out
