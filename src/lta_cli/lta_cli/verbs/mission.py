"""lta mission: simulate a solar-powered mission over days."""

from dataclasses import asdict
from typing import Annotated, Literal

from lta_cli.options.output_options import check_picture_output, Json, Out, Pictures, print_json
from lta_cli.options.plain_console import plain_console
from lta_cli.options.worker_options import RetryFailed, Scheduler, WorkerCount
from lta_config.command_line import format_lta_command, relative_path
from lta_report.results_folder import format_page_line, resolve_folder, write_json
from lta_report.screenshots import write_pictures
from lta_report.study import StudyOptions
from lta_studies.energy.tables import print_table, transpose_table
from lta_studies.mission.page import build_mission_tables, format_headline, write_page
from lta_studies.mission.run import flight_time_ratio, load_request, run_missions, SCHEDULES
import typer


def mission(
    name: Annotated[str, typer.Argument(help='Mission: a shipped name or a file.')] = 'greenhouse',
    days: Annotated[int, typer.Option(help='Days to simulate.', min=1, max=365)] = 1,
    seeds: Annotated[
        int, typer.Option(help='Number of runs, each with different weather.', min=1, max=1000)
    ] = 1,
    seed: Annotated[int, typer.Option(help='Random seed of the first run.', min=0)] = 1,
    schedule: Annotated[
        Literal['all', 'by light', 'duty cycle', 'duty cycle, asleep'],
        typer.Option(
            help='Flight schedule. by light: fly when light and battery charge allow. duty '
            'cycle: fly at fixed times (baseline). duty cycle, asleep: the same, with sleep '
            'between flights. all: simulate all three.'
        ),
    ] = 'all',
    workers: WorkerCount = None,
    scheduler: Scheduler = None,
    retry: RetryFailed = False,
    out: Out = None,
    pictures: Pictures = None,
    json: Json = False,
) -> None:
    """
    Simulate a solar-powered mission: perch and charge, fly if energy allows, return before dark.

    A mission file defines the beacons to visit, the light in which to charge, and the reserve.
    Flights use the compiled model and controller; perching is simulated in steps of 30 s. Three
    schedules run on the same days: ours, which uses the light forecast and the estimated charge,
    and a fixed duty cycle that either stays awake or sleeps between flights.

    Writes a page, mission.json (SI units), and missions.jsonl with the log of each run. To resume
    a stopped run, repeat the command with the same --out.

    Exit status 0: done. 2: bad input. 130: Ctrl-C.

    Example: lta mission greenhouse --days 2 --seeds 5
    """
    console = plain_console(stderr=json)
    check_picture_output(pictures)
    schedules = SCHEDULES if schedule == 'all' else (schedule,)
    # Consecutive seeds, each with its own clouds
    order = load_request(name, days, range(seed, seed + seeds), schedules)
    folder = resolve_folder(out, f'mission-{order.mission.name}')
    lives = run_missions(order, folder, StudyOptions(workers, scheduler, retry), console)
    content = {
        'mission': order.mission.name,
        'days': days,
        # None if only one schedule was simulated
        'gain': None if (more := flight_time_ratio(lives)) is None else more._asdict(),
        'lives': [
            {'schedule': each.schedule, 'seed': each.seed, **asdict(each.figures)}
            for each in lives
        ],
    }
    write_json(content, folder / 'mission.json')
    again = format_lta_command(
        'mission', name, '--days', str(days), '--seeds', str(seeds), '--seed', str(seed),
        '--schedule', schedule,
    )  # fmt: skip
    commands = {
        'Run it again': again,
        'Fly between its beacons': format_lta_command(
            'simulate', '--scenario', order.mission.scene, '--strategy', 'homing',
        ),
    }  # fmt: skip
    page = write_page(order, lives, commands, folder / 'report.html')
    if pictures is not None:
        write_pictures(page, pictures)
    if json:
        print_json(content, page)
    schedules_table, ratios = build_mission_tables(order, lives)
    # On a terminal, the few schedules are columns and the many figures rows
    print_table(transpose_table(schedules_table), console)
    print_table(ratios, console)
    lines = [format_headline(order, lives), format_page_line(relative_path(page))]
    console.print('\n'.join(lines), highlight=False, markup=False, soft_wrap=True)
