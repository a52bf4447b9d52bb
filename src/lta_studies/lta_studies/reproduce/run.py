"""Rows of the paper from their files to what was found: kept as they end, taken up again."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
import shutil
import time
from typing import final

from lta_config.errors import BadInput, unknown
from lta_config.schema.paper_file import load_paper_row, paper_rows, PaperRow
from lta_report.children import done_by
from lta_studies.reproduce.found import Asked
from lta_studies.reproduce.kept import identity, Kept, kept_of, read, write
from lta_studies.reproduce.registry import STUDIES
from lta_studies.reproduce.sources import digest

ROWS = 'rows'  # folder of what is kept
BAGS = 'bags'


@final
@dataclass(frozen=True, slots=True)
class Order:
    """Which rows, with how much effort, into which folder, by how many processes."""

    names: tuple[str, ...]
    quick: bool
    folder: Path
    workers: int

    def place(self, name: str) -> Path:
        """Return where a row is kept."""
        return self.folder / ROWS / f'{name}.json'


def rows_of(names: Sequence[str]) -> list[PaperRow]:
    """Return some rows, or all of them; an unknown name is a `BadInput` that lists the known."""
    rows = [row for row in paper_rows() if row.name in STUDIES]
    for name in names:
        if name not in [row.name for row in rows]:
            raise unknown('row', name, [row.name for row in rows])
    return [row for row in rows if not names or row.name in names]


def seeds_of(row: PaperRow, quick: bool) -> int:
    """Return with how many seeds a row is studied."""
    return row.seeds.quick if quick else row.seeds.full


def key(row: PaperRow, quick: bool) -> str:
    """Return the hash of what decides a row here and now."""
    return identity(row, seeds_of(row, quick), quick, digest(row.name))


def known_rows(order: Order, rows: Sequence[PaperRow]) -> dict[str, Kept]:
    """Return the rows that have been studied already."""
    found = {row.name: read(order.place(row.name), key(row, order.quick)) for row in rows}
    return {name: kept for name, kept in found.items() if kept is not None}


def study_row(name: str, quick: bool, folder: Path) -> Kept:
    """Study one row; `BadInput` if what it measures is not what its file declares."""
    row = load_paper_row(name)
    begun = time.monotonic()
    seeds = seeds_of(row, quick)
    bags = folder / BAGS / name
    shutil.rmtree(bags, ignore_errors=True)  # of flights that what has changed may fly otherwise
    found = STUDIES[name](Asked(seeds, quick, bags))
    undeclared = found.values.keys() - row.measures.keys()
    lacking = row.measures.keys() - found.values.keys()
    if undeclared or (lacking and not quick):
        names = ', '.join(sorted(undeclared or lacking))
        raise BadInput(f'The study of {name} and its file differ in what is measured: {names}.')
    return kept_of(found, seeds, time.monotonic() - begun)


def study_all(order: Order, todo: Sequence[PaperRow]) -> Iterator[tuple[str, Kept]]:
    """Yield rows as they are studied, each kept before it is told of."""
    asked = [(row.name, order.quick, order.folder) for row in todo]
    keys = {row.name: key(row, order.quick) for row in todo}
    for name, kept in done_by(_named, asked, order.workers, '--workers', goes_on=True):
        write(order.place(name), keys[name], kept)
        yield name, kept


def _named(name: str, quick: bool, folder: Path) -> tuple[str, Kept]:
    """Study one row, and say which it was."""
    return name, study_row(name, quick, folder)
