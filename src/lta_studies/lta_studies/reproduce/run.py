"""Run the studies of the rows; store each result so that a later run can resume."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
import shutil
import time
from typing import final

from lta_config.errors import BadInput, unknown_name_error
from lta_config.schema.paper_file import load_paper_row, load_paper_rows, PaperRow
from lta_report.worker_pool import run_in_workers
from lta_studies.reproduce.registry import STUDIES
from lta_studies.reproduce.row_store import (
    build_stored_row,
    hash_row,
    read_row,
    StoredRow,
    write_row,
)
from lta_studies.reproduce.sources import hash_sources
from lta_studies.reproduce.study_result import RowStudyRequest

ROWS = 'rows'  # folder of the stored rows
BAGS = 'bags'


@final
@dataclass(frozen=True, slots=True)
class ReproductionRequest:
    """Options of a reproduction."""

    names: tuple[str, ...]
    quick: bool
    folder: Path
    workers: int

    def row_path(self, name: str) -> Path:
        """Return the file of a stored row."""
        return self.folder / ROWS / f'{name}.json'


def select_rows(names: Sequence[str]) -> list[PaperRow]:
    """Return the named rows, by default all; raise `BadInput` for an unknown name."""
    rows = [row for row in load_paper_rows() if row.name in STUDIES]
    for name in names:
        if name not in [row.name for row in rows]:
            raise unknown_name_error('row', name, [row.name for row in rows])
    return [row for row in rows if not names or row.name in names]


def seed_count(row: PaperRow, quick: bool) -> int:
    """Return the number of seeds of a row."""
    return row.seeds.quick if quick else row.seeds.full


def compute_row_key(row: PaperRow, quick: bool) -> str:
    """Return the hash of the current inputs of a row."""
    return hash_row(row, seed_count(row, quick), quick, hash_sources(row.name))


def read_stored_rows(order: ReproductionRequest, rows: Sequence[PaperRow]) -> dict[str, StoredRow]:
    """Return the stored rows that are up to date."""
    found = {
        row.name: read_row(order.row_path(row.name), compute_row_key(row, order.quick))
        for row in rows
    }
    return {name: stored for name, stored in found.items() if stored is not None}


def study_row(name: str, quick: bool, folder: Path) -> StoredRow:
    """Study one row; raise `BadInput` if its measures differ from those of its file."""
    row = load_paper_row(name)
    begun = time.monotonic()
    seeds = seed_count(row, quick)
    bags = folder / BAGS / name
    shutil.rmtree(bags, ignore_errors=True)  # recorded by an older version of the code
    found = STUDIES[name](RowStudyRequest(seeds, quick, bags))
    undeclared = found.values.keys() - row.measures.keys()
    lacking = row.measures.keys() - found.values.keys()
    # --quick may leave out measures, but no study may add undeclared ones.
    if undeclared or (lacking and not quick):
        names = ', '.join(sorted(undeclared or lacking))
        raise BadInput(
            f'The measures computed for {name} and those listed in its file '
            f'config/paper/{name}.yaml differ: {names}. Correct the file or the study.'
        )
    return build_stored_row(found, seeds, time.monotonic() - begun)


def study_all(
    order: ReproductionRequest, todo: Sequence[PaperRow]
) -> Iterator[tuple[str, StoredRow]]:
    """Study rows in worker processes; store each row before yielding it."""
    tasks = [(row.name, order.quick, order.folder) for row in todo]
    # Hashed before the studies: a file edited meanwhile must invalidate the result.
    keys = {row.name: compute_row_key(row, order.quick) for row in todo}
    for name, stored in run_in_workers(
        _study_with_name, tasks, order.workers, '--workers', goes_on=True
    ):
        write_row(order.row_path(name), keys[name], stored)
        yield name, stored


def _study_with_name(name: str, quick: bool, folder: Path) -> tuple[str, StoredRow]:
    """Study one row and return it with its name."""
    return name, study_row(name, quick, folder)
