# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Run the studies of the rows; store each result so that a later run can resume."""

from collections.abc import Sequence
from functools import cache, partial
import hashlib
from importlib.util import find_spec
from pathlib import Path
import time
from typing import Final, final

from lta_config.errors import BadInput, unknown_name_error
from lta_config.files import share_folder
from lta_config.schema.paper_file import DrawCounts, load_paper_row, load_paper_rows, PaperRow
from lta_report.report import Report, TextTable
from lta_report.request import argument, option, StudyRequest, StudyRun
from lta_report.study import Study
from lta_report.study_store import StoreFormat
from lta_studies.reproduce.studies import (
    beavis,
    cells,
    closed_loop,
    energy,
    forces,
    indoors,
    link,
    mounting,
    outdoors,
    photodiodes,
    platforms,
)
from lta_studies.reproduce.study_result import (
    build_stored_row,
    hash_row,
    RowStudy,
    RowStudyRequest,
    StoredRow,
)
from pydantic import TypeAdapter

# In the order of the paper
STUDIES: Final[dict[str, RowStudy]] = {
    'platforms': platforms.run_study,
    'forces': forces.run_study,
    'closed_loop': closed_loop.run_study,
    'beavis': beavis.run_study,
    'cells': cells.run_study,
    'mounting': mounting.run_study,
    'photodiodes': photodiodes.run_study,
    'link': link.run_study,
    'indoors': indoors.run_study,
    'outdoors': outdoors.run_study,
    'energy': energy.run_study,
}


# Packages on whose code the rows rest, and the folder of their own files
ROW_PACKAGES: Final = (
    'lta_config', 'lta_control', 'lta_energy', 'lta_flight', 'lta_model', 'lta_sim', 'lta_studies',
    'lta_vehicle', 'lta_vlc', 'lta_windtunnel',
)  # fmt: skip
ROW_FOLDER: Final = 'paper'
ROW_STORE: Final = StoreFormat('rows.jsonl', 'paper', 'reproduction', TypeAdapter(StoredRow))


@final
class ReproductionRequest(
    StudyRequest, command='reproduce', folder='paper',
    quick='Use few seeds and skip long experiments; takes under 3 minutes.',
):  # fmt: skip
    """
    Repeat every experiment of the seed paper; report what agrees, what differs, and why.

    A row is a file in config/paper with the paper's claims, their location in the paper, the
    measured quantities, and the acceptance rule. All rows use the same vehicle, gains, lamp and
    room; exceptions are listed. What is assumed is drawn from the ranges in the files of vehicle,
    cells, lights and rows: a claim agrees or differs if surely 95 % of the draws do.

    Finished rows are stored in the folder of the results, runs/paper (with --quick
    runs/paper-quick) by default, and repeating the command resumes. A change of the code reruns
    all rows, one of a row's file that row.

    Writes a page, on which each picture has the command that repeats it, and paper.json (SI
    units).

    Exit status 0: done, whatever agrees. 2: bad input. 130: Ctrl-C.

    Example: lta reproduce --quick
    """

    names: tuple[str, ...] = argument(
        'Names of the experiments to reproduce, as shown by --list; all by default.', default=()
    )
    listed: bool = option('List the experiments and exit.', default=False, name='list')
    draws: int | None = option(
        'Number of draws of what is assumed; by default as in the files of the rows.',
        default=None, low=0, high=10_000,
    )  # fmt: skip

    def run(self, run: StudyRun) -> Report:
        """Return the report of the rows, or their list."""
        from lta_studies.reproduce.report import build_report

        rows = select_rows(self.names)
        if self.listed:
            run.writes = False
            return list_rows(rows)
        # No time in the name, so that repeating the command resumes
        run.open_folder(Path('runs') / ('paper-quick' if self.quick else 'paper'))
        return build_report(rows, reproduce_rows(self, rows, run))


def list_rows(rows: Sequence[PaperRow]) -> Report:
    """Return the table of the available rows."""
    heads = ('name', 'row', 'seeds', 'quick', 'claims', 'defects')
    cells = [
        (
            row.name, f'{row.number}. {row.title}', seed_count(row, False), seed_count(row, True),
            len(row.claims), len(row.defects),
        )
        for row in rows
    ]  # fmt: skip
    table = TextTable('Rows of the paper', heads, [[*map(str, row)] for row in cells])
    data = {'rows': [dict(zip(heads, row, strict=True)) for row in cells]}
    return Report('reproduce', '', f'{len(rows)} rows.', '', [], [table], data)


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


@cache
def hash_sources() -> str:
    """Return a hash of all code and files that the rows rest on, but for the rows' own files."""
    paths = [path for kind in ('*.yaml', '*.json') for path in share_folder().rglob(kind)]
    for package in ROW_PACKAGES:
        spec = find_spec(package)
        assert spec is not None
        assert spec.origin is not None
        paths += Path(spec.origin).parent.rglob('*.py')
    digest = hashlib.sha256()
    for path in sorted(paths):
        if path.parent.name != ROW_FOLDER:
            # Folder and name rather than the full path, which differs between machines
            digest.update(f'{path.parent.name}/{path.name}'.encode())
            digest.update(path.read_bytes())
    return digest.hexdigest()


def compute_row_key(row: PaperRow, quick: bool) -> str:
    """Return the key of a row in the store: its name and the hash of its current inputs."""
    return row.name + ' ' + hash_row(row, seed_count(row, quick), quick, hash_sources())


def study_row(quick: bool, draws: int | None, name: str) -> StoredRow:
    """Study one row; raise `BadInput` if its measures differ from those of its file."""
    row = load_row(name, draws)
    begun = time.monotonic()
    seeds = seed_count(row, quick)
    count = row.draws.quick if quick else row.draws.full
    result = STUDIES[name](RowStudyRequest(seeds, quick, count, row.ranges))
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
    order: ReproductionRequest, rows: Sequence[PaperRow], run: StudyRun
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
        partial(study_row, order.quick, order.draws), keys.__getitem__, ROW_STORE,
        'rows', lambda name, row: f'{name}: {row.seconds:.0f} s',
    )  # fmt: skip
    # The keys contain the hash of everything that determines a row.
    return dict(zip(names, run.run_study(study, 'rows', names), strict=True))
