"""
Find by the motion what the numbers of an array are: a state vector, whose elements have no names.

The array is cut into blocks of three, or four where they are a unit quaternion. A block is read as
rates or a velocity if it is the derivative of another one, which is then the attitude or place.
"""

from collections.abc import Iterator, Mapping, Sequence
from itertools import permutations
import re
from typing import Final

from lta_data.importers.draft.attitude_readings import AttitudeReading, list_readings
from lta_data.importers.draft.column_groups import ColumnGroup, Columns, has_unit_length
from lta_data.importers.draft.kinematics import body_rates_of, differentiate
from lta_data.importers.draft.motion_kinds import (
    CLEAR,
    explain_changes,
    feels_gravity,
    follows_course,
    LOOKED_AT,
)
from lta_data.importers.draft.name_hints import ACTUATORS, COMMANDS, JOYSTICKS, parse_column_name
from lta_data.importers.protocol import Numbers
import numpy as np

FEWEST: Final = 6  # numbers of a state vector
MORE: Final = 0.02  # of a share that tells angles from the coordinates of a place
ELEMENT: Final = re.compile(r'(.*?)[\[(_.]?(\d+)[\])]?')
Block = tuple[str, ...]


def find_state_vectors(
    columns: Sequence[str], table: Columns, seconds: Numbers
) -> list[ColumnGroup]:
    """Return the groups of numbered columns without a name whose motion says what they are."""
    blocks = [block for array in _list_arrays(columns) for block in _cut(array, table)]
    rows = {block: _stack(block, table) for block in blocks}
    blocks = [block for block in blocks if np.isfinite(rows[block]).all() and np.ptp(rows[block])]
    at, kinds = seconds[:LOOKED_AT], dict[Block, tuple[str, str]]()
    turns = {block: _read(block, rows[block]) for block in blocks}
    pairs = [(one, other) for one, other in permutations(blocks, 2) if len(other) == 3]
    for turned, rate in pairs:
        _pair_turning(kinds, turned, rate, (rows, turns, at), clearly=True)
    attitudes = [one for one in blocks if len(one) == 4 or kinds.get(one, ('',))[0] == 'euler']
    for place, moved in pairs:
        if len(place) == 3 and kinds.keys().isdisjoint({place, moved}):
            speed = differentiate(rows[place], at)
            turned_speeds = [one.turn.inv().apply(speed) for a in attitudes for one in turns[a]]
            share = max(explain_changes(rows[moved], v, at) for v in (speed, *turned_speeds))
            if share > CLEAR:
                kinds[place] = 'position', f'{_name(moved)} are its derivative'
                kinds[moved] = 'velocity', f'the derivative of {_name(place)}'
                break
    for turned, rate in pairs:
        _pair_turning(kinds, turned, rate, (rows, turns, at), clearly=False)
    _add_single(kinds, blocks, rows, at)
    return [_build(block, *kind) for block, kind in kinds.items()]


def _pair_turning(
    kinds: dict[Block, tuple[str, str]],
    turned: Block,
    rate: Block,
    motion: tuple[Mapping[Block, Numbers], Mapping[Block, list[AttitudeReading]], Numbers],
    *,
    clearly: bool,
) -> None:
    """
    Add an attitude and its body rates to the kinds, if these explain them.

    `motion`: rows, readings as attitudes, and times. `clearly`: more than a place and a velocity
    do, which small angles and their rates are alike.
    """
    rows, turns, seconds = motion
    if not kinds.keys().isdisjoint({turned, rate}):
        return
    share = max(explain_changes(rows[rate], body_rates_of(one.turn, seconds), seconds)
                for one in turns[turned])  # fmt: skip
    plain = 0.0
    if clearly and len(turned) == 3:
        plain = explain_changes(rows[rate], differentiate(rows[turned], seconds), seconds)
    if share > max(CLEAR, plain + MORE if plain > CLEAR else 0.0):
        kinds[turned] = _name_attitude(turned), f'{_name(rate)} are its derivative'
        kinds[rate] = 'rates', f'the derivative of {_name(turned)}'


def _add_single(
    kinds: dict[Block, tuple[str, str]],
    blocks: Sequence[Block],
    rows: Mapping[Block, Numbers],
    seconds: Numbers,
) -> None:
    """Add quaternions, accelerometers, and the angles that follow the course of a place."""
    for block in blocks:
        if len(block) == 4:
            kinds.setdefault(block, ('quaternion', 'four numbers of length one'))
        elif feels_gravity(rows[block]):
            kinds.setdefault(block, ('acceleration', 'it feels gravity'))
    rest = [block for block in blocks if block not in kinds]
    if len(blocks) == 1 and rest:
        kinds[rest[0]] = 'position', 'the only three numbers'
    is_placed = any(kind == 'position' for kind, _ in kinds.values())
    if any(kind in ('euler', 'quaternion') for kind, _ in kinds.values()):
        # Beside an attitude, one more block is the place
        if len(rest) == 1 and not is_placed:
            kinds[rest[0]] = 'position', 'the only numbers beside the attitude'
        return
    for place, turned in permutations(rest, 2):
        if follows_course(rows[turned], rows[place], seconds):
            kinds[place] = 'position', f'{_name(turned)} follow its course'
            kinds[turned] = 'euler', f'its last number follows the course of {_name(place)}'
            return


def _list_arrays(columns: Sequence[str]) -> Iterator[list[str]]:
    """Yield the columns of each array in their order: its name, and numbers without a gap."""
    arrays: dict[str, dict[int, str]] = {}
    for column in columns:
        match = ELEMENT.fullmatch(column)
        words = parse_column_name(column).words
        if match and not words & (ACTUATORS | COMMANDS | JOYSTICKS):
            name = '' if match[1] == 'column' else match[1]
            arrays.setdefault(name, {})[int(match[2])] = column
    for name, array in arrays.items():
        first = min(array)
        is_long = len(array) >= (FEWEST if name else 3)
        if is_long and [*sorted(array)] == [*range(first, first + len(array))]:
            yield [array[index] for index in sorted(array)]


def _cut(array: Sequence[str], table: Columns) -> Iterator[Block]:
    """Yield the blocks of an array."""
    begin = 0
    while begin + 3 <= len(array):
        four = tuple(array[begin : begin + 4])
        size = 4 if len(four) == 4 and has_unit_length(_stack(four, table)) else 3
        yield tuple(array[begin : begin + size])
        begin += size


def _stack(block: Block, table: Columns) -> Numbers:
    rows = np.stack([table[column] for column in block], axis=1)
    return np.asarray(rows, dtype=np.float64)[:LOOKED_AT]


def _read(block: Block, rows: Numbers) -> list[AttitudeReading]:
    readings = list_readings(_build(block, _name_attitude(block), ''), rows)
    return [one for one in readings if not one.cost]


def _name_attitude(block: Block) -> str:
    return 'quaternion' if len(block) == 4 else 'euler'


def _name(block: Block) -> str:
    return f'{block[0]} to {block[-1]}'


def _build(block: Block, kind: str, reason: str) -> ColumnGroup:
    axes = {'quaternion': ('0', '1', '2', '3'), 'euler': ('roll', 'pitch', 'yaw')}
    return ColumnGroup(kind, '', block, axes.get(kind, ('x', 'y', 'z')), '', reason)
