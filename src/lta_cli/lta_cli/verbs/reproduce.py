"""lta reproduce: repeat the experiments of the seed paper and check its claims."""

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

from lta_cli.options.common_options import folder_option
from lta_cli.options.study_command import study_command, StudyRun
from lta_config.errors import BadInput
from lta_config.schema.paper_file import PaperRow
from lta_report.report import Report, TextTable
from lta_report.report_terminal import print_table
from lta_studies.reproduce.paper_pages import write_pages
from lta_studies.reproduce.report import build_report
from lta_studies.reproduce.run import (
    reproduce_rows,
    ReproductionRequest,
    seed_count,
    select_rows,
)
import typer

LIST_HEADS = ('name', 'row', 'seeds', 'quick', 'claims', 'defects')


@study_command('paper', quick='Use few seeds and skip long experiments; takes under 3 minutes.')
def reproduce(
    names: Annotated[
        list[str] | None,
        typer.Argument(
            help='Names of the experiments to reproduce, as shown by --list; all by default.'
        ),
    ] = None,
    listed: Annotated[bool, typer.Option('--list', help='List the experiments and exit.')] = False,
    draws: Annotated[
        int | None,
        typer.Option(
            help='Number of draws of what is assumed; by default as in the files of the rows.',
            min=0,
            max=10_000,
        ),
    ] = None,
    markdown: Annotated[
        Path | None,
        folder_option(
            'Write paper.md, paper_rows.md and paper_inconsistencies.md into this folder.'
        ),
    ] = None,
    *,
    run: StudyRun,
) -> Report:
    """
    Repeat every experiment of the seed paper; report what agrees, what differs, and why.

    A row is a file in config/paper with the paper's claims, their location in the paper, the
    measured quantities, and the acceptance rule. All rows use the same vehicle, gains, lamp and
    room; exceptions are listed. What is assumed is drawn from the ranges in the files of vehicle,
    cells, lights and rows: a claim agrees or differs if surely 95 % of the draws do.

    Finished rows are stored in the folder of the results, runs/paper (with --quick
    runs/paper-quick) by default, and repeating the command resumes. A change of the code or of a
    row's file reruns the rows that it affects. With --scheduler, the workers write the bags of
    the plotted flights into this folder, so all machines must share it.

    Writes a page, paper.json (SI units) and bags of the plotted flights.

    Exit status 0: done, whatever agrees. 2: bad input. 130: Ctrl-C.

    Example: lta reproduce --quick
    """
    rows = select_rows(names or [])
    if markdown is not None and not markdown.is_dir():
        raise BadInput(f'There is no folder {markdown} for the pages; check the path.')
    if listed:
        print_table(build_row_table(rows), run.console)
        raise typer.Exit
    # No time in the name, so that repeating the command resumes
    folder = run.open_folder(Path('runs') / ('paper-quick' if run.quick else 'paper'))
    names = [row.name for row in rows]
    order = ReproductionRequest(tuple(names), run.quick, folder, run.options, draws)
    stored = reproduce_rows(order, rows, run.console)
    if markdown is not None:
        write_pages(markdown, rows, stored)
    return build_report(rows, stored)


def build_row_table(rows: Sequence[PaperRow]) -> TextTable:
    """Return the table of the available rows."""
    body = [
        [
            row.name, f'{row.number}. {row.title}', str(seed_count(row, False)),
            str(seed_count(row, True)), str(len(row.claims)), str(len(row.defects)),
        ]
        for row in rows
    ]  # fmt: skip
    return TextTable('Rows of the paper', LIST_HEADS, body)
