"""Find by the motion what commands drive whose names do not say it: body axes or rotors."""

from collections.abc import Mapping, Sequence
from typing import Final, final, NamedTuple

from lta_data.importers.draft.array_commands import describe_shares, LEAST, measure_shares
from lta_data.importers.draft.clock_alignment import (
    AlignedClock,
    COMMANDS,
    find_motion,
    find_rising,
    read_timed_tables,
    STEP,
    TimedTable,
)
from lta_data.importers.draft.column_groups import Columns
from lta_data.importers.draft.name_hints import ANGLES, parse_column_name, SERVOS
from lta_data.importers.draft.table_draft import list_columns, TableDraft
from lta_data.importers.log_table import Numbers
import numpy as np

AXES: Final = ('surge', 'heave', 'yaw')  # of the accelerations forward, up, yaw
CLEAR: Final = 0.1  # share of an acceleration; a command that explains less does not decide
ALONE: Final = 0.25  # of the largest share: what a command may explain of another acceleration
REACHED: Final = 0.8  # correlation of a setpoint with what reaches it
SIZES: Final = (0.5, 2.0)  # of the spread of what reaches a setpoint over that of the setpoint
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
            column for entry in draft.entries if entry['topic'] in COMMANDS
            for column in list_columns(entry) if column not in draft.generic
        ]  # fmt: skip
        columns = [*draft.generic, *others]
        values = np.column_stack([tables[name][one] for one in columns]).astype(float)
        late = clocks[name].seconds if name in clocks else 0.0
        stamps = draft.time.seconds + draft.time.first - pose.first + late
        shares = _measure_overlapping(pose, stamps, values)
        if shares is not None:
            axes = _choose_axes(shares, draft.generic)
            for k, column in enumerate(draft.generic):
                reached = axes[k] != 'rotor' and _is_reached(pose, stamps, values[:, k])
                axis = '' if reached or _contradicts(column, axes[k]) else axes[k]
                driven[column] = DrivenAxis(axis, describe_shares(shares[k]))
    return driven


def _measure_overlapping(pose: TimedTable, stamps: Numbers, values: Numbers) -> Numbers | None:
    """Return the shares of commands that were sent while the pose was logged; else None."""
    begins, ends = (
        [function(one) for one in (stamps, pose.seconds)] for function in (np.nanmin, np.nanmax)
    )
    shared = min(ends) - max(begins)
    return measure_shares(pose, stamps, values) if shared > LEAST * STEP else None


def _choose_axes(shares: Numbers, generic: Sequence[str]) -> list[str]:
    """Return the axis of each generic command; shares have a row for each command."""
    stems = [parse_column_name(column).stem for column in generic]
    count = len(generic)
    mixed = {
        stems[i] for i in range(count) for j in range(i)
        if stems[i] == stems[j] and (np.minimum(shares[i], shares[j]) > CLEAR).any()
    }  # fmt: skip
    axes = []
    for k, row in enumerate(shares[:count]):
        best = int(row.argmax())
        rivals = [*np.delete(row, best), *np.delete(shares[:, best], k)]
        is_clear = row[best] > max(CLEAR, max(rivals) / ALONE)
        axes.append('rotor' if stems[k] in mixed else AXES[best] if is_clear else '')
    return axes


def _contradicts(column: str, axis: str) -> bool:
    """Return whether a name says another axis than the motion, as cmd_yaw that lifts."""
    if parse_column_name(column).words & SERVOS:
        return True  # what it turns pushes
    named = {
        **dict.fromkeys(ANGLES.values(), ''),
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
            alike = np.corrcoef(sent, reached)[0, 1] > REACHED
            if near and alike and SIZES[0] < size < SIZES[1]:
                return True
    return False


def list_answers(driven: Mapping[str, DrivenAxis]) -> dict[str, str]:
    """Return what the motion decides, by the keys with which a user would decide it."""
    axes = {f'{column}.command': one.axis for column, one in driven.items() if one.axis in AXES}
    rotors = {f'{column}.topic': 'motors' for column, one in driven.items() if one.axis == 'rotor'}
    return axes | rotors
