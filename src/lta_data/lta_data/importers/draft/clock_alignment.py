"""Find how far the clocks of the tables of a log are apart."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final, final, NamedTuple

from lta_config.quantity import Quantity
from lta_config.schema.import_file import AXES, ImportMapping
from lta_data.data_quality.smoothing import hann_kernel, smooth_columns
from lta_data.importers.axes import signed_permutation
from lta_data.importers.draft.attitude_readings import body_rates_of, differentiate
from lta_data.importers.draft.choices import DraftChoices
from lta_data.importers.draft.column_groups import Columns
from lta_data.importers.draft.source_tables import read_source
from lta_data.importers.draft.table_draft import draft_table, list_columns, TableDraft
from lta_data.importers.log_table import Numbers
import numpy as np
from scipy.spatial.transform import Rotation

STEP: Final = 0.1  # of the grid on which motion and commands are compared [s]
SMOOTH: Final = 0.6  # width of the kernel that smooths the motion before it is derived [s]
SHARED: Final = 0.5  # of the shorter table, at least, lies in both at any offset tried
AROUND: Final = 1.5  # offsets nearer to the best one belong to its peak [s]
EXPLAINED: Final = 0.15  # of the accelerations by the commands, at least
CLEAR: Final = 1.5  # times as much as at any offset farther away
APART: Final = 1.0  # a smaller offset is the delay of a vehicle, not that of a clock [s]
COMMANDS: Final = ('motors', 'wrench_command')


@final
class CommandOffset(NamedTuple):
    """How much later the pose's clock is, counted from the first row of both tables."""

    seconds: float
    explained: float  # share of the accelerations that the commands explain
    is_clear: bool  # no other offset comes near


@final
class AlignedClock(NamedTuple):
    """The clock of a table beside that of the pose."""

    seconds: float  # to add to the times of the table
    align: str  # table of the pose if each log has its own offset, '' if the user gave it
    why: str

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
    reference = next((name for name, one in drafts.items() if _has_pose(one)), None)
    if reference is None:
        return {}
    clocks: dict[str, AlignedClock] = {}
    pose = drafts[reference]
    others = [name for name, one in drafts.items() if one.entries and name != reference]
    # Commands first: a sensor on their clock follows them
    for name in sorted(others, key=lambda one: not _list_commands(drafts[one])):
        stamped = drafts[name].time.first - pose.time.first
        found = _estimate(pose, drafts[name], tables[name])
        clear = found is not None and found.is_clear
        key = f'{name}.time.start'
        given = choices.override(key, '')
        if _share_clock(pose, drafts[name]) and not given:
            shift = found.seconds - stamped if found is not None else 0.0
            if clear and abs(shift) > APART:
                options = [('0 s', 'as stamped'), (f'{shift:.1f} s', 'as the motion shows')]
                choices.decide(
                    key, options, f'The motion follows the commands of {name} {shift:.1f} s later.'
                )
            continue
        friend = next((one for one in clocks if _share_clock(drafts[one], drafts[name])), None)
        if given:
            seconds, why = float(given.split()[0]), 'as you decided'
        elif friend is not None:
            seconds, why = clocks[friend].seconds, f'the clock of {friend}'
        elif found is not None and clear:
            seconds = found.seconds - stamped
            why = f'there, the commands explain {100 * found.explained:.0f} % of the accelerations'
        else:
            seconds = -stamped
            why = f'another clock than {reference}; taken to begin together: check it'
        choices.add_reason(f'{name}.time', [], f'{seconds:.2f} s later', why)
        clocks[name] = AlignedClock(seconds, '' if given else reference, why)
    return clocks


def resolve_clocks(path: Path, mapping: ImportMapping) -> tuple[ImportMapping, list[str]]:
    """
    Return a mapping with the offset of each clock of one log, and a remark on each.

    The mapping is returned as it is, if no time in it has `align`.
    """
    names = [one.table for one in mapping.topics if one.time is not None and one.time.align]
    if not names:
        return mapping, []
    tables = read_source(path).tables
    choices = DraftChoices()
    drafts = {name: draft_table(name, table, choices) for name, table in tables.items()}
    clocks = align_clocks(tables, drafts, choices)
    topics = []
    for one in mapping.topics:
        time = one.time
        if time is not None and time.align:
            clock = clocks.get(one.table or '')
            seconds = 0.0 if clock is None else clock.seconds
            start = Quantity(value=round(seconds, 3), unit='s')
            time = time.model_copy(update={'align': None, 'start': start})
        topics.append(one.model_copy(update={'time': time}))
    notes = [
        f'{clock.seconds:.2f} s are added to the times of {name}: {clock.why}.'
        for name, clock in clocks.items()
        if name in names
    ]
    return mapping.model_copy(update={'topics': topics}), notes


def _has_pose(draft: TableDraft) -> bool:
    return draft.motion is not None and draft.motion.evidence.position is not None


def _list_commands(draft: TableDraft) -> list[str]:
    """Return the columns of commands."""
    entries = [entry for entry in draft.entries if entry['topic'] in COMMANDS]
    return [column for entry in entries for column in list_columns(entry)]


def _share_clock(one: TableDraft, other: TableDraft) -> bool:
    """Return whether the times of two tables overlap as those of one flight."""
    spans = [(each.time.first, each.time.first + each.time.seconds[-1]) for each in (one, other)]
    shared = min(end for _, end in spans) - max(begin for begin, _ in spans)
    return bool(shared > SHARED * min(end - begin for begin, end in spans))


def _estimate(pose: TableDraft, draft: TableDraft, table: Columns) -> CommandOffset | None:
    columns = _list_commands(draft)
    motion = pose.motion
    if not columns or motion is None or motion.turn is None or motion.evidence.position is None:
        return None
    axes: list[Any] = [None, None] if pose.axes is None else [pose.axes.world, pose.axes.body]
    world, body = (signed_permutation(AXES[one] if isinstance(one, str) else one) for one in axes)
    rows = motion.turn.as_matrix()
    count = len(rows)
    return estimate_clock_offset(
        motion.evidence.seconds[:count], motion.evidence.position[:count] @ world.T,
        Rotation.from_matrix(world @ rows @ body.T), draft.time.seconds,
        np.column_stack([table[column] for column in columns]).astype(np.float64),
    )  # fmt: skip


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
    grid = np.arange(seconds[0], seconds[-1], STEP)
    if len(grid) < 100 or stamps[-1] < 100 * STEP:
        return None
    speed, pull = _find_motion(seconds, position, turn, grid)
    scale = np.nanstd(commands, axis=0)
    commands = np.nan_to_num((commands - np.nanmean(commands, axis=0)) / np.where(scale, scale, 1))
    commands = commands[:, scale > 0.0]
    if not commands.shape[1]:
        return None
    least = SHARED * min(grid[-1], stamps[-1])
    offsets = np.arange(np.ceil((least - stamps[-1]) / STEP), (grid[-1] - least) / STEP) * STEP
    gains = np.array([_explain(grid, speed, pull, stamps + one, commands) for one in offsets])
    best = int(gains.argmax())
    others = gains[np.abs(offsets - offsets[best]) > AROUND]
    clear = gains[best] > EXPLAINED and gains[best] > CLEAR * others.max(initial=0.0)
    return CommandOffset(float(offsets[best]), float(gains[best]), bool(clear))


def _find_motion(
    seconds: Numbers, position: Numbers, turn: Rotation, grid: Numbers
) -> tuple[Numbers, Numbers]:
    """Return velocities and accelerations on a grid: forward, up, yaw; shape (n, 3)."""
    body = turn.inv().apply(np.nan_to_num(differentiate(position, seconds)))
    up = np.nan_to_num(differentiate(position[:, 2:], seconds))[:, 0]
    yaw = np.nan_to_num(body_rates_of(turn, seconds))[:, 2]
    weights = hann_kernel(SMOOTH, float(np.median(np.diff(seconds))))
    smooth = smooth_columns(np.column_stack([body[:, 0], up, yaw]), weights)
    speed = np.column_stack([np.interp(grid, seconds, one) for one in smooth.T])
    return speed, np.gradient(speed, STEP, axis=0)


def _explain(
    grid: Numbers, speed: Numbers, pull: Numbers, stamps: Numbers, commands: Numbers
) -> float:
    """Return the share of the accelerations that commands at these times explain."""
    inside = (grid >= stamps[0]) & (grid <= stamps[-1])
    held = commands[np.searchsorted(stamps, grid[inside], side='right') - 1]
    base = np.column_stack([speed[inside], np.ones(int(inside.sum()))])
    wanted = pull[inside] / np.maximum(pull.std(axis=0), 1e-9)
    left = [
        float(np.square(wanted - each @ np.linalg.lstsq(each, wanted, rcond=None)[0]).sum())
        for each in (base, np.column_stack([base, held]))
    ]
    return 1.0 - left[1] / left[0] if left[0] > 0.0 else 0.0
