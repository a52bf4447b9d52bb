"""lta simulate: fly once in one process, without DDS, or judge a vehicle file by forecasts."""

from pathlib import Path
from typing import Annotated

from lta_analysis.console import plain_console
from lta_cli.options.common_options import complete_names, Json, Out, print_json
from lta_cli.options.flight_output import flight_to_dict, format_outcome, print_files
from lta_cli.options.request_command import is_unset, run_request
from lta_config.command_line import format_lta_command, relative_path
from lta_config.errors import BadInput
from lta_control.strategies import STRATEGIES
from lta_data.bag.bag_folder import find_bag
from lta_data.bag.recorded_flight import open_flight
from lta_data.scene import find_recorded_name
from lta_flight.flight_run import EXIT_STATUSES, ROBOT
from lta_flight.progress import FlightProgress
from lta_flight.report.page import write_page
from lta_flight.simulate import CommandRequest, simulate_once, SimulationRequest
from lta_report.request import build_request
import typer

VEHICLE, SCENARIO = 'gtmab', 'lamp_room'
HALL = 'hall'  # for recordings of no known scene: no wall is near
KNOWN = ', '.join(STRATEGIES)
# Options of a flight, by the name of their parameter, that forecasts do not have
OF_FLIGHT = {
    'scenario': '--scenario', 'strategy': '--strategy', 'gains': '--gains', 'seed': '--seed',
    'changes': '--set', 'begin': '--begin', 'end': '--end', 'bag': '--bag',
}  # fmt: skip


def simulate(
    context: typer.Context,
    vehicle: Annotated[
        str | None,
        typer.Option(
            help=f'Vehicle name or file; {VEHICLE}, or the recorded one, by default.',
            autocompletion=complete_names('vehicle'),
        ),
    ] = None,
    scenario: Annotated[
        str | None,
        typer.Option(
            help=f'Scenario name or file; {SCENARIO}, or the recorded one, by default.',
            autocompletion=complete_names('scenario'),
        ),
    ] = None,
    strategy: Annotated[
        str, typer.Option(help=f'Navigation strategy: {KNOWN}, or a file such as ./mine.py.')
    ] = 'homing',
    gains: Annotated[
        str, typer.Option(help="Controller gains, name or file; the vehicle's by default.")
    ] = '',
    seed: Annotated[int, typer.Option(help='Random seed.', min=0, max=2**31 - 1)] = 1,
    changes: Annotated[
        list[str] | None,
        typer.Option('--set', metavar='PATH=VALUE', help='Override a parameter; repeatable.'),
    ] = None,
    commands: Annotated[
        list[Path] | None,
        typer.Option(
            metavar='BAG...',
            help='Fly the commands of this recording (bag or results folder) from its motion on, '
            'instead of a controller. Several with --forecasts.',
        ),
    ] = None,
    forecasts: Annotated[
        bool,
        typer.Option(
            '--forecasts',
            help='With --commands: judge the vehicle by forecasts of the recordings instead.',
        ),
    ] = False,
    begin: Annotated[
        float, typer.Option(help='With --commands: begin so many seconds into it.', min=0.0)
    ] = 0.0,
    end: Annotated[
        float | None, typer.Option(help='With --commands: end so many seconds into it.', min=0.0)
    ] = None,
    robot: Annotated[
        str | None,
        typer.Option(help='With --commands: its robot; needed if the recording has several.'),
    ] = None,
    out: Out = None,
    bag: Annotated[bool, typer.Option(help='Record a bag and write an HTML report.')] = True,
    json: Json = False,
) -> None:
    """
    Fly in one process: the same algorithms in the same order as the graph, without DDS.

    The bag has the values of that of "lta fly" with the same seed, except for /clock and
    /diagnostics, which depend on the wall clock and are left out.

    --set overrides a file's parameter by its path: vehicle.trim.heaviness=4 g,
    scenario.air.wind=[0.2, 0, 0] m/s, scenario.air.wind.0=0.2 m/s (one element, counted from 0),
    gains.heading_kp=0.5; or a node's: mission.altitude=0.8. Roots are vehicle, scenario, gains,
    mission, reserve (action at low charge), estimator, demodulator, prior (lamp position) and
    energy_monitor. Changed files are saved next to the bag. The drone's own model uses the
    overridden values, too.

    --commands flies the recorded duties, or forces and moments, of a flight through a vehicle
    file: the difference is what that file lacks. It grows with time, as nothing corrects it;
    --begin and --end choose a part. The bag has the clock of the recording, for
    "lta compare --align none".

    --commands with --forecasts judges a vehicle file: a forecast begins every 1.5 s from past
    readings only, and its errors 1, 3 and 8 s ahead stand beside those of coasting (constant
    body velocity and rates). It needs measured poses. It writes a page and forecasts.json, with a
    row for each forecast. "lta calibrate" judges in the same way.

    Exit status 0: the drone reached its goal, with homing for 3 s, or flew all --commands, or
    --forecasts are done. 2: bad input, nothing was flown. 3: out of time. 4: the drone left the
    room.

    Example: lta simulate --seed 3 --set 'vehicle.trim.heaviness=4 g'

    Example: lta simulate --commands runs/flight --vehicle my_blimp.yaml --begin 20 --end 30

    Example: lta simulate --commands A B --vehicle my_blimp.yaml --forecasts
    """
    console = plain_console(stderr=json)

    if forecasts:
        # A flight does not wait for these imports, which take as long as all others
        from lta_discovery.forecast_study import ForecastRequest

        if useless := [word for name, word in OF_FLIGHT.items() if not is_unset(context, name)]:
            raise BadInput(
                f'{" and ".join(useless)} cannot be used with --forecasts, which flies nothing '
                'new; leave it out.'
            )
        options = {
            'vehicle': vehicle,
            'flights': tuple(commands or ()),
            'robot': robot,
            'out': out,
        }
        used = {name: value for name, value in options.items() if value}
        run_request(build_request(ForecastRequest, used), json)
        return
    if len(commands or []) > 1:
        raise BadInput(
            'One recording is flown at a time; give one with --commands, or add --forecasts.'
        )
    recording = commands[0] if commands else None
    if recording is None and (begin or end is not None or robot is not None):
        raise BadInput('--begin, --end and --robot choose from a recording; add --commands BAG.')
    recorded = {} if recording is None else open_flight(find_bag(recording), robot).provenance
    order = SimulationRequest(
        vehicle or find_recorded_name(recorded, 'vehicle') or VEHICLE,
        scenario
        or find_recorded_name(recorded, 'scenario')
        or (SCENARIO if recording is None else HALL),
        strategy, gains, seed, tuple(changes or ()), out, record=bag,
        commands=None if recording is None else CommandRequest(recording, robot, begin, end),
    )  # fmt: skip
    with FlightProgress(console, 'loading the world') as progress:
        flight, figures = simulate_once(order, progress)
    target = flight.folder / 'report.html' if bag else None
    if target is not None:
        # Figures of the recorded bag, the same as `lta report` shows
        figures = write_page(flight.bag, target)
    if json:
        content = flight_to_dict(flight, figures, target)
        if not bag:
            # No bag was written
            del content['bag']
        print_json(content)
    console.print(format_outcome(flight, figures), highlight=False, soft_wrap=True)
    console.print(f'Simulation speed: {flight.pace:.1f} x real time.', highlight=False)
    if bag:
        print_files(flight.bag, target, console)
        if recording is not None:
            line = format_lta_command(
                'compare', recording, relative_path(flight.bag), '--align', 'none',
                *(() if robot is None else ('--robot', f'{robot}:{ROBOT}')),
            )  # fmt: skip
            console.print(f'Compare them: {line}', highlight=False, soft_wrap=True)
    if status := EXIT_STATUSES[flight.outcome]:
        raise typer.Exit(status)
