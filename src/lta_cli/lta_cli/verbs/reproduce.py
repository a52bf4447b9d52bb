"""lta reproduce: repeat the experiments of the seed paper and check its claims."""

from collections.abc import Sequence
from pathlib import Path
import sys
from typing import Annotated

from lta_cli.options.output_options import (
    check_picture_output,
    parse_folder,
    Pictures,
    print_json_text,
)
from lta_cli.options.plain_console import plain_console
from lta_cli.options.worker_options import RetryFailed, WorkerCount
from lta_config.command_line import format_lta_command, relative_path
from lta_config.schema.paper_file import PaperRow
from lta_report.results_folder import format_page_line, write_json
from lta_report.screenshots import write_pictures
from lta_report.study import StudyOptions
from lta_studies.energy.tables import print_table, TextTable
from lta_studies.reproduce import figures_file, lines, markdown
from lta_studies.reproduce.page import write_page
from lta_studies.reproduce.run import (
    reproduce_rows,
    ReproductionRequest,
    seed_count,
    select_rows,
)
import typer

LIST_HEADS = ('name', 'row', 'seeds', 'quick', 'claims', 'defects')


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
    out: Annotated[
        Path | None,
        typer.Option(
            help='Folder of the results; runs/paper or runs/paper-quick by default.',
            parser=parse_folder,
            metavar='FOLDER',
        ),
    ] = None,
    workers: WorkerCount = None,
    retry: RetryFailed = False,
    pictures: Pictures = None,
    as_markdown: Annotated[bool, typer.Option('--markdown', help='Print docs/paper.md.')] = False,
    json: Annotated[bool, typer.Option('--json', help='Print the results as JSON.')] = False,
) -> None:
    """
    Repeat every experiment of the seed paper; report what agrees, what differs, and why.

    A row is a file in config/paper with the paper's claims, their location in the paper, the
    measured quantities, and the acceptance rule, fixed in advance. All rows use the same vehicle,
    gains, lamp and room; exceptions are listed.

    Finished rows are stored, and repeating the command resumes. A change of the code or of a row's
    file reruns the rows that it affects.

    Writes a page, paper.json (SI units) and bags of the plotted flights.

    Exit status 0: done, whatever agrees. 2: bad input. 130: Ctrl-C.

    Example: lta reproduce --quick
    """
    # stdout holds only the JSON or the Markdown page
    console = plain_console(stderr=json or as_markdown)
    rows = select_rows(names or [])
    if listed:
        print_table(build_row_table(rows), console)
        return
    check_picture_output(pictures)
    # No time in the name, so that repeating the command resumes
    target = (out or Path('runs') / ('paper-quick' if quick else 'paper')).absolute()
    order = ReproductionRequest(
        tuple(row.name for row in rows), quick, target, StudyOptions(workers, retry_failed=retry)
    )
    kepts = reproduce_rows(order, rows, console)
    told = write_json(figures_file.encode_figures(rows, kepts), target / 'paper.json')
    # Command that repeats the run, shown on the page
    words = ['reproduce', *(names or []), *(['--quick'] if quick else [])]
    page = write_page(
        rows, kepts, {'Repeat this study': format_lta_command(*words)}, target / 'report.html'
    )
    if pictures is not None:
        write_pictures(page, pictures)
    if as_markdown:
        sys.stdout.write(markdown.format_markdown_page(rows, kepts))
    if json:
        print_json_text(told, page)
    print_table(
        TextTable(
            'Claims of the paper', lines.SUMMARY_HEADS, lines.build_summary_rows(rows, kepts)
        ),
        console,
    )
    console.print(lines.format_headline(rows, kepts), highlight=False, soft_wrap=True)
    console.print(
        format_page_line(relative_path(page)), highlight=False, markup=False, soft_wrap=True
    )


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
