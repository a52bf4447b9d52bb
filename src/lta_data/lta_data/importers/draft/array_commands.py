"""Ask what the numbers of an array or a stick command, and show which motion follows each."""

from collections.abc import Mapping, Sequence
from typing import Final

from lta_data.even_grid import build_uniform_time_grid
from lta_data.importers.draft.choices import BODY_AXES, DraftChoices
from lta_data.importers.draft.clock_alignment import (
    find_motion,
    find_rising,
    STEP,
    sum_residuals,
    TimedTable,
)
from lta_data.importers.draft.generic_commands import ask_for_meanings
from lta_data.importers.draft.name_hints import ColumnName, NUMBERED
from lta_data.importers.protocol import LogTable, Numbers
import numpy as np

# A twist or a force in a message: linear.x is surge
PARTS: Final = {
    f'{part}.{axis}': BODY_AXES[k + offset]
    for offset, parts in ((0, ('linear', 'force')), (3, ('angular', 'torque')))
    for part in parts
    for k, axis in enumerate('xyz')
}
BOTH_WAYS: Final = 1.05  # a command that has both signs and stays below it is that of a stick
DELAYS: Final = (0.0, 0.2, 0.4, 0.6)  # of a reaction, that are tried [s]
FOLLOWS: Final = 0.03  # share of an acceleration that is worth telling
LEAST: Final = 100  # points of the grid
MOTIONS: Final = ('forward', 'up', 'yaw')


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
    stick = float(np.nanmin(values)) < 0.0 and float(np.nanmax(np.abs(values))) <= BOTH_WAYS
    if nameless and (stick or choices.vehicle is not None):
        choices.follows = find_motion_of(table, columns, tracked)
        ask_for_meanings([one.column for one in nameless], f' of {topic}', choices)
    return [one for one in parts if choices.find_answer(f'{one.column}.command') != 'none']


def _name_part(name: ColumnName) -> ColumnName:
    """Return the name of a part of a twist or a force with its body axis."""
    end = '.'.join(name.column.split('.')[-2:])
    return name._replace(stem=(PARTS[end],), axis='') if end in PARTS else name


def find_motion_of(
    table: LogTable, columns: Mapping[str, Numbers], tracked: TimedTable | None
) -> dict[str, str]:
    """
    Return for each command the accelerations that it explains, as a sentence.

    The accelerations (forward, vertical, yaw) are regressed on all commands, the velocities and a
    constant; the share of a command is what the fit loses without it.
    """
    if tracked is None:
        return {}
    stamps: Numbers = np.asarray(table.stamps * 1e-9 - tracked.first, dtype=np.float64)
    values: Numbers = np.array([*columns.values()], dtype=np.float64).T
    shares = measure_shares(tracked, stamps, values)
    if shares is None:
        return {}
    return {name: describe_shares(row) for name, row in zip(columns, shares, strict=True)}


def measure_shares(tracked: TimedTable, stamps: Numbers, values: Numbers) -> Numbers | None:
    """
    Return the share of each acceleration that each command alone explains.

    Parameters
    ----------
    tracked
        The poses.
    stamps, values : arrays, shapes (m,) and (m, k)
        Times since the first pose [s], and commands in any unit.

    Returns
    -------
    array, shape (k, 3), or None
        Of the accelerations forward, up and yaw; None if the poses are too few.

    """
    if tracked.position is None or tracked.turn is None:
        return None
    seconds, rising = tracked.seconds, find_rising(stamps)
    grid = build_uniform_time_grid(np.nanmin(seconds), np.nanmax(seconds), STEP, len(seconds))
    if len(grid) < LEAST or not rising.any():
        return None
    stamps, values = stamps[rising], values[rising]
    speed, pull = find_motion(seconds, tracked.position, tracked.turn, grid)
    target = pull / np.maximum(pull.std(axis=0), 1e-9)
    values = np.nan_to_num(values)
    base = np.column_stack([speed, np.ones(len(grid))])
    best: tuple[float, Numbers] = (-np.inf, np.zeros((values.shape[1], len(MOTIONS))))
    for delay in DELAYS:
        rows = np.clip(np.searchsorted(stamps + delay, grid, side='right') - 1, 0, None)
        held = values[rows]
        shares = np.array([
            [
                lose_without(base, held, column, target[:, axis : axis + 1])
                for axis in range(len(MOTIONS))
            ]
            for column in range(held.shape[1])
        ])  # fmt: skip
        if shares.sum() > best[0]:
            best = float(shares.sum()), shares
    return best[1]


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
        for share, word in sorted(zip(shares, MOTIONS, strict=True), reverse=True)
        if share > FOLLOWS
    ]
    return f' It alone explains {" and ".join(shares_text)}.' if shares_text else ''
