"""lta energy mounting: where the solar panels sit, and what follows from it."""

from typing import Annotated

from lta_bridge.bag.writer import empty_folder
from lta_cli.options.json_option import Json, print_kept_json
from lta_cli.options.out_option import Out
from lta_cli.options.pictures_option import can_be_taken, Pictures
from lta_cli.options.plain_console import plain_console
from lta_config.files import find, load_yaml
from lta_config.typed import near, typed
from lta_report.results_folder import keep_json, page_line, results_folder
from lta_report.screenshots import write_pictures
from lta_studies.energy.mounting import verdict
from lta_studies.energy.mounting.page import write_page
from lta_studies.energy.mounting.rows import plain, tables
from lta_studies.energy.mounting.run import Order, study
from lta_studies.energy.tables import show, turned
from lta_studies.energy.watched import watched
import typer
import yaml

MOUNTS = ['side', 'bottom', 'top']


def mounting(
    mount: Annotated[
        list[str] | None,
        typer.Option(help='Shipped name or file; repeatable. Side, bottom and top by default.'),
    ] = None,
    vehicle: Annotated[str, typer.Option(help='What they are mounted on.')] = 'gtmab',
    misplaced: Annotated[
        float,
        typer.Option(help='How far ahead of their places panels sit by mistake, in cm.',
                     min=-50.0, max=50.0),
    ] = 3.0,
    seeds: Annotated[int, typer.Option(help='Flights of each.', min=1, max=100)] = 3,
    out: Out = None,
    pictures: Pictures = None,
    json: Json = False,
) -> None:  # fmt: skip
    """
    Compare where the solar panels sit: at the side, at the bottom, on top.

    A mount is a file in config/mounts: parts that take the place of a layer, and which of them are
    panels. Mass, balance, inertia, drag and shade follow. Each is let go tilted, beside the same
    by hand, and flown straight on at 0.1 m/s, in place and out of place; a mount that the hull
    cannot carry flies in a fuller one, and so do the others beside it. Shown too: what a centre of
    gravity above the centre of buoyancy does.

    The results are a page, mounting.json (SI units), and each vehicle as a file that flies.

    Exit status 0: done. 2: bad input.

    Example: lta energy mounting --seeds 1
    """
    console = plain_console(stderr=json)
    can_be_taken(pictures)
    names = list(dict.fromkeys(mount or MOUNTS))
    order = Order(load_yaml(find('vehicle', vehicle)), names, misplaced / 100.0, seeds)
    todo = seeds * sum(map(len, order.fits().values()))
    target = empty_folder(results_folder(out, 'mounting'))
    found = watched(lambda tick: study(order, tick), todo, console)
    content = keep_json(plain(found), target / 'mounting.json')
    for each in (found.own or found.shared).values():
        text = yaml.safe_dump(dict(each.fitted.content), sort_keys=False)
        (target / f'{each.fitted.mount.name}.yaml').write_text(text, encoding='utf-8')
    again = typed(
        'energy', 'mounting', *(word for name in names for word in ('--mount', name)), '--vehicle',
        vehicle, '--misplaced', f'{misplaced:g}', '--seeds', str(seeds),
    )  # fmt: skip
    best = near(target / f'{verdict.best(found)}.yaml')
    commands = {
        'Find it again': again,
        'What differs': typed('vehicle', 'diff', vehicle, best),
        'Fly it': typed('simulate', '--vehicle', best),
    }
    page = write_page(found, commands, target / 'report.html')
    if pictures is not None:
        write_pictures(page, pictures)
    if json:
        print_kept_json(content, page)
    for table in tables(found):
        show(turned(table), console)
    lines = [*verdict.sentences(found), verdict.title(found), page_line(near(page))]
    console.print('\n'.join(lines), highlight=False, markup=False, soft_wrap=True)
