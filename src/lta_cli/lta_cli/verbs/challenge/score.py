"""lta challenge score: what is found in flights in which something is hidden."""

from pathlib import Path
import sys
from typing import Annotated

from lta_challenge.page import write_page
from lta_challenge.score import keep, Scored
from lta_challenge.score import score as score_challenge
from lta_challenge.told import cost_line, figure_lines, ladder_line, matrix_lines
from lta_challenge.told import markdown as markdown_of
from lta_challenge.waiting import challenge_bar, Jobs
from lta_cli.options.out_option import folder
from lta_cli.options.plain_console import plain_console
from lta_config.errors import BadInput
from lta_report.frame import written
from lta_report.results_folder import page_line
from lta_studies.platforms.run import processors
from rich.console import Console
from rich.table import Table
import typer


def score(
    folders: Annotated[
        list[Path], typer.Argument(help='Of challenges; each gets its score and page.')
    ],
    most: Annotated[int | None, typer.Option(help='Look at the first cases only.', min=1)] = None,
    markdown: Annotated[
        Path | None,
        typer.Option(
            help='Write all scores into this file, row by row.', parser=folder, metavar='FILE'
        ),
    ] = None,
    jobs: Jobs = None,
    json: Annotated[bool, typer.Option('--json', help='Print the scores as JSON.')] = False,
) -> None:
    """
    Put the cases of challenges to discovery, then open the answers and count.

    Goes on where an earlier run ended; a change of an effect or of the vehicle file begins anew.
    Counted are exact and wrong names, silence, what is called unexplained, intervals that hold
    the truth, and held-out errors beside those of an oracle, which is told what was hidden but
    not how large. Names that no such data can tell apart count as one (docs/discovery_classes.md).

    Exit status 0: scored, however well. 2: bad input.

    Example: lta challenge score hidden
    """
    if len({place.resolve() for place in folders}) < len(folders):
        raise BadInput('A challenge is given twice and would be counted twice; give each once.')
    console = plain_console(stderr=json)
    done: list[Scored] = []
    for place in folders:
        with challenge_bar(console, 'studying', 1) as bar:
            scored = score_challenge(
                place,
                jobs or processors(),
                most,
                lambda now, whole: bar.move(completed=now, total=whole),
            )
        text = keep(scored, place)
        if json:
            sys.stdout.write(text)
        _show(scored, console)
        console.print(page_line(write_page(scored, place)), highlight=False, soft_wrap=True)
        done.append(scored)
        if markdown is not None:
            # As far as it is: many challenges take hours.
            written(markdown_of([(one.about, one.cases) for one in done]), markdown)


def _show(scored: Scored, console: Console) -> None:
    """Print figures and matrix."""
    for heads, lines in (
        (['figure', 'share', 'wanted', 'met'], figure_lines(scored.cases)),
        matrix_lines(scored.cases),
    ):
        table = Table(*heads, box=None, pad_edge=False)
        for line in lines:
            table.add_row(*line)
        console.print(table)
    words = f'{ladder_line(scored.cases)} {cost_line(scored.cases)}'
    console.print(words, highlight=False, markup=False, soft_wrap=True)
