"""Run the studies of the rows; store each result so that a later run can resume."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
import shutil
import time
from typing import Final, final

from lta_config.errors import BadInput, unknown_name_error
from lta_config.schema.paper_file import DrawCounts, load_paper_row, load_paper_rows, PaperRow
from lta_report.line_log import LogKind
from lta_report.study import Study, StudyOptions
from lta_report.study_store import StoreFormat
from lta_studies.reproduce.registry import STUDIES
from lta_studies.reproduce.sources import hash_sources
from lta_studies.reproduce.stored_row import build_stored_row, hash_row, StoredRow
from lta_studies.reproduce.study_result import RowStudyRequest
from pydantic import TypeAdapter
from rich.console import Console

BAGS = 'bags'
STORE: Final = StoreFormat(
    LogKind('rows.jsonl', 'paper', 'reproduction', '--out'), TypeAdapter(StoredRow)
)


@final
@dataclass(frozen=True, slots=True)
class ReproductionRequest:
    """
    Options of a reproduction.

    `draws` replaces the number of draws of the rows' files.
    """

    names: tuple[str, ...]
    quick: bool
    folder: Path
    options: StudyOptions = field(default_factory=StudyOptions)
    draws: int | None = None


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


def load_row(name: str, draws: int | None) -> PaperRow:
    """Return a row, with another number of draws where it has any."""
    row = load_paper_row(name)
    if draws is None or not row.draws.full:
        return row
    return row.model_copy(update={'draws': DrawCounts(quick=draws, full=draws)})


def compute_row_key(row: PaperRow, quick: bool) -> str:
    """Return the key of a row in the store: its name and the hash of its current inputs."""
    return row.name + ' ' + hash_row(row, seed_count(row, quick), quick, hash_sources(row.name))


def study_row(quick: bool, folder: Path, draws: int | None, name: str) -> StoredRow:
    """Study one row; raise `BadInput` if its measures differ from those of its file."""
    row = load_row(name, draws)
    begun = time.monotonic()
    seeds = seed_count(row, quick)
    bags = folder / BAGS / name
    shutil.rmtree(bags, ignore_errors=True)  # recorded by an older version of the code
    count = row.draws.quick if quick else row.draws.full
    result = STUDIES[name](RowStudyRequest(seeds, quick, bags, count, row.ranges))
    undeclared = result.values.keys() - row.measures.keys()
    lacking = row.measures.keys() - result.values.keys()
    # --quick may leave out measures, but no study may add undeclared ones.
    if undeclared or (lacking and not quick):
        names = ', '.join(sorted(undeclared or lacking))
        raise BadInput(
            f'The measures computed for {name} and those listed in its file '
            f'config/paper/{name}.yaml differ: {names}. Correct the file or the study.'
        )
    return build_stored_row(row, result, seeds, time.monotonic() - begun)


def reproduce_rows(
    order: ReproductionRequest, rows: Sequence[PaperRow], console: Console
) -> dict[str, StoredRow]:
    """
    Study the rows whose current results are not stored; return the results of all.

    Raise `BadInput` if a study failed.
    """
    # Computed before the studies: a file edited meanwhile must invalidate the result.
    keys = {
        row.name: compute_row_key(load_row(row.name, order.draws), order.quick) for row in rows
    }
    names = list(keys)
    study = Study(
        partial(study_row, order.quick, order.folder, order.draws), keys.__getitem__, STORE,
        'rows', lambda name, row: f'{name}: {row.seconds:.0f} s',
    )  # fmt: skip
    # The keys contain the hash of everything that determines a row.
    outcome = study.run(names, order.folder, 'rows', order.options, console)
    return dict(zip(names, outcome.require_all(), strict=True))
