"""lta reproduce: repeat the experiments of the seed paper and check its claims."""

from collections.abc import Sequence
from pathlib import Path
import sys
from typing import Annotated

from lta_cli.options.plain_console import plain_console
from lta_cli.options.study_command import study_command, StudyRun
from lta_config.schema.paper_file import PaperRow
from lta_report.progress_bar import ProgressBar
from lta_report.report import Report, TextTable
from lta_report.report_terminal import print_table
from lta_studies.platforms.run import count_processors
from lta_studies.reproduce.report import build_report, format_markdown_page
from lta_studies.reproduce.row_store import StoredRow
from lta_studies.reproduce.run import (
    read_stored_rows,
    ReproductionRequest,
    seed_count,
    select_rows,
    study_all,
)
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, TextColumn, TimeElapsedColumn
import typer

LIST_HEADS = ('name', 'row', 'seeds', 'quick', 'claims', 'defects')


@study_command('paper', resumes=True)
def reproduce(
    names: Annotated[
        list[str] | None,
        typer.Argument(
            help='Names of the experiments to reproduce, as shown by --list; all by default.'
        ),
    ] = None,
    listed: Annotated[bool, typer.Option('--list', help='List the experiments and exit.')] = False,
    quick: Annotated[
        bool,
        typer.Option(
            '--quick', help='Use few seeds and skip long experiments; takes under 3 minutes.'
        ),
    ] = False,
    workers: Annotated[
        int | None,
        typer.Option(help='Number of worker processes; one per processor by default.', min=1),
    ] = None,
    as_markdown: Annotated[bool, typer.Option('--markdown', help='Print docs/paper.md.')] = False,
    *,
    run: StudyRun,
) -> Report:
    """
    Repeat every experiment of the seed paper; report what agrees, what differs, and why.

    A row is a file in config/paper with the paper's claims, their location in the paper, the
    measured quantities, and the acceptance rule, fixed in advance. All rows use the same vehicle,
    gains, lamp and room; exceptions are listed.

    Finished rows are stored in the folder of the results, runs/paper (with --quick
    runs/paper-quick) by default, and repeating the command resumes. A change of the code or of a
    row's file reruns the rows that it affects.

    Writes a page, paper.json (SI units) and bags of the plotted flights.

    Exit status 0: done, whatever agrees. 2: bad input. 130: Ctrl-C.

    Example: lta reproduce --quick
    """
    if as_markdown:
        # stdout holds only the Markdown page
        run.console = plain_console(stderr=True)
    rows = select_rows(names or [])
    if listed:
        print_table(build_row_table(rows), run.console)
        raise typer.Exit
    # No time in the name, so that repeating the command resumes
    folder = run.open_folder(Path('runs') / ('paper-quick' if quick else 'paper'))
    order = ReproductionRequest(
        tuple(row.name for row in rows), quick, folder, workers or count_processors()
    )
    report = build_report(rows, collect_row_results(order, rows, run.console))
    if as_markdown:
        sys.stdout.write(format_markdown_page(report))
    return report


def collect_row_results(
    order: ReproductionRequest, rows: Sequence[PaperRow], console: Console
) -> dict[str, StoredRow]:
    """Return the results of all rows: stored ones, and new ones for the rest."""
    kepts = read_stored_rows(order, rows)
    todo = [row for row in rows if row.name not in kepts]
    columns = (
        TextColumn('{task.description}'), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn()
    )  # fmt: skip
    with ProgressBar(console, *columns, begin='the paper', total=len(rows)) as bar:
        # Stored rows count as done
        bar.update_bar(advance=len(kepts))
        for name, kept in study_all(order, todo):
            kepts[name] = kept
            bar.update_bar(advance=1, description=name)
            # In a log file, the bar itself prints lines
            if console.is_terminal:
                bar.show_message(f'{name}: {kept.seconds:.0f} s')
    return kepts


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
