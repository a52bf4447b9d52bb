# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Find how far the clocks of the tables of a log are apart."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final, final, NamedTuple

from lta_config.errors import BadInput
from lta_config.quantity import Quantity
from lta_data.even_grid import hann_kernel, smooth_columns
from lta_data.importers.draft.choices import DraftChoices
from lta_data.importers.draft.motion_draft import MotionDraft
from lta_data.importers.draft.table_draft import list_columns, TableDraft
from lta_data.importers.draft.vertical import spread_axes, VerticalAxes
from lta_data.importers.protocol import Numbers
from lta_data.interpretation.column_group import Columns
from lta_data.interpretation.commands import DRIVES
from lta_data.interpretation.kinematics import body_rates_of, differentiate
import numpy as np
from pydantic import ValidationError
from scipy.spatial.transform import Rotation

ALIGNED_STEP: Final = 0.1  # of the grid on which motion and commands are compared [s]
# Width of the kernel that smooths the motion before it is derived [s]
MOTION_SMOOTHING: Final = 0.6
SHARED_PART: Final = 0.5  # of the shorter table, at least, lies in both at any offset tried
FARTHEST_OFFSET: Final = 150.0  # offset that is tried, from tables that begin together [s]
ALIGNED_TIME: Final = 600.0  # of a flight that is looked at [s]
GLITCH: Final = 6.0  # times its median size, an acceleration is clipped
MIN_SHARED_POINTS: Final = 50  # points of the grid that both tables share
PEAK_WIDTH: Final = 1.5  # offsets nearer to the best one belong to its peak [s]
# Of the accelerations, at least, by commands that change often
EXPLAINED_ACCELERATION: Final = 0.15
CLEAR_OFFSET_RATIO: Final = 1.5  # times as much as at any offset farther away
# A smaller offset is the delay of a vehicle, not that of a clock [s]
LONGEST_REACTION: Final = 1.0
CLOCK_SET_GAP: Final = 3600.0  # a longer gap is a clock that was set [s]
EPOCH_SECONDS: Final = 1e9  # later times count from 1970 [s]
ONE_DAY: Final = 86_400.0  # times since 1970 that are nearer are those of one clock [s]


@final
class CommandOffset(NamedTuple):
    """How much later the pose's clock is, counted from the first row of both tables."""

    seconds: float
    explained: float  # share of the accelerations that the commands explain
    is_clear: bool  # no other offset comes near


@final
@dataclass(frozen=True, slots=True, eq=False)
class TimedTable:
    """The times of a table, and its commands or poses in our axes."""

    name: str
    first: float  # time of the first row on the table's clock [s]
    seconds: Numbers  # since the first row, shape (n,) [s]
    commands: Numbers | None = None  # in any unit, shape (n, k)
    position: Numbers | None = None  # [m], shape (n, 3)
    turn: Rotation | None = None  # from body to world, n

    def shares_clock(self, other: 'TimedTable') -> bool:
        """Return whether the times of two tables can be those of one clock."""
        ours, theirs = ((one.first, one.first + float(one.seconds[-1])) for one in (self, other))
        near = min(ours[0], theirs[0]) > EPOCH_SECONDS and abs(ours[0] - theirs[0]) < ONE_DAY
        return near or min(ours[1], theirs[1]) > max(ours[0], theirs[0])

    def estimate_offset(self, commanded: 'TimedTable') -> CommandOffset | None:
        """Return when the commands of another table act in the motion of this one."""
        if self.position is None or self.turn is None or commanded.commands is None:
            return None
        return estimate_clock_offset(
            self.seconds, self.position, self.turn, commanded.seconds, commanded.commands
        )


@final
class AlignedClock(NamedTuple):
    """The clock of a table beside that of the pose."""

    seconds: float  # to add to the times of the table
    align: str  # table of the pose if each log has its own offset, '' if the user gave it
    why: str
    is_clear: bool = False  # the motion of the log tells it
    is_shared: bool = False  # several logs agree on it

    def list_keys(self) -> dict[str, str]:
        """Return what a mapping says of it."""
        return {'align': self.align} if self.align else {'start': f'{self.seconds:.3f} s'}


def align_clocks(
    tables: Mapping[str, Columns], drafts: Mapping[str, TableDraft], choices: DraftChoices
) -> dict[str, AlignedClock]:
    """
    Return the offset of the times of each table that has another clock than the pose.

    Where the times of two tables do not overlap, they have two clocks. Then the motion says when
    the commands acted; if it does not, both tables are taken to begin together.
    """
    timed = read_timed_tables(tables, drafts)
    pose = next((one for one in timed.values() if one.position is not None), None)
    if pose is None:
        return {}
    clocks: dict[str, AlignedClock] = {}
    others = [one for one in timed.values() if one is not pose]
    # Commands first: a sensor on their clock follows them
    for table in sorted(others, key=lambda one: one.commands is None):
        key = f'{table.name}.time.start'
        decision = choices.override(key, '')
        if decision:
            clock = AlignedClock(_parse_seconds(key, decision), '', 'as you decided')
        elif pose.shares_clock(table):
            _ask_for_shift(key, pose, table, choices)
            continue
        else:
            clock = choose_clock(pose, table, [(timed[one], clocks[one]) for one in clocks])
        choices.add_reason(f'{table.name}.time', [], f'{clock.seconds:.2f} s later', clock.why)
        clocks[table.name] = clock
    return clocks


def read_timed_tables(
    tables: Mapping[str, Columns], drafts: Mapping[str, TableDraft]
) -> dict[str, TimedTable]:
    """Return the drafted tables with their times, commands and poses."""
    return {
        name: _read_draft(name, one, tables[name]) for name, one in drafts.items() if one.entries
    }


def choose_clock(
    pose: TimedTable, table: TimedTable, aligned: Sequence[tuple[TimedTable, AlignedClock]]
) -> AlignedClock:
    """Return the offset of a table: of one on its clock, by the motion, or as begun together."""
    for other, clock in aligned:
        if other.shares_clock(table):
            return clock._replace(why=f'the clock of {other.name}')
    offset, stamped = pose.estimate_offset(table), table.first - pose.first
    if offset is not None and offset.is_clear:
        share = f'{100.0 * offset.explained:.0f} %'
        why = f'there, the commands explain {share} of the accelerations'
        return AlignedClock(offset.seconds - stamped, pose.name, why, True)
    why = f'another clock than {pose.name}; taken to begin together: check it'
    return AlignedClock(-stamped, pose.name, why)


def _ask_for_shift(key: str, pose: TimedTable, table: TimedTable, choices: DraftChoices) -> None:
    """Ask about commands on the clock of the pose which the motion follows much later."""
    offset = pose.estimate_offset(table)
    shift = 0.0 if offset is None else offset.seconds - (table.first - pose.first)
    if offset is not None and offset.is_clear and abs(shift) > LONGEST_REACTION:
        options = [('0 s', 'as stamped'), (f'{shift:.1f} s', 'as the motion shows')]
        question = f'The motion follows the commands of {table.name} {shift:.1f} s later.'
        choices.decide(key, options, question)


def _parse_seconds(key: str, text: str) -> float:
    """Return a time that the user gave [s]."""
    try:
        time = Quantity.model_validate(text)
    except ValidationError:
        time = None
    if time is None or time.dimension != 's':
        raise BadInput(f"--set {key} is '{text}', but must be a time, such as '3.2 s'.")
    return time.si


def _read_draft(name: str, draft: TableDraft, table: Columns) -> TimedTable:
    """Return the times of a drafted table, and its commands or poses in our axes."""
    columns = [
        column for entry in draft.entries if entry['topic'] in DRIVES
        for column in list_columns(entry)
    ]  # fmt: skip
    commands = np.column_stack([table[one] for one in columns]).astype(float) if columns else None
    return build_timed_table(
        name, draft.time.first, draft.time.seconds, draft.motion, draft.axes, commands
    )


def build_timed_table(
    name: str,
    first: float,
    seconds: Numbers,
    motion: MotionDraft | None,
    axes: VerticalAxes | None,
    commands: Numbers | None = None,
) -> TimedTable:
    """Return a table with the poses of its motion in our axes, if it has any."""
    if motion is None or motion.turn is None or motion.evidence.position is None:
        return TimedTable(name, first, seconds, commands)
    used = ('ENU', 'FLU') if axes is None else (axes.world, axes.body)
    world, body = map(spread_axes, used)
    # A draft looks at the first rows only
    count = min(len(motion.turn), len(motion.evidence.position))
    turn = Rotation.from_matrix(world @ motion.turn.as_matrix()[:count] @ body.T)
    position = motion.evidence.position[:count] @ world.T
    return TimedTable(name, first, motion.evidence.seconds[:count], commands, position, turn)


def estimate_clock_offset(
    seconds: Numbers, position: Numbers, turn: Rotation, stamps: Numbers, commands: Numbers
) -> CommandOffset | None:
    """
    Estimate when the commands of one table acted in the motion of another.

    At each offset, the accelerations (forward, vertical, yaw) are regressed on all commands, the
    velocities and a constant. A command explains an acceleration only where it acts.

    Parameters
    ----------
    seconds, position, turn : arrays, shapes (n,) and (n, 3), and Rotation of n
        Times since the first row [s], places [m] and attitudes from body to world.
    stamps, commands : arrays, shapes (m,) and (m, k)
        Times since the first row of their table [s], and commands in any unit.

    """
    good = find_rising(seconds) & np.isfinite(position).all(axis=1)
    rising = find_rising(stamps)
    if good.sum() < 2 or rising.sum() < 2:
        return None
    seconds, position, turn = seconds[good], position[good], turn[good]
    stamps, commands = stamps[rising], commands[rising]
    grid = np.arange(seconds[0], min(seconds[-1], seconds[0] + ALIGNED_TIME), ALIGNED_STEP)
    if (
        len(grid) < 2 * MIN_SHARED_POINTS
        or stamps[-1] - stamps[0] < 2 * MIN_SHARED_POINTS * ALIGNED_STEP
    ):
        return None
    speed, pull = find_motion(seconds, position, turn, grid)
    scale = np.nanstd(commands, axis=0)
    commands = np.nan_to_num((commands - np.nanmean(commands, axis=0)) / np.where(scale, scale, 1))
    commands = commands[:, scale > 0.0]
    if not commands.shape[1]:
        return None
    shared = SHARED_PART * min(grid[-1], stamps[-1])
    low, high = max(shared - stamps[-1], -FARTHEST_OFFSET), min(grid[-1] - shared, FARTHEST_OFFSET)
    offsets = np.arange(np.ceil(low / ALIGNED_STEP), high / ALIGNED_STEP) * ALIGNED_STEP
    if not len(offsets):
        return None
    gains = np.array([_explain(grid, speed, pull, stamps + one, commands) for one in offsets])
    best = int(gains.argmax())
    others = gains[np.abs(offsets - offsets[best]) > PEAK_WIDTH]
    # A step has two changes, which may fit any two gusts
    changes = int(np.any(np.diff(commands, axis=0) != 0.0, axis=1).sum())
    least = max(EXPLAINED_ACCELERATION, 1.0 / max(changes, 1))
    clear = gains[best] > least and gains[best] > CLEAR_OFFSET_RATIO * others.max(initial=0.0)
    return CommandOffset(float(offsets[best]), float(gains[best]), bool(clear))


def find_rising(times: Numbers) -> Any:
    """Return which times are later than all before them, without jumps of an hour."""
    finite = np.isfinite(times)
    latest = np.maximum.accumulate(np.where(finite, times, -np.inf))
    before = np.concatenate([[-np.inf], latest[:-1]])
    jumped = np.concatenate([[False], np.diff(np.where(finite, times, np.nan)) > CLOCK_SET_GAP])
    # What follows a jump is on the clock that the rest of the table has
    begin = int(np.flatnonzero(jumped)[-1]) if jumped.any() else 0
    rising: Any = finite & (times > before) & (np.arange(len(times)) >= begin)
    return rising


def find_motion(
    seconds: Numbers, position: Numbers, turn: Rotation, grid: Numbers
) -> tuple[Numbers, Numbers]:
    """Return velocities and accelerations on a grid: forward, up, yaw; shape (n, 3)."""
    # Times may be missing or repeat, and places be lost
    good = find_rising(seconds) & np.isfinite(position).all(axis=1)
    if good.sum() < 2:
        return np.zeros((len(grid), 3)), np.zeros((len(grid), 3))
    seconds, position, turn = seconds[good], position[good], turn[good]
    body = turn.inv().apply(np.nan_to_num(differentiate(position, seconds)))
    up = np.nan_to_num(differentiate(position[:, 2:], seconds))[:, 0]
    yaw = np.nan_to_num(body_rates_of(turn, seconds))[:, 2]
    weights = hann_kernel(MOTION_SMOOTHING, float(np.median(np.diff(seconds))))
    smooth = smooth_columns(np.column_stack([body[:, 0], up, yaw]), weights)
    speed = np.column_stack([np.interp(grid, seconds, one) for one in smooth.T])
    pull = np.gradient(speed, ALIGNED_STEP, axis=0)
    # A marker that was lost jumps, and must not decide
    most = GLITCH * np.median(np.abs(pull), axis=0)
    return speed, np.clip(pull, -most, most)


def _explain(
    grid: Numbers, speed: Numbers, pull: Numbers, stamps: Numbers, commands: Numbers
) -> float:
    """
    Return the share of the accelerations that commands at these times explain.

    Those outside of the commands count as unexplained: in a few seconds that overlap, the one end
    of a step explains anything.
    """
    inside = (grid >= stamps[0]) & (grid <= stamps[-1])
    if inside.sum() < MIN_SHARED_POINTS:
        return 0.0
    held = commands[np.searchsorted(stamps, grid[inside], side='right') - 1]
    base = np.column_stack([speed, np.ones(len(grid))])
    target = pull / np.maximum(pull.std(axis=0), 1e-9)
    whole = sum_residuals(base, target)
    alone = sum_residuals(base[inside], target[inside])
    with_commands = sum_residuals(np.column_stack([base[inside], held]), target[inside])
    return (alone - with_commands) / whole if whole > 0.0 else 0.0


def sum_residuals(regressors: Numbers, values: Numbers) -> float:
    """Return the sum of the squared residuals of a regression."""
    fit = np.linalg.lstsq(regressors, values, rcond=None)[0]
    return float(np.square(values - regressors @ fit).sum())
