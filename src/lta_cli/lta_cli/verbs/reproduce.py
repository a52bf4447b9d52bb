"""lta reproduce: the seed paper, claim by claim."""

from collections.abc import Sequence
from pathlib import Path
import sys
from typing import Annotated

from lta_cli.options.json_option import print_kept_json
from lta_cli.options.out_option import folder
from lta_cli.options.pictures_option import can_be_taken, Pictures
from lta_cli.options.plain_console import plain_console
from lta_config.schema.paper_file import PaperRow
from lta_config.typed import near, typed
from lta_report.bar import Bar
from lta_report.results_folder import keep_json, page_line
from lta_report.screenshots import write_pictures
from lta_studies.energy.tables import show, Table
from lta_studies.platforms.run import processors
from lta_studies.reproduce import figures_file, lines, markdown
from lta_studies.reproduce.kept import Kept
from lta_studies.reproduce.page import write_page
from lta_studies.reproduce.run import known_rows, Order, rows_of, seeds_of, study_all
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, TextColumn, TimeElapsedColumn
import typer

LIST_HEADS = ('name', 'row', 'seeds', 'quick', 'claims', 'defects')


def reproduce(
    names: Annotated[list[str] | None, typer.Argument(help='Rows; all by default.')] = None,
    listed: Annotated[bool, typer.Option('--list', help='Tell the rows and run nothing.')] = False,
    quick: Annotated[
        bool, typer.Option('--quick', help='Few seeds, what is long left out: under 3 minutes.')
    ] = False,
    out: Annotated[
        Path | None,
        typer.Option(
            help='Folder of the results; runs/paper or runs/paper-quick by default.',
            parser=folder,
            metavar='FOLDER',
        ),
    ] = None,
    workers: Annotated[
        int | None, typer.Option(help='Processes; as many as processors by default.', min=1)
    ] = None,
    pictures: Pictures = None,
    as_markdown: Annotated[bool, typer.Option('--markdown', help='Print docs/paper.md.')] = False,
    json: Annotated[bool, typer.Option('--json', help='Print the figures as JSON.')] = False,
) -> None:
    """
    Run every experiment of the seed paper, and say what agrees, what differs, and why.

    A row is a file in config/paper: the paper's claims and where they stand, what is measured, and
    the rule by which a claim agrees, fixed before anything is run. One vehicle, one set of gains,
    one lamp and one room serve all of them; what a row changes is listed.

    Rows are kept as they end: the same command goes on where it was. After a change of code or of
    a row's file, what it concerns is run again.

    The results are a page, paper.json (SI units), and bags of the flights that are drawn.

    Exit status 0: done, whatever agrees. 2: bad input. 130: Ctrl-C.

    Example: lta reproduce --quick
    """
    console = plain_console(stderr=json or as_markdown)
    rows = rows_of(names or [])
    if listed:
        show(list_table(rows), console)
        return
    can_be_taken(pictures)
    target = (out or Path('runs') / ('paper-quick' if quick else 'paper')).absolute()
    order = Order(tuple(row.name for row in rows), quick, target, workers or processors())
    kepts = gathered(order, rows, console)
    told = keep_json(figures_file.content(rows, kepts), target / 'paper.json')
    words = ['reproduce', *(names or []), *(['--quick'] if quick else [])]
    page = write_page(rows, kepts, {'Find it again': typed(*words)}, target / 'report.html')
    if pictures is not None:
        write_pictures(page, pictures)
    if as_markdown:
        sys.stdout.write(markdown.page(rows, kepts))
    if json:
        print_kept_json(told, page)
    show(Table('Claims of the paper', lines.SUMMARY_HEADS, lines.summary(rows, kepts)), console)
    console.print(lines.title(rows, kepts), highlight=False, soft_wrap=True)
    console.print(page_line(near(page)), highlight=False, markup=False, soft_wrap=True)


def gathered(order: Order, rows: Sequence[PaperRow], console: Console) -> dict[str, Kept]:
    """Return all rows, those that are kept taken up and the others studied."""
    kepts = known_rows(order, rows)
    todo = [row for row in rows if row.name not in kepts]
    columns = (
        TextColumn('{task.description}'), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn()
    )  # fmt: skip
    with Bar(console, *columns, begin='the paper', total=len(rows)) as bar:
        bar.move(advance=len(kepts))
        for name, kept in study_all(order, todo):
            kepts[name] = kept
            bar.move(advance=1, description=name)
            if console.is_terminal:
                bar.say(f'{name}: {kept.seconds:.0f} s')
    return kepts


def list_table(rows: Sequence[PaperRow]) -> Table:
    """Return what rows there are."""
    body = [
        [
            row.name, f'{row.number}. {row.title}', str(seeds_of(row, False)),
            str(seeds_of(row, True)), str(len(row.claims)), str(len(row.defects)),
        ]
        for row in rows
    ]  # fmt: skip
    return Table('Rows of the paper', LIST_HEADS, body)
