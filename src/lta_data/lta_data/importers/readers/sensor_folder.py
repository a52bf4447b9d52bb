# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Read a folder with one file for each sensor: each file is a table."""

from contextlib import suppress
from pathlib import Path

from lta_config.errors import BadInput, check_printable
from lta_data.importers.readers.array_files import (
    detect_arrays,
    READ,
    read_mat_file,
    read_numpy_file,
    read_parquet_file,
)
from lta_data.importers.readers.column_log import Column
from lta_data.importers.readers.csv_text import Cells, decode_cell, read_cells, read_column_names
from lta_data.importers.readers.text_dialect import detect_text_format
import numpy as np
import pyarrow as pa
import pyarrow.compute as pc

READERS = {'mat': read_mat_file, 'numpy': read_numpy_file, 'parquet': read_parquet_file}
ARRAYS = ('.mat', '.npy', '.npz', '.parquet')
RUN_ENDINGS = ('.ulg', '.bin', '.bag', '.mcap', '.db3')  # further formats with one run in a file
HEAD_BYTES = 1024
TEXTS = ('.csv', '.txt', '.tsv', '.dat', '.log')


def read_text_file(path: Path) -> READ:
    """Read a text with columns completely, in whatever dialect it is."""
    text = detect_text_format(path)
    cells, notes = read_cells(path, text, read_column_names(path, text))
    columns = {name: _to_numbers(one) for name, one in cells.items()}
    _refuse_second_names(path, cells, columns)
    return {'': {name: cells for name, cells in columns.items() if cells is not None}}, notes


def read_folder(path: Path) -> READ:
    """
    Read all data files of a folder, also in folders inside it.

    A table has the name of its file without the suffix; 'imu0/data.csv' is 'imu0'.

    Raise `BadInput` if a file cannot be read, or there is none.
    """
    tables: dict[str, dict[str, Column]] = {}
    notes: list[str] = []
    for file in list_data_files(path):
        file_tables, remarks = read_table_file(file)
        base = name_table(path, file)
        for name, columns in file_tables.items():
            tables[f'{base}.{name}' if name else base] = columns
        notes += [f'{base}: {remark}' for remark in remarks]
    if not tables:
        raise BadInput(
            f"Folder '{path}' contains no data file ({', '.join((*TEXTS, *ARRAYS))}) and no bag; "
            'give a folder of logs.'
        )
    return tables, notes


def read_table_file(path: Path) -> READ:
    """Read one file of columns."""
    with path.open('rb') as stream:
        kind = detect_arrays(stream.read(HEAD_BYTES), path.suffix.lower())
    return READERS.get(kind or '', read_text_file)(path)


def list_data_files(path: Path) -> list[Path]:
    """Return the files of a folder that can be tables, sorted; hidden ones do not count."""
    return _list_files(path, (*TEXTS, *ARRAYS))


def list_run_files(path: Path) -> list[Path]:
    """Return the logs in a folder, sorted; hidden ones do not count."""
    return _list_files(path, (*TEXTS, *ARRAYS, *RUN_ENDINGS))


def list_run_folders(path: Path) -> list[Path]:
    """Return the folders in a folder that hold one run each, with the same tables; else none."""
    folders = [one for one in sorted(path.iterdir()) if one.is_dir() and one.name[0] != '.']
    files = [list_run_files(folder) for folder in folders]
    names = {tuple(str(file.relative_to(folder)) for file in inside)
             for folder, inside in zip(folders, files, strict=True)}  # fmt: skip
    several = len(folders) > 1 and len(names) == 1 and len(files[0]) > 1
    if not several or len(list_run_files(path)) > sum(map(len, files)):
        return []
    # The imu0 and the cam0 of one run also have files of the same names
    return folders if _list_columns(folders[0]) == _list_columns(folders[-1]) else []


def _list_columns(folder: Path) -> list[list[str]]:
    """Return the names of the columns of all texts in a folder."""
    texts = [file for file in list_data_files(folder) if _suffix(file) in TEXTS]
    return [read_column_names(file, detect_text_format(file)) for file in texts]


def describe_empty_files(path: Path) -> list[str]:
    """Return a sentence on the files in a folder that hold no rows, if others do."""
    if not path.is_dir():
        return []
    used = list_run_files(path)
    names = [
        file.name
        for file in _find_files(path, (*TEXTS, *ARRAYS, *RUN_ENDINGS))
        if file not in used
    ]
    return [f'Left out, as they hold no rows of numbers: {", ".join(names)}.'] if names else []


def _list_files(path: Path, suffixes: tuple[str, ...]) -> list[Path]:
    """Return the files that hold something, but all if none does, whose fault is then told."""
    files = _find_files(path, suffixes)
    return [file for file in files if _has_rows(file)] or files


def _find_files(path: Path, suffixes: tuple[str, ...]) -> list[Path]:
    inside = (file for file in path.rglob('*') if file.is_file() and file.name[0] != '.')
    files = sorted(file for file in inside if _suffix(file) in suffixes)
    for file in files:
        check_printable(str(file.relative_to(path)))
    return files


def _has_rows(file: Path) -> bool:
    """Return whether a file holds data: neither a failed recording nor notes."""
    if _suffix(file) not in TEXTS:
        return file.stat().st_size > 0
    try:
        detect_text_format(file)
    except BadInput:
        return False
    return True


def name_table(folder: Path, file: Path) -> str:
    """Return the table of a file: its name, or that of its folder if all are called 'data'."""
    inside = file.relative_to(folder)
    stem = inside.name.split('.')[0]
    parts = [*inside.parts[:-1]] + ([] if stem == 'data' and len(inside.parts) > 1 else [stem])
    return '/'.join(parts)


def _suffix(file: Path) -> str:
    return file.with_suffix('').suffix.lower() if file.suffix == '.gz' else file.suffix.lower()


def _to_numbers(cells: pa.ChunkedArray) -> Column | None:
    """Return a column as numbers, as texts if they are dates, or None if most are words."""
    texts = pc.utf8_trim_whitespace(cells.cast(pa.string()))
    texts = pc.if_else(pc.equal(texts, ''), None, texts)
    for kind in (pa.float64(),) if texts.null_count else (pa.int64(), pa.float64()):
        with suppress(pa.ArrowInvalid):
            return np.asarray(pc.cast(texts, kind).to_numpy())
    numbers = np.array([_parse(cell) for cell in texts.to_pylist()])
    if np.isfinite(numbers).mean() > 0.5:
        return numbers
    return np.array([cell or '' for cell in texts.to_pylist()])


def _refuse_second_names(
    path: Path, texts: dict[str, Cells], columns: dict[str, Column | None]
) -> None:
    """Raise BadInput if a row in the middle has names instead of numbers: another log begins."""
    numbers = [name for name, cells in columns.items() if cells is not None
               and cells.dtype.kind == 'f']  # fmt: skip
    lost = [np.isnan(np.asarray(columns[name])) for name in numbers]
    if len(numbers) < 2 or 2 * len(numbers) < len(columns):
        return
    for row in np.flatnonzero(np.logical_and.reduce(lost)).tolist():
        cells = [decode_cell(texts[name][row].as_py()).strip() for name in numbers]
        if all(cell[:1].isalpha() and cell.lower() != 'nan' for cell in cells):
            raise BadInput(
                f"Row {row + 1} of '{path}' has names instead of numbers ({', '.join(cells)}): "
                'another log begins there. Split the file, and import each part.'
            )


def _parse(cell: str | None) -> float:
    try:
        return float(cell or 'nan')
    except ValueError:
        return float('nan')
