"""lta mission: simulate a solar-powered mission over days."""

from typing import Annotated, Literal

from lta_cli.options.study_command import study_command, StudyRun
from lta_report.report import Report
from lta_report.results_folder import resolve_folder
from lta_studies.mission.report import build_report
from lta_studies.mission.run import load_request, run_missions, SCHEDULES
import typer


@study_command('mission', quick={'days': 1, 'seeds': 1, 'schedule': 'by light'})
def mission(
    name: Annotated[str, typer.Argument(help='Mission: a shipped name or a file.')] = 'greenhouse',
    days: Annotated[int, typer.Option(help='Days to simulate.', min=1, max=365)] = 1,
    seeds: Annotated[
        int, typer.Option(help='Number of runs, each with different weather.', min=1, max=1000)
    ] = 1,
    seed: Annotated[int, typer.Option(help='Random seed.', min=0)] = 1,
    schedule: Annotated[
        Literal['all', 'by light', 'duty cycle', 'duty cycle, asleep'],
        typer.Option(
            help='Flight schedule. by light: fly when light and battery charge allow. duty '
            'cycle: fly at fixed times (baseline). duty cycle, asleep: the same, with sleep '
            'between flights. all: simulate all three.'
        ),
    ] = 'all',
    *,
    run: StudyRun,
) -> Report:
    """
    Simulate a solar-powered mission: perch and charge, fly if energy allows, return before dark.

    A mission file defines the beacons to visit, the light in which to charge, and the reserve.
    Flights use the compiled model and controller, which a first run compiles for some minutes;
    perching is simulated in steps of 30 s. Three schedules run on the same days: ours, which uses
    the light forecast and the estimated charge, and a fixed duty cycle that either stays awake or
    sleeps between flights.

    Writes a page, mission.json (SI units), and missions.jsonl with the log of each run. To resume
    a stopped run, repeat the command with the same --out.

    Exit status 0: done. 2: bad input. 130: Ctrl-C.

    Example: lta mission greenhouse --days 2 --seeds 5
    """
    schedules = SCHEDULES if schedule == 'all' else (schedule,)
    # Consecutive seeds, each with its own clouds
    request = load_request(name, days, range(seed, seed + seeds), schedules)
    folder = run.open_folder(resolve_folder(None, f'mission-{request.mission.name}'))
    return build_report(request, run_missions(request, folder, run.options, run.console))
