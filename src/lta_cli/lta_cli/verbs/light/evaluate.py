"""lta light evaluate: compare navigation strategies over scenes and seeds."""

from pathlib import Path
import sys
from typing import Annotated

from lta_cli.options.common_options import plain_console
from lta_cli.options.study_command import study_command, StudyRun
from lta_flight.batch.fly import Device
from lta_report.report import Report
from lta_studies.light.evaluation.flights import MOST
from lta_studies.light.evaluation.report import build_report
from lta_studies.light.evaluation.run import EvaluationRequest, run_evaluation
from lta_studies.light.evaluation.scores_page import format_scores_page
from lta_studies.light.evaluation.sets import SETS
import typer


@study_command('light-evaluate', quick={'seeds': 2})
def evaluate(
    seeds: Annotated[
        int, typer.Option(help='Number of flights of each strategy in each case.', min=1, max=MOST)
    ] = 50,
    sets: Annotated[
        list[str] | None,
        typer.Option(
            metavar='A B', help=f'Sets of cases to fly: {", ".join(SETS)}; all by default.'
        ),
    ] = None,
    device: Annotated[
        Device | None,
        typer.Option(
            help='Simulate the flights in batches: on all cores (cpu-batch) or on a GPU (gpu).'
        ),
    ] = None,
    markdown: Annotated[
        bool,
        typer.Option('--markdown', help='Also print the Markdown page docs/navigation_scores.md.'),
    ] = False,
    *,
    run: StudyRun,
) -> Report:
    """
    Compare the navigation strategies: indoors, in wind, from afar, in daylight, and variations.

    Each set is a sweep file (light_indoors, light_reference_winds, ...) that "lta sweep" can also
    fly. All strategies get the same seeds. In the sets with wind, a reference pilot that knows
    lamp and wind gives the best path that the vehicle can fly.

    Shares have Wilson 95 % intervals, means bootstrap intervals. The page shows which single
    factor explains the paper's ranking of path lengths, and compares the paper's figures with
    ours.

    All sets fly their first seed before any flies its second. Finished flights are stored:
    repeating the command resumes, more seeds are added to the stored ones, and after Ctrl-C the
    page covers the flights so far.

    --device is much faster for many seeds, after a compilation of a minute or two for each
    strategy. Batches model the received lamp signal by geometry and noise instead of ADC blocks,
    as "lta sweep --device" does; the pilot flies as before.

    Exit status 0: all flown. 1: some flights failed. 2: bad input. 130: Ctrl-C.

    Example: lta light evaluate --seeds 10 --sets indoors winds
    """
    if markdown:
        # stdout holds only the Markdown page
        run.console = plain_console(stderr=True)
    # No time in the name, so that repeating the command resumes
    folder = run.open_folder(Path('runs') / 'light-evaluate')
    request = EvaluationRequest(tuple(sets or SETS), seeds, folder, run.options, device)
    status = run_evaluation(request, run.console)
    if markdown:
        sys.stdout.write(format_scores_page(status))
    return build_report(status, with_pictures=run.page)
