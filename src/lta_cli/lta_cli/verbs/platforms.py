"""lta platforms: compare platforms in the same manoeuvres, each with its own control law."""

from datetime import datetime
from pathlib import Path
import sys
from typing import Annotated

from lta_bridge.bag.writer import prepare_empty_folder
from lta_bridge.provenance import read_commit
from lta_cli.options.output_options import Out
from lta_cli.options.plain_console import plain_console
from lta_cli.options.worker_options import RetryFailed, Scheduler, WorkerCount
from lta_config.command_line import format_lta_command
from lta_config.schema.comparison_file import load_comparison
from lta_report.browser import find_chromium
from lta_report.results_folder import format_page_line, resolve_folder, write_json
from lta_report.screenshots import write_pictures
from lta_report.study import StudyOptions
from lta_studies.platforms.page import ComparisonReport, write_page
from lta_studies.platforms.run import (
    build_entries,
    fly_jobs,
    list_jobs,
    result_to_json,
)
from lta_studies.platforms.summary import describe_reversals
from lta_studies.platforms.verdict import format_headline
import typer


def platforms(
    file: Annotated[
        str, typer.Argument(help='Comparison file, or the name platforms for the shipped file.')
    ] = 'platforms',
    seeds: Annotated[
        int | None,
        typer.Option(
            help='Number of flights of each platform; by default as in the comparison file.', min=1
        ),
    ] = None,
    workers: WorkerCount = None,
    scheduler: Scheduler = None,
    retry: RetryFailed = False,
    out: Out = None,
    pictures: Annotated[
        Path | None,
        typer.Option(
            help='Write each figure as PNG to this folder; needs Chromium.', metavar='FOLDER'
        ),
    ] = None,
    json: Annotated[
        bool, typer.Option('--json', help='Print the results of all flights as JSON.')
    ] = False,
) -> None:
    """
    Compare platforms in climb, turn, heading and cruise, each with its own control law.

    A comparison file names contestants (vehicle, control law, gains, changed parameters),
    ablations (one change to a contestant, with its reason) and speed-limit tests. A manoeuvre is a
    file of setpoints over time with a tolerance band. Everything is checked before the first
    flight.

    Finished flights are stored, and repeating the command with the same --out resumes.

    Writes flights.json (SI units) and a page: plots, metrics with their spread over the seeds,
    the effect of each ablation, and each platform's static margin.

    Exit status 0: all flown, whatever the results. 2: bad input, nothing flown. 130: Ctrl-C.

    Example: lta platforms --seeds 3
    """
    console = plain_console(stderr=json)
    if pictures is not None:
        find_chromium()  # raises BadInput before anything is flown
        prepare_empty_folder(pictures)
    comparison = load_comparison(file)
    # Every vehicle, gains file and manoeuvre is loaded before the first flight
    entries = build_entries(file, comparison)
    todo = list_jobs(file, comparison, seeds or comparison.seeds)
    created = datetime.now().astimezone().isoformat(timespec='seconds')
    target = resolve_folder(out, comparison.name)
    rows = fly_jobs(entries, todo, target, StudyOptions(workers, scheduler, retry), console)
    content = write_json([result_to_json(row) for row in rows], target / 'flights.json')
    # Provenance, shown at the end of the page
    origin = {
        'comparison': file, 'seeds': str(seeds or comparison.seeds), 'flights': str(len(rows)),
        'commit': read_commit(), 'created': created,
        'again': format_lta_command('platforms', file, '--seeds', str(seeds or comparison.seeds)),
    }  # fmt: skip
    page = write_page(ComparisonReport(comparison, rows, target, origin))
    if pictures is not None:
        write_pictures(page, pictures)
    if json:
        sys.stdout.write(content)
    lines = [
        format_headline(comparison, rows),
        *describe_reversals(comparison, rows),
        format_page_line(page),
    ]
    console.print('\n'.join(lines), highlight=False, markup=False, soft_wrap=True)
