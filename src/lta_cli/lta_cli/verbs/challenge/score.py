"""lta challenge score: what is found in flights in which something is hidden."""

from pathlib import Path
import sys
from typing import Annotated

from lta_challenge.page import write_page
from lta_challenge.progress import challenge_bar, Jobs
from lta_challenge.score import ChallengeScore, write_score
from lta_challenge.score import score_challenge as score_challenge
from lta_challenge.score_report import (
    format_cost,
    format_errors,
    format_figures,
    format_matrix,
    render_markdown,
)
from lta_cli.options.out_option import parse_folder
from lta_cli.options.plain_console import plain_console
from lta_config.errors import BadInput
from lta_report.page_frame import write_file
from lta_report.results_folder import format_page_line
from lta_studies.platforms.run import count_processors
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
            help='Write all scores into this file, row by row.',
            parser=parse_folder,
            metavar='FILE',
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
    done: list[ChallengeScore] = []
    for place in folders:
        with challenge_bar(console, 'studying', 1) as bar:
            scored = score_challenge(
                place,
                jobs or count_processors(),
                most,
                lambda now, whole: bar.update_bar(completed=now, total=whole),
            )
        text = write_score(scored, place)
        if json:
            sys.stdout.write(text)
        _print_score(scored, console)
        console.print(format_page_line(write_page(scored, place)), highlight=False, soft_wrap=True)
        done.append(scored)
        if markdown is not None:
            # As far as it is: many challenges take hours.
            write_file(render_markdown([(one.about, one.cases) for one in done]), markdown)


def _print_score(scored: ChallengeScore, console: Console) -> None:
    """Print figures and matrix."""
    for heads, lines in (
        (['figure', 'share', 'wanted', 'met'], format_figures(scored.cases)),
        format_matrix(scored.cases),
    ):
        table = Table(*heads, box=None, pad_edge=False)
        for line in lines:
            table.add_row(*line)
        console.print(table)
    words = f'{format_errors(scored.cases)} {format_cost(scored.cases)}'
    console.print(words, highlight=False, markup=False, soft_wrap=True)
