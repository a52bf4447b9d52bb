"""Read any source for a draft: its format, its tables, and whether a folder holds runs."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import final, NamedTuple

from lta_config.errors import BadInput
from lta_config.schema.import_file import TextFormat
from lta_data.bag.bag_folder import find_bag
from lta_data.importers.draft.bag_topics import count_changing_commands
from lta_data.importers.formats import detect_format
from lta_data.importers.readers.column_log import Column
from lta_data.importers.readers.sensor_folder import (
    describe_empty_files,
    list_run_files,
    list_run_folders,
    read_folder,
    read_table_file,
    read_text_file,
)
from lta_data.importers.readers.text_dialect import detect_text_format, read_statements
from lta_report.formatting import format_count

COLUMNS = ('csv', 'mat', 'numpy', 'parquet', 'folder')  # formats without meanings of their own
LOOKED_AT = 10  # runs of a folder, the longest ones


@final
class SourceTables(NamedTuple):
    """A source."""

    path: Path  # the file that was read: of a folder with runs, the one that says most
    format: str
    tables: dict[str, dict[str, Column]]  # empty for a format whose names have fixed meanings
    text: TextFormat | None  # how the lines of a text are written
    notes: list[str]  # remarks, one sentence each
    stated: Mapping[str, str] = MappingProxyType({})  # by the file: the sequence of its angles


def read_source(source: Path) -> SourceTables:
    """Read a source; raise BadInput if it is of no known format."""
    path = find_bag(source)
    format_ = detect_format(path)
    empty = describe_empty_files(path)
    if format_ == 'folder':
        if folders := list_run_folders(path):
            note = f'The {len(folders)} folders of {source.name} are runs with the same tables.'
            return _read_richest_run(folders, note)
        files = list_run_files(path)
        kinds = {detect_format(file) for file in files}
        if len(files) == 1 or (len(kinds) == 1 and _have_same_columns(files)):
            runs = 'is one run' if len(files) == 1 else 'are runs with the same columns'
            note = f'The {format_count(len(files), "file")} of {source.name} {runs}.'
            return _read_richest_run(files, note, *empty)
        if not kinds <= {*COLUMNS}:
            raise BadInput(
                f"Folder '{source}' has files of different formats ({', '.join(sorted(kinds))}), "
                'which cannot be one log; give a file of it.'
            )
    if format_ not in COLUMNS:
        return SourceTables(path, format_, {}, None, [])
    if format_ == 'csv':
        tables, notes = read_text_file(path)
        text = detect_text_format(path)
        return SourceTables(path, format_, tables, text, notes, read_statements(path))
    tables, notes = read_folder(path) if format_ == 'folder' else read_table_file(path)
    return SourceTables(path, format_, tables, None, [*empty, *notes])


def _read_richest_run(runs: Sequence[Path], *notes: str) -> SourceTables:
    """Return the run in which most columns change: one without commands says little of them."""
    longest = sorted(runs, key=measure_size, reverse=True)[:LOOKED_AT]
    richest = max((read_source(run) for run in longest), key=count_changing_columns)
    drafted = [f'Drafted from {richest.path.name}, in which most columns change.']
    more = drafted if richest.tables and len(runs) > 1 else []
    return richest._replace(notes=[*notes, *more, *richest.notes])


def count_changing_columns(source: SourceTables) -> int:
    """Return the number of columns with more than one value; of a bag, those of its commands."""
    if source.format == 'bag':
        return count_changing_commands(source.path)
    return sum(
        bool(len(column) and (column != column[0]).any())
        for table in source.tables.values()
        for column in table.values()
    )


def measure_size(path: Path) -> int:
    """Return the size of a log, which may be a folder of files. [bytes]"""
    files = path.rglob('*') if path.is_dir() else [path]
    return sum(file.stat().st_size for file in files if file.is_file())


def _have_same_columns(files: list[Path]) -> bool:
    """Return whether files are runs of one kind; the first two and the last decide."""
    if detect_format(files[0]) not in COLUMNS:
        return True
    looked_at = {files[0], files[1], files[-1]}
    names = {
        tuple((name, *table) for name, table in read_table_file(file)[0].items())
        for file in looked_at
    }
    return len(names) == 1
