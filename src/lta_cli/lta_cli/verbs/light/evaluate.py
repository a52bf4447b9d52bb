"""lta light evaluate: compare navigation strategies over scenes and seeds."""

from pathlib import Path
import sys
from typing import Annotated

from lta_bridge.bag.writer import prepare_empty_folder
from lta_cli.options.output_options import parse_folder, print_json_text
from lta_cli.options.plain_console import plain_console
from lta_cli.options.worker_options import RetryFailed, Scheduler, WorkerCount
from lta_report.browser import find_chromium
from lta_report.results_folder import format_page_line, write_json
from lta_report.screenshots import write_pictures
from lta_report.study import StudyOptions
from lta_studies.light.evaluation import scores_page
from lta_studies.light.evaluation.findings import EvaluationFindings
from lta_studies.light.evaluation.flights import MOST
from lta_studies.light.evaluation.page import write_page
from lta_studies.light.evaluation.run import EvaluationRequest, EvaluationStatus, run_evaluation
from lta_studies.light.evaluation.sets import SETS
from rich.console import Console
import typer

STOPPED = 130


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
    out: Annotated[
        Path | None,
        typer.Option(
            help='Folder of the results; runs/light-evaluate by default.',
            parser=parse_folder,
            metavar='FOLDER',
        ),
    ] = None,
    workers: WorkerCount = None,
    scheduler: Scheduler = None,
    retry: RetryFailed = False,
    pictures: Annotated[
        Path | None,
        typer.Option(
            help='Write each figure as PNG to this folder; needs Chromium.', metavar='FOLDER'
        ),
    ] = None,
    markdown: Annotated[
        bool,
        typer.Option('--markdown', help='Also print the Markdown page docs/navigation_scores.md.'),
    ] = False,
    json: Annotated[bool, typer.Option('--json', help='Print the results as JSON.')] = False,
) -> None:
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

    Exit status 0: all flown. 1: some flights failed. 2: bad input. 130: Ctrl-C.

    Example: lta light evaluate --seeds 10 --sets indoors winds
    """
    # stdout holds only the JSON or the Markdown page
    console = plain_console(stderr=json or markdown)
    if pictures is not None:
        find_chromium()  # raises BadInput before anything is flown
        prepare_empty_folder(pictures)
    # No time in the name, so that repeating the command resumes
    target = (out or Path('runs') / 'light-evaluate').absolute()
    options = StudyOptions(workers, scheduler, retry)
    order = EvaluationRequest(tuple(sets or SETS), seeds, target, options)
    done = run_evaluation(order, console)
    found = EvaluationFindings(done)
    content = write_json(found.to_dict(), order.folder / 'evaluation.json')
    page = write_page(found)
    if pictures is not None:
        write_pictures(page, pictures)
    if markdown:
        sys.stdout.write(scores_page.format_scores_page(found))
    if json:
        print_json_text(content, page)
    print_summary(found, done, console)
    console.print(format_page_line(page), highlight=False, markup=False, soft_wrap=True)
    if done.stopped:
        # As after Ctrl-C, but only now: the page of the finished flights is written first
        raise typer.Exit(STOPPED)
    if found.failed_count:
        raise typer.Exit(1)


def print_summary(findings: EvaluationFindings, done: EvaluationStatus, console: Console) -> None:
    """Print the findings and the computing time."""
    lines = [findings.title, findings.statement]
    if done.flown:
        # Processor time per flight [s]
        each = done.work / max(findings.flight_count, 1)
        lines.append(
            f'{done.flown} flights in {done.wall:.0f} s: {done.flown / done.wall:.1f} flights/s; '
            f'{each:.2f} s of processor time per flight.'
        )
    else:
        lines.append('All flights were already stored; nothing was flown.')
    if done.stopped:
        lines.append(f'Stopped: {findings.flight_count_text}; repeat the command to resume.')
    console.print('\n'.join(lines), highlight=False, markup=False, soft_wrap=True)
