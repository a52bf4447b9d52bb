"""lta challenge score: score discovery on flights with hidden effects."""

from pathlib import Path
import sys
from typing import Annotated

from lta_challenge.page import write_page
from lta_challenge.score import ChallengeScore, write_score
from lta_challenge.score import score_challenge as score_challenge
from lta_challenge.score_report import (
    format_error_and_time,
    format_median_errors,
    format_outcome_table,
    format_score_figures,
    render_markdown,
)
from lta_cli.options.output_options import parse_folder
from lta_cli.options.plain_console import plain_console
from lta_cli.options.worker_options import RetryFailed, WorkerCount
from lta_config.errors import BadInput
from lta_report.page_frame import write_file
from lta_report.results_folder import format_page_line
from lta_report.study import StudyOptions
from rich.console import Console
from rich.table import Table
import typer


def score(
    folders: Annotated[
        list[Path],
        typer.Argument(
            help='Folders written by "lta challenge make"; scores and an HTML report are written '
            'into each.'
        ),
    ],
    most: Annotated[
        int | None, typer.Option(help='Maximum number of cases to score; all by default.', min=1)
    ] = None,
    markdown: Annotated[
        Path | None,
        typer.Option(
            help='Also write all scores to this Markdown file.',
            parser=parse_folder,
            metavar='FILE',
        ),
    ] = None,
    workers: WorkerCount = None,
    retry: RetryFailed = False,
    json: Annotated[bool, typer.Option('--json', help='Print the scores as JSON.')] = False,
) -> None:
    """
    Run discovery on the cases of challenges, then compare its results with the answers.

    An interrupted run resumes; a change of an effect or of the vehicle file starts again. Counts
    exact and wrong names, missed effects, "unexplained" verdicts and intervals that contain the
    truth. Compares held-out errors with those of an oracle that knows which effect was hidden but
    not its size. Effects that such data cannot distinguish count as one
    (docs/discovery_classes.md).

    Exit status 0: scored, whatever the score. 2: bad input.

    Example: lta challenge score hidden
    """
    # Otherwise the cases would count twice in the summary
    if len({place.resolve() for place in folders}) < len(folders):
        raise BadInput('The same challenge folder is given twice; give each folder only once.')
    console = plain_console(stderr=json)
    done: list[ChallengeScore] = []
    for place in folders:
        scored = score_challenge(place, StudyOptions(workers, retry_failed=retry), console, most)
        text = write_score(scored, place)
        if json:
            sys.stdout.write(text)
        _print_score(scored, console)
        console.print(format_page_line(write_page(scored, place)), highlight=False, soft_wrap=True)
        done.append(scored)
        if markdown is not None:
            # Write after each challenge: many challenges take hours.
            write_file(render_markdown([(one.about, one.cases) for one in done]), markdown)


def _print_score(scored: ChallengeScore, console: Console) -> None:
    """Print the metrics and the confusion matrix."""
    for heads, lines in (
        (['figure', 'share', 'target', 'met'], format_score_figures(scored.cases)),
        format_outcome_table(scored.cases),
    ):
        table = Table(*heads, box=None, pad_edge=False)
        for line in lines:
            table.add_row(*line)
        console.print(table)
    words = f'{format_median_errors(scored.cases)} {format_error_and_time(scored.cases)}'
    # Soft wrap leaves line breaks to the terminal, so that the text can be copied
    console.print(words, highlight=False, markup=False, soft_wrap=True)
