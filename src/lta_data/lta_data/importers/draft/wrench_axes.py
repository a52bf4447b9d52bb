"""Find by the motion whether commanded forces are along FLU or FRD axes, and in N or mN."""

from collections.abc import Mapping
from typing import Any, Final

from lta_data.even_grid import build_uniform_time_grid
from lta_data.importers.draft.array_commands import DELAYS, LEAST, lose_without
from lta_data.importers.draft.axis_commands import KEY, UNITS
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
from lta_data.importers.draft.name_hints import parse_column_name
from lta_data.importers.draft.table_draft import list_columns, TableDraft
from lta_data.importers.log_table import Numbers
import numpy as np

FORWARD: Final = 0  # of the accelerations forward, up, yaw
UP: Final = 1  # of the accelerations forward, up, yaw
YAW: Final = 2
CLEAR: Final = 0.1  # share of an acceleration; a command that explains less does not decide
SIZES: Final = {unit: UNITS[unit] for unit in ('N', 'mN')}
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
            stamps = timed[name].seconds + timed[name].first - pose.first + late
            factors = _fit_accelerations(pose, stamps, entry, tables[name])
            _check_unit(entry, factors, choices)
            if 'body' in entry:
                continue
            signs = {float(np.sign(factors[axis])) for axis in (UP, YAW) if axis in factors}
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
    pulls = [abs(factors[axis]) for axis in (FORWARD, UP) if axis in factors]
    if size not in SIZES.values() or not pulls or KEY in choices.answers:
        return
    # Per number in the log; the lighter axis has less air to move along
    named = {one: SIZES[one] / max(pulls) for one in SIZES}
    unit = next(one for one in SIZES if SIZES[one] == size)
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
        other = choices.decide(KEY, options, f'The names say {unit}, but {why}.')
    for one in [*forces, *([entry['torque']] if 'torque' in entry else [])]:
        one.pop('scale', None)
        one['unit'] = other + ' m' * one['unit'].endswith(' m')
    choices.add_reason('wrench_command: unit', list_columns(entry), other, why)


def _find_size(vector: Mapping[str, Any]) -> float | None:
    """Return the size of a number of a force [N]; None if it differs between axes."""
    scale = vector.get('scale', 1.0)
    return None if isinstance(scale, list) else UNITS[vector['unit']] * scale


def _fit_accelerations(
    pose: TimedTable, stamps: Numbers, entry: Mapping[str, Any], table: Columns
) -> dict[int, float]:
    """
    Return by how much a number of force ahead, force up and moment in yaw accelerates, by axis.

    Only of the commands that clearly explain the acceleration. [m/s2, rad/s2]
    """
    columns = list_columns(entry)
    held = np.nan_to_num(np.column_stack([table[one] for one in columns]).astype(float))
    rising = find_rising(stamps)
    if pose.position is None or pose.turn is None or not rising.any():
        return {}
    stamps, held = stamps[rising], held[: len(rising)][rising]
    begin, end = np.nanmin(pose.seconds), np.nanmax(pose.seconds)
    first, last = max(begin, stamps[0]), min(end, stamps[-1])
    grid = build_uniform_time_grid(first, last, STEP, len(pose.seconds))
    if len(grid) < LEAST:
        return {}
    speed, pull = find_motion(pose.seconds, pose.position, pose.turn, grid)
    base = np.column_stack([speed, np.ones(len(grid))])
    forces = entry.get('forces') or [entry.get('force', {})]
    out = {}
    for vectors, place, axis in (
        (forces, 0, FORWARD), (forces, 2, UP), ([entry.get('torque', {})], 2, YAW)
    ):  # fmt: skip
        named = [one['columns'][place] for one in vectors if one.get('columns')]
        column = next((one for one in named if one is not None), None)
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
            out[axis] = factors[int(np.argmax(shares))]
    return out
