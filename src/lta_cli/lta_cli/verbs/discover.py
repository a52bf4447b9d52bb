"""lta discover: which effect a vehicle file lacks, by measured flights."""

from pathlib import Path
from typing import Annotated

from lta_cli.options.json_option import print_json
from lta_cli.options.out_option import Out
from lta_cli.options.pictures_option import check_pictures, Pictures
from lta_cli.options.plain_console import plain_console
from lta_config.command_line import format_lta_command, relative_path
from lta_config.errors import BadInput
from lta_discovery.demo.demo import demonstrate_discovery
from lta_discovery.demo.hidden_effect import DemoEffect
from lta_discovery.flights.bags import Role
from lta_discovery.page.verdict_text import list_learned_commands
from lta_discovery.planning.next_flight import FILE, NextFlight, SCENE
from lta_discovery.planning.next_flight import plan_between as plan_between
from lta_discovery.progress import DiscoverProgress
from lta_discovery.results.terminal import format_result, print_finding
from lta_discovery.run import discover_effects as discovered
from lta_discovery.run import DiscoveryRequest, DiscoveryResult
from lta_report.results_folder import check_creatable, format_page_line, resolve_folder
from lta_report.screenshots import write_pictures
from rich.console import Console
import typer

BAG = 'Bag folders, results folders or .mcap files'


def discover(
    vehicle: Annotated[
        str | None, typer.Option(help='What flew: vehicle name or file, as far as it is known.')
    ] = None,
    train: Annotated[
        list[Path] | None, typer.Option(metavar='BAG...', help=f'To learn from. {BAG}.')
    ] = None,
    confirm: Annotated[
        list[Path] | None,
        typer.Option(metavar='BAG...', help='To confirm by: other flights of the vehicle.'),
    ] = None,
    holdout: Annotated[
        list[Path] | None,
        typer.Option(metavar='BAG...', help='To show on: nothing is fitted to these.'),
    ] = None,
    robot: Annotated[str | None, typer.Option(help='Whose data, if a bag has several.')] = None,
    demo: Annotated[
        bool, typer.Option('--demo', help='Hide an effect, fly with it, find it, show it.')
    ] = False,
    plan: Annotated[
        bool, typer.Option('--plan', help='Write the next flight, that decides between names.')
    ] = False,
    between: Annotated[
        tuple[str, str] | None,
        typer.Option(metavar='EFFECT EFFECT', help='Plan without flights: tell these two apart.'),
    ] = None,
    scenario: Annotated[
        str, typer.Option(help='With --between, where to fly: scenario name or file.')
    ] = SCENE,
    seed: Annotated[int, typer.Option(help='Seed of all chance.', min=0, max=2**31 - 1)] = 1,
    out: Out = None,
    pictures: Pictures = None,
    json: Annotated[bool, typer.Option('--json', help='Print discovery.json, alone.')] = False,
) -> None:
    """
    Find where a vehicle's model disagrees with its flights, and name the effect that is missing.

    The commands of the flights are replayed through the model of the vehicle file. Each effect of
    the library is a candidate; named is what explains the training flights, is confirmed by
    others, and is not explained as well by something that no library has. That nothing is missing
    is an answer, too, and so is that these flights cannot tell.

    The folder then holds report.html (all on one page), vehicle.yaml (the same file with what was
    learned, to be flown or studied again), overlay.mcap (measured, before and after, for
    Foxglove) and discovery.json.

    With --plan there is next_flight.yaml as well where a name is not the only one: a scenario, for
    lta fly, of the flight that tells it from the others. What no flight tells apart, it says.

    One flight alone is split in time, which is weaker. How it decides, and how good it is at
    it: docs/discovery.md.

    Exit status 0: studied, whatever came out. 2: bad input; flights from which no honest answer
    can come are that, too.

    Example: lta discover --vehicle gtmab --train A B --confirm C --holdout D

    Example: lta discover --demo

    Example: lta discover --vehicle gtmab --between linear_drag.surge quadratic_drag.surge
    """
    console = plain_console(stderr=json)
    bags: dict[Role, list[Path]] = {
        'train': train or [], 'confirm': confirm or [], 'holdout': holdout or [],
    }  # fmt: skip
    _check_options(vehicle, any(bags.values()), demo, between is not None)
    if pictures is not None and between is not None:
        raise BadInput('--between writes no page to take pictures of; leave --pictures out.')
    check_pictures(pictures)
    folder = resolve_folder(out, 'discover-demo' if demo else 'discover')
    check_creatable(folder)
    if between is not None and vehicle is not None:
        with DiscoverProgress(console) as progress:
            planned = plan_between(vehicle, *between, scenario, tell=progress.show_stage)
        write_next_flight(planned, vehicle, folder, json, console)
        return
    hidden = None
    with DiscoverProgress(console) as progress:
        if vehicle is None:
            hidden, found = demonstrate_discovery(seed, folder, progress.show_stage)
        else:
            asked = DiscoveryRequest(vehicle, bags, seed, robot, plan)
            found = discovered(asked, folder, progress.show_stage)
    if pictures is not None:
        write_pictures(found.page, pictures)
    if json:
        print_result_json(found, hidden)
    else:
        print_result(found, hidden, folder, console)


def _check_options(vehicle: str | None, bags: bool, demo: bool, between: bool) -> None:
    """Refuse options that do not go together."""
    if demo and (bags or vehicle):
        raise BadInput('--demo flies flights of its own; leave the vehicle and the bags out.')
    if not demo and vehicle is None:
        raise BadInput(
            'There is no vehicle file to hold the flights against; name it with --vehicle, or '
            'see how all this goes with --demo.'
        )
    if between and (bags or demo):
        raise BadInput('--between plans without flights; leave the bags out, or take --plan.')


def print_result_json(result: DiscoveryResult, hidden: DemoEffect | None) -> None:
    """Print discovery.json with the page, and what a demonstration hid."""
    content = {**result.told, 'page': str(result.page)}
    if hidden is not None:
        content['hidden'] = {'name': hidden.name, 'value': hidden.value, 'unit': hidden.unit}
    print_json(content)


def print_result(
    result: DiscoveryResult, hidden: DemoEffect | None, folder: Path, console: Console
) -> None:
    """Print what was found, what a demonstration hid, and what can be done with it."""
    finding = result.study.finding
    print_finding(finding, console)
    if hidden is not None:
        both = f'Hidden was {hidden}; found was {format_result(finding)}.'
        console.print(both, style='bold', highlight=False, soft_wrap=True)
    if (folder / FILE).exists():
        print_flight_command(finding.vehicle, folder / FILE, console)
    for line in list_learned_commands(finding, folder).values():
        console.print(line, style='dim', highlight=False, markup=False, soft_wrap=True)
    console.print(format_page_line(result.page), highlight=False, markup=False, soft_wrap=True)


def write_next_flight(
    planned: NextFlight, vehicle: str, folder: Path, json: bool, console: Console
) -> None:
    """Write the next flight and say what it is."""
    if planned.scenario is not None:
        folder.mkdir(parents=True, exist_ok=True)
    path = planned.write(folder)
    if json:
        content = {
            'next_flight': planned.text,
            'expected_nats': planned.nats,
            'scenario': None if path is None else str(path),
        }
        print_json(content)
    console.print(planned.text, highlight=False, soft_wrap=True)
    if path is not None:
        print_flight_command(vehicle, path, console)


def print_flight_command(vehicle: str, path: Path, console: Console) -> None:
    """Print how a planned flight is flown."""
    line = format_lta_command('fly', '--vehicle', vehicle, '--scenario', relative_path(path))
    console.print(line, style='dim', highlight=False, markup=False, soft_wrap=True)
