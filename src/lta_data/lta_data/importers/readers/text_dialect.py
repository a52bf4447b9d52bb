# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Detect how a text with columns is written: delimiter, comments, lines before the names."""

from collections import Counter
from collections.abc import Mapping, Sequence
from itertools import chain
from pathlib import Path
import re
from typing import Final, Literal

from lta_config.errors import BadInput
from lta_config.limits import check_column_count
from lta_config.schema.import_file import TextFormat
from lta_data.importers.readers.csv_text import (
    EMPTY_CELLS,
    HEAD_LINES,
    LIST,
    read_text,
    split_quoted,
    THOUSANDS,
)
from lta_data.interpretation.column_names import UNIT_WORDS

DIALECT_LINES: Final = 60  # that are looked at
DELIMITERS: Final = {',': ',', ';': ';', 'tab': '\t', '|': '|', 'whitespace': None}
DECIMALS: Final[tuple[Literal['.', ','], ...]] = ('.', ',')
COMMENTS: Final = '#%'
# Columns of a trajectory of the TUM RGB-D benchmark, which has no header
TUM: Final = ['timestamp', 'tx', 'ty', 'tz', 'qx', 'qy', 'qz', 'qw']
# First line of what Vicon exports, above the rate
VICON_SECTIONS: Final = ('Objects', 'Trajectories', 'Segments', 'Joints', 'Model Outputs')
LENGTH_UNITS: Final = {'meters': 'm', 'centimeters': 'cm', 'millimeters': 'mm'}
ECHOED_STAMP: Final = ('header.stamp.sec', 'header.stamp.nanosec', 'header.frame_id')


def _list_fields(*parts: str) -> list[str]:
    """Return the numbers of a message in their order: 'pose.position:xyz', 'covariance:36'."""
    names: list[str] = []
    for path, _, fields in (part.partition(':') for part in parts):
        names += [f'{path}[{i}]' for i in range(int(fields))] if fields.isdigit() else (
            [f'{path}.{axis}' for axis in fields] or [path])  # fmt: skip
    return names


# What `ros2 topic echo --csv` prints, without names, by the number of cells
ECHOED: Final = {
    len(names): names
    for names in (
        [*ECHOED_STAMP, *_list_fields('pose.position:xyz', 'pose.orientation:xyzw')],
        [*ECHOED_STAMP, *_list_fields(
            'pose.pose.position:xyz', 'pose.pose.orientation:xyzw', 'pose.covariance:36')],
        [*ECHOED_STAMP, 'child_frame_id', *_list_fields(
            'transform.translation:xyz', 'transform.rotation:xyzw')],
        [*ECHOED_STAMP, 'child_frame_id', *_list_fields(
            'pose.pose.position:xyz', 'pose.pose.orientation:xyzw', 'pose.covariance:36',
            'twist.twist.linear:xyz', 'twist.twist.angular:xyz', 'twist.covariance:36')],
        [*ECHOED_STAMP, *_list_fields(
            'orientation:xyzw', 'orientation_covariance:9', 'angular_velocity:xyz',
            'angular_velocity_covariance:9', 'linear_acceleration:xyz',
            'linear_acceleration_covariance:9')],
    )
}  # fmt: skip


def detect_text_format(path: Path) -> TextFormat:
    """
    Return the format of the lines of a text.

    The rows are the lines of numbers with the most frequent number of cells; the names are in the
    line before the first row, also as a comment. Without names, columns are column_1 and so on.

    Raise `BadInput` if no two lines have equally many numbers.
    """
    lines = _read_lines(path)
    lists = sum(bool(LIST.search(line.encode())) for line in lines) > len(lines) // 2
    if lists:
        return _detect_lists(path, lines)
    return _detect_lines(path, lines)


def _detect_lists(path: Path, lines: Sequence[str]) -> TextFormat:
    """Return the format of lines in which a cell may be a list, with a name for each number."""

    def flatten(line: str, cell: str) -> str:
        return LIST.sub(lambda found: cell.encode().join(
            found[1].replace(b',', b' ').split()), line.encode()).decode()  # fmt: skip

    marks = {mark: sum(mark in LIST.sub(b'', line.encode()).decode() for line in lines)
             for mark in (';', '\t', ',')}  # fmt: skip
    mark = max(marks, key=lambda one: marks[one])
    flat = _detect_lines(path, [flatten(line, mark) for line in lines])
    rows = [line for line in lines if LIST.search(line.encode())]
    before = [line for line in lines[: lines.index(rows[0])] if line.strip()]
    cells = split_cells(LIST.sub(rb'"\1"', rows[0].encode()).decode(), mark)
    names = split_cells(before[-1], mark) if before else _number_columns(len(cells))
    if len(names) != len(cells):
        return flat
    header = []
    for name, cell in zip(names, cells, strict=True):
        count = len(cell.replace(',', ' ').split())
        letters = {3: 'xyz', 4: 'xyzw'}.get(count, '')
        header += [name] if count < 2 else [f'{name}.{one}' for one in letters] or [
            f'{name}[{i}]' for i in range(count)]  # fmt: skip
    return flat.model_copy(update={'lists': True, 'header': header, 'skip': len(before)})


def _detect_lines(path: Path, lines: Sequence[str]) -> TextFormat:
    """Return the format of lines of single cells."""
    row_counts = {
        (name, decimal): _count_rows(lines, mark, decimal)
        for decimal in DECIMALS
        for name, mark in DELIMITERS.items()
        if name != decimal or any('"' in line for line in lines)
    }
    # By rows, then by how many more cells are numbers than not: a comma may be either mark
    (delimiter, decimal), (rows, _, cells) = max(row_counts.items(), key=lambda one: one[1])
    if rows < 2:
        raise BadInput(
            f"'{path}' has no two lines with equally many numbers between commas, semicolons, "
            'tabs, bars or spaces; give a text with columns of numbers.'
        )
    check_column_count(path, cells)
    mark = DELIMITERS[delimiter]
    are_rows = [_is_row(line, mark, decimal, cells) for line in lines]
    # A single row of numbers before the names is that of a preamble, such as the number of frames
    pairs = (i for i in range(len(lines) - 1) if are_rows[i] and are_rows[i + 1])
    first = next(pairs, are_rows.index(True))
    before = [i for i in range(first) if lines[i].strip()]
    marks = [start for i in before if (start := lines[i].lstrip()[0]) in COMMENTS]
    comment = marks[0] if marks else None
    names = _find_names([lines[i] for i in before], delimiter, cells)
    if names is None and lines[first].strip().endswith(delimiter):
        # Not a delimiter at the end of the rows, but a last column without values
        names = _find_names([lines[i] for i in before], delimiter, cells + 1)
        cells += names is not None
    plain = [i for i in before if lines[i].lstrip()[:1] not in COMMENTS]
    if names is not None and _are_units(names):
        above = _find_names([lines[i] for i in before[:-1]], delimiter, cells)
        # The mapping lists the names, as no single line has both
        if above is not None:
            names = [_add_unit(name, unit) for name, unit in zip(above, names, strict=True)]
            before = []
    stated = read_statements(path)
    if bodies := [*filter(None, stated.get('bodies', '').split('\t'))]:
        if names is None and cells == 3 * len(bodies):
            names = [f'{body} {axis}' for body in bodies for axis in 'XYZ']
        names = names and _add_stated_units(stated, _name_bodies(names, bodies))
        before = []
    elif joined := _join_lines_of_names([lines[i] for i in plain], mark, cells):
        # The mapping lists them, too
        names, before = _add_stated_units(stated, joined), []
    # The line with the names is read by its position, unless it is a comment or not there
    if names is not None and before and plain and plain[-1] == before[-1]:
        return TextFormat(
            delimiter=delimiter, decimal=decimal, comment=comment, skip=len(plain) - 1
        )
    if names is None:
        names = TUM if cells == len(TUM) and mark is None else _number_columns(cells)
        if cells > len(ECHOED_STAMP) and _is_echoed(split_cells(lines[first], mark)):
            names = ECHOED.get(cells, [*ECHOED_STAMP, *names[len(ECHOED_STAMP) :]])
    return TextFormat(
        delimiter=delimiter, decimal=decimal, comment=comment, skip=len(plain), header=names
    )


def split_cells(line: str, mark: str | None) -> list[str]:
    """Return the stripped cells of a line; `mark` None stands for white space."""
    bare = line.strip()
    if '"' in bare:
        cells = split_quoted(bare, mark or ' ')
    else:
        cells = [cell.strip() for cell in bare.split(mark)]
    # A delimiter at the end of a line
    return cells[:-1] if mark in (',', ';', '\t') and cells and not cells[-1] else cells


def _is_echoed(cells: Sequence[str]) -> bool:
    """Return whether a row begins as a stamped message: whole seconds and nanoseconds, a frame."""
    whole = cells[0].isdigit() and cells[1].isdigit() and int(cells[1]) < 10**9
    return whole and not _is_number(cells[2])


def _read_lines(path: Path) -> list[str]:
    """Return the first lines."""
    head = read_text(path, HEAD_LINES)
    lines = head.decode(errors='replace').split('\n')
    # The end of a head is cut off, and that of a text has no line behind it
    if len(head) >= HEAD_LINES or not lines[-1]:
        lines = lines[:-1]
    return lines[:DIALECT_LINES]


def _split_numbers(line: str, mark: str | None, decimal: str) -> list[str]:
    """Return the cells of a line with points as decimal marks."""
    number, between = THOUSANDS[decimal]
    cells = (
        cell.replace(between, '') if number.fullmatch(cell) else cell
        for cell in split_cells(line, mark)
    )
    return [cell.replace(decimal, '.') for cell in cells]


def _count_rows(lines: Sequence[str], mark: str | None, decimal: str) -> tuple[int, int, int]:
    """Return the rows of the most frequent length, numbers less other cells, and that length."""
    split = [_split_numbers(line, mark, decimal) for line in lines]
    table = [cells for cells in split if cells and _are_numbers(cells)]
    if not table:
        return 0, 0, 0
    counts = Counter(map(len, table))
    count, rows = max(counts.items(), key=lambda one: (one[1], one[0]))
    numbers = list(map(_is_number, chain.from_iterable(table)))
    return rows, 2 * sum(numbers) - len(numbers), count


def _is_row(line: str, mark: str | None, decimal: str, count: int) -> bool:
    cells = _split_numbers(line, mark, decimal)
    return len(cells) == count and _are_numbers(cells)


def _are_numbers(cells: Sequence[str]) -> bool:
    """Return whether cells are numbers: one at least, and a date or an empty cell beside it."""
    numbers = sum(_is_number(cell) for cell in cells)
    words = sum(cell not in EMPTY_CELLS and not _is_number(cell) for cell in cells)
    return numbers > 0 and numbers >= words


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return True


def _find_names(before: Sequence[str], delimiter: str, cells: int) -> list[str] | None:
    """Return the names of the columns, from the last line with as many."""
    for line in reversed(before):
        text = line.strip().lstrip(COMMENTS).strip()
        for mark in (DELIMITERS[delimiter], ',', ';', '\t', None):
            names = split_cells(text, mark)
            if len(names) == cells and not any(map(_is_number, names)):
                return _make_unique(names)
    return None


def _join_lines_of_names(lines: Sequence[str], mark: str | None, cells: int) -> list[str]:
    """
    Return names that are written in several lines, as a tracker does: Body / Position / X.

    Empty if the last line names each column by itself.
    """
    split = [
        [cell.strip().strip('"') for cell in line.strip('\r\n').split(mark)] for line in lines
    ]
    # A line that names bodies may end with the name of the last one
    rows = [
        row + [''] * (cells - len(row))
        for row in reversed(split)
        if (len(row) == cells or (1 < len(row) < cells and not row[0]))
        and not any(map(_is_number, row))
    ]
    units = rows.pop(0) if len(rows) > 1 and _are_units(rows[0]) else [''] * cells
    if not rows or _are_units(rows[0]) or len({*filter(None, rows[0])}) == sum(map(bool, rows[0])):
        return []
    names = rows[0]
    for above, higher in zip(rows[1:], [*rows[2:], []], strict=False):
        words = _spread(above, names)
        filled = [name for name in names if name]
        # Identifiers tell columns apart, but mean nothing to a reader
        are_same = len({*filled}) < len(filled)
        if are_same and not _divide_alike(words, higher) and 'ID' not in words[:2]:
            # A word that stands once labels the line, and not a column with a name
            names = [
                f'{word} {name}'.strip() if not name or words.count(word) > 1 else name
                for word, name in zip(words, names, strict=True)
            ]
    return [_add_unit(name, unit) for name, unit in zip(_make_unique(names), units, strict=True)]


def _spread(words: Sequence[str], names: Sequence[str]) -> list[str]:
    """Return the words of a line, each also above the columns up to the next word."""
    if not any(word and names.count(name) > 1 for word, name in zip(words, names, strict=True)):
        return [*words]
    spread: list[str] = []
    for word, name in zip(words, names, strict=True):
        goes_on = not word and names.count(name) > 1 and spread
        spread.append(spread[-1] if goes_on else word)
    return spread


def _divide_alike(ids: Sequence[str], names: Sequence[str]) -> bool:
    """Return whether the line above divides the columns in the same way, by names."""
    pairs = {*zip(ids, names, strict=False)} - {('', '')}
    one_to_one = len(pairs) == len({one for one, _ in pairs}) == len({two for _, two in pairs})
    return len({*names}) > 2 and one_to_one


def read_statements(path: Path) -> dict[str, str]:
    """
    Return what a tracker's file states before its columns.

    'length': unit of lengths; 'sequence': of the angles about x, y and z; 'rate': rows per second;
    'bodies': their names, with a tab between; 'elements': 'by column' of a rotation matrix. Motive
    writes names and values in turn in the first line, QTM a name and its values in each line, and
    Vicon the rate in a line of its own.
    """
    lines = [line.strip() for line in _read_lines(path)]
    cells = split_cells(lines[0], ',') if lines else []
    pairs = dict(zip(cells[::2], cells[1::2], strict=False))
    stated = {
        'length': LENGTH_UNITS.get(pairs.get('Length Units', '').lower(), ''),
        'sequence': pairs.get('Rotation Type', ''),
        'rate': pairs.get('Export Frame Rate', ''),
    }
    if sorted(stated['sequence']) != [*'XYZ']:
        del stated['sequence']
    if cells and len(cells) == 1 and cells[0] in VICON_SECTIONS and len(lines) > 1:
        stated['rate'] = lines[1].strip(',')
    if lines and lines[0].startswith('NO_OF_FRAMES'):
        keys = dict(line.split('\t', 1) for line in lines if '\t' in line)
        names = keys.get('BODY_NAMES') or keys.get('MARKER_NAMES', '')
        # As QTM exports: mm, degrees about x, y and z of the body
        stated |= {'length': 'mm', 'sequence': 'XYZ', 'elements': 'by column', 'bodies': names,
                   'rate': keys.get('FREQUENCY', '')}  # fmt: skip
    if not _is_number(stated['rate']):
        del stated['rate']
    return {key: value for key, value in stated.items() if value}


def _name_bodies(names: Sequence[str], bodies: Sequence[str]) -> list[str]:
    """Return names that begin with their body, which QTM writes only before the first of each."""
    body, named = '', []
    for name in names:
        owners = [one for one in bodies if name.startswith(f'{one} ')]
        body = max(owners, key=len, default=body)
        bare = re.sub(r' \(\d+\)$', '', name)
        named.append(name if owners or not body else f'{body} {bare}')
    return _make_unique(named)


def _add_stated_units(stated: Mapping[str, str], names: Sequence[str]) -> list[str]:
    """Return the names of a tracker's columns with the units that its file states."""
    length, turned = stated.get('length', ''), 'deg' if 'sequence' in stated else ''
    units = {'Position': length, 'Rotation': turned}
    if 'bodies' in stated:
        units = dict.fromkeys('XYZ', length) | dict.fromkeys(('Roll', 'Pitch', 'Yaw'), turned)
    return [
        next((f'{name} [{unit}]' for word, unit in units.items() if unit and word in name.split()),
             name)
        for name in names
    ]  # fmt: skip


def _make_unique(names: Sequence[str]) -> list[str]:
    unique: list[str] = []
    for index, name in enumerate(names):
        label = name or f'unnamed {index + 1}'
        unique.append(label if label not in unique else f'{label} ({index + 1})')
    return unique


def _are_units(names: Sequence[str]) -> bool:
    """Return whether most cells of a line are known units, and two of them at least."""
    filled = [unit for unit in map(_bare_unit, names) if unit]
    count = sum(unit in UNIT_WORDS for unit in filled)
    return count >= 2 and 2 * count > len(filled)


def _bare_unit(cell: str) -> str:
    """Return a unit without brackets, or without the number that makes a name unique."""
    return re.sub(r' \(\d+\)$|^unnamed \d+$', '', cell).strip('[]() -').lower()


def _add_unit(name: str, unit: str) -> str:
    bare = _bare_unit(unit)
    return f'{name} [{bare}]' if bare in UNIT_WORDS else name


def _number_columns(cells: int) -> list[str]:
    return [f'column_{index + 1}' for index in range(cells)]
