"""lta mission: live on light for days."""

from dataclasses import asdict
from typing import Annotated, Literal

from lta_cli.options.json_option import Json, print_json
from lta_cli.options.out_option import Out
from lta_cli.options.pictures_option import can_be_taken, Pictures
from lta_cli.options.plain_console import plain_console
from lta_config.typed import near, typed
from lta_report.bar import Bar
from lta_report.results_folder import keep_json, page_line, results_folder
from lta_report.screenshots import write_pictures
from lta_studies.energy.tables import show, turned
from lta_studies.mission.page import tables, title, write_page
from lta_studies.mission.run import gain, order_of, run, SCHEDULES
from rich.progress import BarColumn, TextColumn, TimeRemainingColumn
import typer

DAY = 86400.0


def mission(
    name: Annotated[str, typer.Argument(help='Mission, shipped name or file.')] = 'greenhouse',
    days: Annotated[int, typer.Option(help='Days to live.', min=1, max=365)] = 1,
    seeds: Annotated[
        int, typer.Option(help='How often, each with its own clouds.', min=1, max=1000)
    ] = 1,
    seed: Annotated[int, typer.Option(help='The first seed.', min=0)] = 1,
    schedule: Annotated[
        Literal['all', 'by light', 'duty cycle', 'duty cycle, asleep'],
        typer.Option(help='Ours, which looks at the light, a naive one, or all.'),
    ] = 'all',
    out: Out = None,
    pictures: Pictures = None,
    json: Json = False,
) -> None:
    """
    Live on light: perch and charge, fly when reserve and light allow, be back before dark.

    A mission file says which beacons the drone visits, in which light it charges, and what it
    keeps. Each flight is flown by the compiled model and control; the time between goes in steps
    of half a minute. Three schedules live the same days: ours, which looks at the light to come
    and at its own count of the charge, and a fixed duty cycle that stays awake or sleeps between.

    The results are a page, mission.json (SI units), and the diary of each life. The same command
    with the same --out goes on where it was stopped.

    Exit status 0: done. 2: bad input. 130: Ctrl-C.

    Example: lta mission greenhouse --days 2 --seeds 5
    """
    console = plain_console(stderr=json)
    can_be_taken(pictures)
    schedules = SCHEDULES if schedule == 'all' else (schedule,)
    order = order_of(name, days, range(seed, seed + seeds), schedules)
    folder = results_folder(out, f'mission-{order.mission.name}')
    columns = (TextColumn('{task.description}'), BarColumn(), TimeRemainingColumn())
    total = DAY * days * seeds * len(schedules)
    with Bar(console, *columns, begin='living', total=total) as bar:
        lives = run(order, folder, lambda gone: bar.move(advance=gone))
    content = {
        'mission': order.mission.name,
        'days': days,
        'gain': None if (more := gain(lives)) is None else more._asdict(),
        'lives': [
            {'schedule': each.schedule, 'seed': each.seed, **asdict(each.figures)}
            for each in lives
        ],
    }
    keep_json(content, folder / 'mission.json')
    again = typed(
        'mission', name, '--days', str(days), '--seeds', str(seeds), '--seed', str(seed),
        '--schedule', schedule,
    )  # fmt: skip
    commands = {
        'Live it again': again,
        'Fly between its beacons': typed('simulate', '--scenario', order.mission.scene,
                                         '--strategy', 'homing'),
    }  # fmt: skip
    page = write_page(order, lives, commands, folder / 'report.html')
    if pictures is not None:
        write_pictures(page, pictures)
    if json:
        print_json(content, page)
    schedules_table, ratios = tables(order, lives)
    show(turned(schedules_table), console)
    show(ratios, console)
    lines = [title(order, lives), page_line(near(page))]
    console.print('\n'.join(lines), highlight=False, markup=False, soft_wrap=True)
