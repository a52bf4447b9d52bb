"""Find by the motion whether commanded forces are along FLU or FRD axes."""

from collections.abc import Mapping
from typing import Any, Final

from lta_data.importers.draft.array_commands import DELAYS, LEAST, lose_without
from lta_data.importers.draft.choices import DraftChoices
from lta_data.importers.draft.clock_alignment import (
    AlignedClock,
    find_motion,
    find_rising,
    read_timed_tables,
    STEP,
    TimedTable,
)
from lta_data.importers.draft.column_groups import Columns
from lta_data.importers.draft.table_draft import list_columns, TableDraft
from lta_data.importers.log_table import Numbers
import numpy as np

UP: Final = 1  # of the accelerations forward, up, yaw
YAW: Final = 2
CLEAR: Final = 0.1  # share of an acceleration; a command that explains less does not decide


def turn_wrench_axes(
    tables: Mapping[str, Columns],
    drafts: Mapping[str, TableDraft],
    clocks: Mapping[str, AlignedClock],
    choices: DraftChoices,
) -> None:
    """
    Set `body` of a commanded wrench where the vehicle follows it in other axes than the pose's.

    A force along z that lifts is along FLU axes, whatever the axes of the tracker. Nothing is set
    if heave and yaw contradict each other: a calibration finds the sign of each axis.
    """
    timed = read_timed_tables(tables, drafts)
    pose = next((one for one in timed.values() if one.position is not None), None)
    axes = next((one.axes for one in drafts.values() if one.axes), None)
    if pose is None or axes is None:
        return
    usual = axes.body if axes.body in ('FLU', 'FRD') else 'FLU'
    for name, draft in drafts.items():
        for entry in draft.entries:
            if entry['topic'] != 'wrench_command' or 'body' in entry:
                continue
            late = clocks[name].seconds if name in clocks else 0.0
            stamps = timed[name].seconds + timed[name].first - pose.first + late
            signs = _find_signs(pose, stamps, entry, tables[name])
            body = {1.0: 'FLU', -1.0: 'FRD'}.get(next(iter(signs), 0.0))
            if len(signs) == 1 and body not in (None, usual):
                entry['body'] = body
                way = 'up or to the left' if body == 'FLU' else 'down or to the right'
                choices.add_reason('wrench_command: axes', list_columns(entry), str(body),
                                   f'the vehicle accelerates {way} with them')  # fmt: skip


def _find_signs(
    pose: TimedTable, stamps: Numbers, entry: Mapping[str, Any], table: Columns
) -> set[float]:
    """Return the signs with which force and moment along z act upwards and to the left."""
    columns = list_columns(entry)
    held = np.nan_to_num(np.column_stack([table[one] for one in columns]).astype(float))
    rising = find_rising(stamps)
    if pose.position is None or pose.turn is None or not rising.any():
        return set()
    stamps, held = stamps[rising], held[: len(rising)][rising]
    begin, end = np.nanmin(pose.seconds), np.nanmax(pose.seconds)
    grid = np.arange(max(begin, stamps[0]), min(end, stamps[-1]), STEP)
    if len(grid) < LEAST:
        return set()
    speed, pull = find_motion(pose.seconds, pose.position, pose.turn, grid)
    base = np.column_stack([speed, np.ones(len(grid))])
    signs = set()
    for part, axis in (('force', UP), ('torque', YAW)):
        column = entry.get(part, {}).get('columns', [None])[-1]
        if column is None:
            continue
        k, target = columns.index(column), pull[:, axis : axis + 1]
        shares, factors = [], []
        for delay in DELAYS:
            rows = np.clip(np.searchsorted(stamps + delay, grid, side='right') - 1, 0, None)
            shares.append(lose_without(base, held[rows], k, target))
            fit = np.linalg.lstsq(np.column_stack([base, held[rows]]), target, rcond=None)[0]
            factors.append(float(fit[base.shape[1] + k, 0]))
        if max(shares) > CLEAR:
            signs.add(float(np.sign(factors[int(np.argmax(shares))])))
    return signs
