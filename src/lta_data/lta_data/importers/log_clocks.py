# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Align the clocks of the logs of an import: of each by its motion, or of all alike."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final

from lta_config.errors import BadInput
from lta_config.quantity import Quantity
from lta_config.schema.import_file import ImportMapping, TopicMapping
from lta_data.importers.converter import TopicConverter
from lta_data.importers.draft.clock_alignment import (
    AlignedClock,
    choose_clock,
    TimedTable,
)
from lta_data.importers.formats import find_format
from lta_data.importers.mapping_choice import choose_entries
from lta_data.importers.protocol import join_tables, LogTable, Numbers
from lta_data.interpretation.commands import DRIVES
import numpy as np
from scipy.spatial.transform import Rotation

# Range of the offsets of one pair of clocks, each of which is 0.25 s off [s]
SAME_OFFSET_RANGE: Final = 0.5
Clocks = dict[str, AlignedClock]  # by table


def estimate_clocks(path: Path, mapping: ImportMapping, robot: str) -> Clocks:
    """
    Return the clock of each table of a log whose times are to be aligned.

    Raises
    ------
    BadInput
        If the table of `align` has no pose.

    """
    align_with = {
        one.table or '': one.time.align
        for one in mapping.topics
        if one.time is not None and one.time.align
    }
    if not align_with:
        return {}
    bare = mapping.model_copy(update={'topics': [_set_start(one, None) for one in mapping.topics]})
    timed = _read_timed_tables(path, bare, robot, {*align_with, *align_with.values()})
    aligned: list[tuple[TimedTable, AlignedClock]] = []
    for name in sorted({*align_with} & {*timed}, key=lambda one: timed[one].commands is None):
        pose, table = timed.get(align_with[name]), timed[name]
        if pose is None or pose.position is None:
            raise BadInput(
                f"The times of table '{name}' are to be aligned with '{align_with[name]}', which "
                'has no position and attitude in the mapping; correct "align".'
            )
        if not pose.shares_clock(table):
            aligned.append((table, choose_clock(pose, table, aligned)))
    return {table.name: clock for table, clock in aligned}


def share_clocks(logs: Sequence[Clocks]) -> list[Clocks]:
    """
    Return the clocks of several logs of one rig: the same offset for all where they agree.

    Two computers that stay on keep their offset. Where a clock begins anew with each log, or the
    motion does not tell it, each log keeps its own.
    """
    shared: Clocks = {}
    for name in dict.fromkeys(name for log in logs for name in log):
        clear_clocks = [log[name] for log in logs if name in log and log[name].is_clear]
        offsets = [one.seconds for one in clear_clocks]
        if len(clear_clocks) < 2:
            continue
        span = max(offsets) - min(offsets)
        middle = float(np.median(offsets))
        if span <= SAME_OFFSET_RANGE:
            why = f'that of {len(clear_clocks)} logs, which agree within {max(span, 0.01):.2f} s'
            shared[name] = clear_clocks[0]._replace(seconds=middle, why=why, is_shared=True)
    return [{name: shared.get(name, clock) for name, clock in log.items()} for log in logs]


def set_clocks(
    mapping: ImportMapping, clocks: Clocks, is_alone: bool
) -> tuple[ImportMapping, list[str]]:
    """
    Return a mapping with the offset of each clock, and a remark on each.

    `is_alone`: whether no other logs were imported with it.
    """
    starts = {
        name: Quantity(value=round(clock.seconds, 3), unit='s') for name, clock in clocks.items()
    }
    own = ''
    if not is_alone:
        own = (
            ' The logs do not agree on it, so each has its own, and the delay of the commands may '
            'differ by 0.25 s from log to log.'
        )
    topics = [_set_start(one, starts.get(one.table or '')) for one in mapping.topics]
    return mapping.model_copy(update={'topics': topics}), [
        f'{clock.seconds:.2f} s are added to the times of {name}: {clock.why}.'
        + (own if clock.is_clear and not clock.is_shared else '')
        for name, clock in clocks.items()
    ]


def _set_start(entry: TopicMapping, start: Quantity | None) -> TopicMapping:
    """Return an entry whose times are not to be aligned, but begin later."""
    if entry.time is None or not entry.time.align:
        return entry
    time = entry.time.model_copy(update={'align': None, 'start': start})
    return entry.model_copy(update={'time': time})


def _read_timed_tables(
    path: Path, mapping: ImportMapping, robot: str, names: set[str]
) -> dict[str, TimedTable]:
    """Read tables of a log with the pose or the commands that a mapping takes from them."""
    log = find_format(mapping.format).opened(path, mapping)
    plans = [
        one
        for one in choose_entries(path, mapping, log, robot).plans
        if (one.entry.table or '') in names
    ]
    selection: dict[str, set[str]] = {}
    for plan in plans:
        selection.setdefault(plan.entry.table or '', set()).update(plan.entry.columns)
        selection |= {other: set() for other in plan.entry.join if other not in selection}
    tables: dict[str, TimedTable] = {}
    read = log.read_tables(selection)
    for plan in plans:
        name = plan.entry.table or ''
        joined, _ = join_tables(read[name], {other: read[other] for other in plan.entry.join})
        converter = TopicConverter(plan)
        rows = converter.select_rows(joined)
        earlier = tables.get(name)
        # A table may have a sensor beside its pose or its commands
        if len(rows) and (
            earlier is None or (earlier.position is None and earlier.commands is None)
        ):
            commands = plan.entry.topic in DRIVES
            tables[name] = _build_timed_table(
                name, rows, converter.compute_numbers(rows), commands
            )
    return tables


def _build_timed_table(
    name: str, table: LogTable, numbers: Mapping[str, Any], commanded: bool
) -> TimedTable:
    """Return a table with what its numbers, by path, say of pose or commands."""
    first, seconds = float(table.stamps[0]) * 1e-9, (table.stamps - table.stamps[0]) * 1e-9
    if commanded:
        columns = [value for value in numbers.values() if isinstance(value, np.ndarray)]
        return TimedTable(name, first, seconds, np.column_stack(columns))
    pose = [
        numbers.get(f'pose.pose.{part}.{axis}')
        for part, axes in (('position', 'xyz'), ('orientation', 'xyzw'))
        for axis in axes
    ]
    values = [one for one in pose if isinstance(one, np.ndarray)]
    if len(values) < len(pose):
        return TimedTable(name, first, seconds)
    rows = np.column_stack(values)
    return TimedTable(name, first, seconds, None, rows[:, :3], _read_turns(rows[:, 3:]))


def _read_turns(quaternions: Numbers) -> Rotation:
    """Return attitudes; those that are unknown are level."""
    good = np.isfinite(quaternions).all(axis=1) & (quaternions != 0.0).any(axis=1)
    return Rotation.from_quat(np.where(good[:, None], quaternions, [0.0, 0.0, 0.0, 1.0]))
