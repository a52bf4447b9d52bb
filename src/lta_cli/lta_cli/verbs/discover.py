"""lta discover: find the effect that a vehicle file lacks, from measured flights."""

from pathlib import Path
from typing import Annotated

from lta_cli.options.common_options import (
    check_picture_output,
    Out,
    Pictures,
    plain_console,
    print_json,
)
from lta_config.command_line import format_lta_command, relative_path
from lta_config.errors import BadInput
from lta_discovery.demo.demo import run_discovery_demo
from lta_discovery.demo.hidden_effect import DemoEffect
from lta_discovery.flights.bags import Role
from lta_discovery.page.verdict_text import list_learned_file_commands
from lta_discovery.planning.next_flight import FILE, NextFlightPlan, plan_separating_flight, SCENE
from lta_discovery.progress import DiscoverProgress
from lta_discovery.results.terminal import format_named_parameters, print_finding
from lta_discovery.run import discover_effects, DiscoveryRequest, DiscoveryResult
from lta_report.results_folder import check_creatable, format_page_line, resolve_folder
from lta_report.screenshots import write_pictures
from rich.console import Console
import typer

BAG = 'Bag folders, results folders or .mcap files'


def discover(
    vehicle: Annotated[
        str | None,
        typer.Option(help='Vehicle whose model is compared with the flights, name or file.'),
    ] = None,
    train: Annotated[
        list[Path] | None, typer.Option(metavar='BAG...', help=f'Training flights. {BAG}.')
    ] = None,
    confirm: Annotated[
        list[Path] | None,
        typer.Option(
            metavar='BAG...', help='Other flights of the same vehicle, to confirm the result.'
        ),
    ] = None,
    holdout: Annotated[
        list[Path] | None,
        typer.Option(
            metavar='BAG...',
            help='Test flights: used only to report prediction errors, not to fit anything.',
        ),
    ] = None,
    robot: Annotated[
        str | None, typer.Option(help='Robot whose flight is used; needed if a bag has several.')
    ] = None,
    demo: Annotated[
        bool,
        typer.Option(
            '--demo', help='Demonstration: simulate flights with a hidden effect and discover it.'
        ),
    ] = False,
    plan: Annotated[
        bool,
        typer.Option(
            '--plan',
            help='Also plan the next flight that best distinguishes the candidate effects.',
        ),
    ] = False,
    between: Annotated[
        tuple[str, str] | None,
        typer.Option(
            metavar='EFFECT EFFECT', help='Plan a flight that distinguishes these two effects.'
        ),
    ] = None,
    scenario: Annotated[
        str, typer.Option(help='With --between: scenario to fly in, name or file.')
    ] = SCENE,
    calibration: Annotated[
        bool,
        typer.Option(
            '--calibration/--no-calibration',
            help='Calibrate the vehicle first, where the flights call for it.',
        ),
    ] = True,
    seed: Annotated[int, typer.Option(help='Random seed.', min=0, max=2**31 - 1)] = 1,
    out: Out = None,
    pictures: Pictures = None,
    json: Annotated[
        bool, typer.Option('--json', help='Print only the content of discovery.json.')
    ] = False,
) -> None:
    """
    Find where a vehicle's model disagrees with its flights, and name the missing effect.

    Where the flights call for it, the vehicle is calibrated first ("lta calibrate"): gains, delay,
    lift, marker frame. The search goes on from the calibrated values, and calibrated.yaml is the
    vehicle file with them.

    Replays the recorded commands through the model of the vehicle file. Each effect of the library
    is a candidate. An effect is named if it explains the training flights, if other flights
    confirm it, and if an effect outside the library does not explain them as well. The result may
    also be that nothing is missing, or that the flights do not decide.

    Writes report.html, vehicle.yaml (the vehicle file with the identified effect or law),
    overlay.mcap (measured, before and after, for Foxglove), animation.svg (the same at a glance)
    and discovery.json.

    If several effects fit, --plan also writes next_flight.yaml, a scenario for "lta fly" that
    separates them. It reports pairs that no flight can distinguish.

    A single flight is split in time, which gives weaker evidence. Method and accuracy:
    docs/discovery.md.

    Exit status 0: done, whatever the result. 2: bad input, or flights too poor to analyse.

    Example: lta discover --vehicle gtmab --train A B --confirm C --holdout D

    Example: lta discover --demo

    Example: lta discover --vehicle gtmab --between linear_drag.surge quadratic_drag.surge
    """
    console = plain_console(stderr=json)
    bags: dict[Role, list[Path]] = {
        'train': train or [], 'confirm': confirm or [], 'holdout': holdout or [],
    }  # fmt: skip
    # Refuse contradictory options before any work
    _check_exclusive_options(vehicle, any(bags.values()), demo, between is not None)
    if pictures is not None and between is not None:
        raise BadInput('--between writes no HTML report; remove --pictures.')
    check_picture_output(pictures)
    folder = resolve_folder(out, 'discover-demo' if demo else 'discover')
    # Discovery takes minutes: find out now whether its results can be written
    check_creatable(folder)
    # `_check_exclusive_options` ensures the vehicle; the second test is for the type checker
    if between is not None and vehicle is not None:
        with DiscoverProgress(console) as progress:
            planned = plan_separating_flight(vehicle, *between, scenario, tell=progress.show_stage)
        write_next_flight(planned, vehicle, folder, json, console)
        return
    hidden = None
    with DiscoverProgress(console) as progress:
        if vehicle is None:
            hidden, result = run_discovery_demo(seed, folder, progress.show_stage)
        else:
            request = DiscoveryRequest(vehicle, bags, seed, robot, plan, calibration)
            result = discover_effects(request, folder, progress.show_stage)
    show_result(result, hidden, folder, console, pictures, json=json)


def show_result(
    result: DiscoveryResult,
    hidden: DemoEffect | None,
    folder: Path,
    console: Console,
    pictures: Path | None,
    *,
    json: bool,
) -> None:
    """Write the pictures if asked for, and print the result."""
    if pictures is not None:
        write_pictures(result.page, pictures)
    if json:
        print_result_json(result, hidden)
    else:
        print_result(result, hidden, folder, console)


def _check_exclusive_options(vehicle: str | None, bags: bool, demo: bool, between: bool) -> None:
    """Refuse options that exclude each other."""
    if demo and (bags or vehicle):
        raise BadInput(
            '--demo simulates its own flights; remove --vehicle, --train, --confirm and --holdout.'
        )
    if not demo and vehicle is None:
        raise BadInput(
            'A vehicle file to compare the flights with is missing; name one with --vehicle, or '
            'try --demo.'
        )
    if between and (bags or demo):
        raise BadInput(
            '--between plans a flight without recorded flights; remove --train, --confirm, '
            '--holdout and --demo, or use --plan instead of --between.'
        )


def print_result_json(result: DiscoveryResult, hidden: DemoEffect | None) -> None:
    """Print discovery.json with the path of the page and the hidden effect of a demo."""
    content = {**result.data, 'page': str(result.page)}
    if hidden is not None:
        content['hidden'] = {'name': hidden.name, 'value': hidden.value, 'unit': hidden.unit}
    print_json(content)


def print_result(
    result: DiscoveryResult, hidden: DemoEffect | None, folder: Path, console: Console
) -> None:
    """Print the finding, the hidden effect of a demo, and commands to continue with."""
    finding = result.study.finding
    print_finding(finding, console)
    if hidden is not None:
        # In a demonstration the truth is known: show it next to the result
        both = f'Hidden: {hidden}. Result: {format_named_parameters(finding)}.'
        console.print(both, style='bold', highlight=False, soft_wrap=True)
    # Exists only with --plan, and only if a flight helps
    if (folder / FILE).exists():
        print_flight_command(finding.vehicle, folder / FILE, console)
    for line in list_learned_file_commands(finding, folder).values():
        console.print(line, style='dim', highlight=False, markup=False, soft_wrap=True)
    console.print(format_page_line(result.page), highlight=False, markup=False, soft_wrap=True)


def write_next_flight(
    planned: NextFlightPlan, vehicle: str, folder: Path, json: bool, console: Console
) -> None:
    """Write the planned flight and describe it."""
    # No scenario is planned if no flight can separate the effects
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
    """Print the command that flies a planned flight."""
    line = format_lta_command('fly', '--vehicle', vehicle, '--scenario', relative_path(path))
    console.print(line, style='dim', highlight=False, markup=False, soft_wrap=True)
