"""lta challenge: flights in which something is hidden, and the score of what is found in them."""

from pathlib import Path
import sys
from typing import Annotated, Final

from lta_analysis.bar import Bar
from lta_analysis.challenge.make import make as make_challenge
from lta_analysis.challenge.make import Order
from lta_analysis.challenge.page import write_page
from lta_analysis.challenge.rows import kind as kind_of
from lta_analysis.challenge.score import keep, Scored
from lta_analysis.challenge.score import score as score_challenge
from lta_analysis.challenge.told import (
    cost_line,
    figure_lines,
    ladder_line,
    matrix_lines,
)
from lta_analysis.challenge.told import (
    markdown as markdown_of,
)
from lta_analysis.out_option import folder, Out
from lta_analysis.plain_console import plain_console
from lta_analysis.platforms.run import processors
from lta_analysis.report.frame import written
from lta_analysis.results_folder import page_line, results_folder
from lta_config.errors import BadInput
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, TextColumn, TimeRemainingColumn
from rich.table import Table
import typer

challenge = typer.Typer(
    help='Hide effects in flights, and score what is found in them.', no_args_is_help=True
)
SHORTEST: Final = 30.0  # s; the beginning and what is lost of it cannot be used
Jobs = Annotated[
    int | None, typer.Option(help='Processes; as many as processors by default.', min=1)
]


def _bar(console: Console, words: str, total: int) -> Bar:
    """Return the bar of both."""
    columns = (TextColumn('{task.description}'), BarColumn(), MofNCompleteColumn())
    return Bar(console, *columns, TimeRemainingColumn(), begin=words, total=total, period=600.0)


@challenge.command()
def make(
    seed: Annotated[int, typer.Option(help='Of the challenge.', min=0)] = 1,
    n: Annotated[int, typer.Option('--n', help='How many cases.', min=1)] = 20,
    row: Annotated[
        str, typer.Option(help='base, worse, structured, pose, hover or wrench.')
    ] = 'base',
    kind: Annotated[
        str | None, typer.Option(help='clean, single, pair, outside or mixed; drawn by default.')
    ] = None,
    seconds: Annotated[
        tuple[float, float], typer.Option(help='Least and greatest length of a flight.')
    ] = (60.0, 180.0),
    jobs: Jobs = None,
    out: Out = None,
) -> None:
    """
    Make cases: a vehicle off by its tolerances, flights of it, and something hidden in them.

    Each case is a folder with a vehicle file and three bags, train, confirm and holdout. Hidden
    is nothing, one effect of the library, two, something that is in no library, or an effect and
    something outside; in cases of odd number that is of a kind that was kept from discovery until
    it was finished. What it is stands in answers.sealed, which no study opens. A case depends on
    seed, number, row and kind only.

    The flights are made by an integrator, rigid body, rotors, pilot, sensors and noise of their
    own; of the project's model they share the equations of the effects.

    Exit status 0: done. 2: bad input.

    Example: lta challenge make --seed 1 --n 20 --out hidden
    """
    console = plain_console()
    if not SHORTEST <= seconds[0] <= seconds[1] <= 600.0:
        raise BadInput(f'Flights are {SHORTEST:g} to 600 s long; give the shorter length first.')
    order = Order(seed, n, row, None if kind is None else kind_of(kind), seconds)
    place = results_folder(out, f'challenge-{seed}')
    with _bar(console, 'flying', n) as bar:
        make_challenge(order, place, jobs or processors(), lambda done: bar.move(completed=done))
    console.print(f'{n} cases in {place}', highlight=False, soft_wrap=True)


@challenge.command()
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
        with _bar(console, 'studying', 1) as bar:
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
