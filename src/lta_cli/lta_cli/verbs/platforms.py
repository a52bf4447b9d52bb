"""lta platforms: compare platforms in the same manoeuvres, each with its own control law."""

from datetime import datetime
from typing import Annotated

from lta_cli.options.study_command import study_command, StudyRun
from lta_config.schema.comparison_file import load_comparison
from lta_report.report import Report
from lta_report.results_folder import resolve_folder
from lta_studies.platforms.report import build_report
from lta_studies.platforms.run import build_entries, fly_jobs, list_jobs
import typer


@study_command('platforms', quick={'seeds': 1})
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
    *,
    run: StudyRun,
) -> Report:
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
    comparison = load_comparison(file)
    # Every vehicle, gains file and manoeuvre is loaded before the first flight
    entries = build_entries(file, comparison)
    count = seeds or comparison.seeds
    todo = list_jobs(file, comparison, count)
    created = datetime.now().astimezone().isoformat(timespec='seconds')
    folder = run.open_folder(resolve_folder(None, comparison.name))
    rows = fly_jobs(entries, todo, folder, run.options, run.console)
    facts = {
        'comparison': file, 'seeds': str(count), 'flights': str(len(rows)),
        'created': created,
    }  # fmt: skip
    return build_report(comparison, rows, facts)
