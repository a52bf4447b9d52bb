"""Rows of the paper from their files to what was found: kept as they end, taken up again."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
import shutil
import time
from typing import final

from lta_config.errors import BadInput, unknown_name
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

ROWS = 'rows'  # folder of what is kept
BAGS = 'bags'


@final
@dataclass(frozen=True, slots=True)
class ReproductionRequest:
    """Which rows, with how much effort, into which folder, by how many processes."""

    names: tuple[str, ...]
    quick: bool
    folder: Path
    workers: int

    def row_path(self, name: str) -> Path:
        """Return where a row is kept."""
        return self.folder / ROWS / f'{name}.json'


def select_rows(names: Sequence[str]) -> list[PaperRow]:
    """Return some rows, or all of them; an unknown name is a `BadInput` that lists the known."""
    rows = [row for row in load_paper_rows() if row.name in STUDIES]
    for name in names:
        if name not in [row.name for row in rows]:
            raise unknown_name('row', name, [row.name for row in rows])
    return [row for row in rows if not names or row.name in names]


def seed_count(row: PaperRow, quick: bool) -> int:
    """Return with how many seeds a row is studied."""
    return row.seeds.quick if quick else row.seeds.full


def compute_row_key(row: PaperRow, quick: bool) -> str:
    """Return the hash of what decides a row here and now."""
    return hash_row(row, seed_count(row, quick), quick, hash_sources(row.name))


def read_stored_rows(order: ReproductionRequest, rows: Sequence[PaperRow]) -> dict[str, StoredRow]:
    """Return the rows that have been studied already."""
    found = {
        row.name: read_row(order.row_path(row.name), compute_row_key(row, order.quick))
        for row in rows
    }
    return {name: kept for name, kept in found.items() if kept is not None}


def study_row(name: str, quick: bool, folder: Path) -> StoredRow:
    """Study one row; `BadInput` if what it measures is not what its file declares."""
    row = load_paper_row(name)
    begun = time.monotonic()
    seeds = seed_count(row, quick)
    bags = folder / BAGS / name
    shutil.rmtree(bags, ignore_errors=True)  # of flights that what has changed may fly otherwise
    found = STUDIES[name](RowStudyRequest(seeds, quick, bags))
    undeclared = found.values.keys() - row.measures.keys()
    lacking = row.measures.keys() - found.values.keys()
    if undeclared or (lacking and not quick):
        names = ', '.join(sorted(undeclared or lacking))
        raise BadInput(f'The study of {name} and its file differ in what is measured: {names}.')
    return build_stored_row(found, seeds, time.monotonic() - begun)


def study_all(
    order: ReproductionRequest, todo: Sequence[PaperRow]
) -> Iterator[tuple[str, StoredRow]]:
    """Yield rows as they are studied, each kept before it is told of."""
    asked = [(row.name, order.quick, order.folder) for row in todo]
    keys = {row.name: compute_row_key(row, order.quick) for row in todo}
    for name, kept in run_in_workers(
        _study_with_name, asked, order.workers, '--workers', goes_on=True
    ):
        write_row(order.row_path(name), keys[name], kept)
        yield name, kept


def _study_with_name(name: str, quick: bool, folder: Path) -> tuple[str, StoredRow]:
    """Study one row, and say which it was."""
    return name, study_row(name, quick, folder)
