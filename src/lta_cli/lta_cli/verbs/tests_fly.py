"""lta tests fly: fly by motion capture what calibrates a vehicle, and record it."""

from pathlib import Path
from typing import Annotated

from lta_analysis.console import plain_console
from lta_cli.request_command import complete_names
from lta_cli.verbs.launch import print_event, print_node_line
from lta_config.command_line import format_lta_command, relative_path
from lta_config.errors import BadInput
from lta_flight.flight import is_refusal
from lta_flight.graph import run_graph
from lta_flight.preflight import check_plan
from lta_graph.launch_plan import parse_arguments
from lta_graph.launches import FLY
from lta_model.vehicle import load_vehicle
from lta_report.results_folder import resolve_folder
import typer

PILOT = 'pilot'  # the node that ends a flight
ARMING_NODE = 'crazyflie_bridge'  # the node that arms a real drone


def parse_folder(text: str) -> Path:
    """Return a folder; refuse empty text (an unset shell variable), which would mean '.'."""
    if not text.strip():
        raise typer.BadParameter('the path is empty; give a folder or file')
    return Path(text)


def fly(
    vehicle: Annotated[
        str,
        typer.Argument(
            metavar='VEHICLE',
            help='Name of a shipped vehicle, or path of a vehicle file.',
            autocompletion=complete_names('vehicle'),
        ),
    ],
    arguments: Annotated[
        list[str] | None,
        typer.Argument(
            metavar='[NAME:=VALUE]...', help='Arguments of lta launch fly, such as of the tracker.'
        ),
    ] = None,
    flights: Annotated[
        int, typer.Option(help='Number of flights; the last one confirms.', min=1, max=20)
    ] = 2,
    room: Annotated[
        float,
        typer.Option(
            help='Way across the origin of the tracker that the drone needs, in metres.',
            min=1.0,
            max=100.0,
        ),
    ] = 6.0,
    height: Annotated[
        float, typer.Option(help='Height of the hull centre, in metres.', min=0.1, max=100.0)
    ] = 1.2,
    seconds: Annotated[
        float, typer.Option(help='Time of each flight in which sticks move.', min=1.0, max=600.0)
    ] = 60.0,
    out: Annotated[
        Path | None,
        typer.Option(
            help='Folder of the results; in runs/ by default.',
            parser=parse_folder,
            metavar='FOLDER',
        ),
    ] = None,
) -> None:
    """
    Fly by motion capture what calibrates a vehicle, and record it.

    In each flight the drone takes off, flies to the origin of the tracker, and moves there as a
    pilot would: one axis at a time, then all in commands of several sizes that change every second
    or two. It returns after each piece, and lands. By default the simulator plays drone and
    tracker. Of the tests of "lta tests plan" these are the steps and free flights; weigh, float,
    swing and spin-down need a hand.

    A real drone is armed by you, in another terminal. If the tracker is lost, or this program
    ends, the drone lands. The last line is the command that calibrates the vehicle by the flights.

    Exit status 0: all flights are recorded. 1: a flight ended early, its bag stays. 2: bad input.
    130: Ctrl-C.

    Example: lta tests fly gtmab --seconds 30 offset_x:=3.5

    Example: lta tests fly gtmab source:=crazyflie light_board:=true
    tracker_pose:=/vrpn_mocap/lta1/pose
    """
    folder, console = resolve_folder(out, 'tests'), plain_console()
    control = load_vehicle(vehicle).file.control
    plans = []
    for k in range(flights):
        values = {
            'vehicle': vehicle,
            **({'gains': control.gains} if control and control.gains else {}),
            'commanded': 'true',
            'tracker': 'true',
            'teleop': 'true',
            'pilot': 'true',
            'pilot_room': f'{room}',
            'pilot_height': f'{height}',
            'pilot_seconds': f'{seconds}',
            'seed': f'{k + 1}',
            'bag': f'{folder / f"flight_{k + 1}"}',
            **parse_arguments(arguments or []),
        }
        plans.append(FLY.build_plan(values))
        check_plan(plans[-1])
    bags = []
    for k, plan in enumerate(plans):
        console.print(f'Flight {k + 1} of {flights}', highlight=False)
        if any(process.executable == ARMING_NODE for process in plan.processes):
            arm = format_lta_command('call', f'{ARMING_NODE}/arm', 'true')
            console.print(f'In another terminal, within a minute of take_off: {arm}')
        end = run_graph(plan, print_node_line, print_event)
        if is_refusal(end):
            raise BadInput(end.lines[-1])
        if end.name != PILOT or not end.success:
            raise typer.Exit(1)
        bags.append(str(relative_path(folder / f'flight_{k + 1}')))
    train, confirm = bags[: max(flights - 1, 1)], bags[1:][-1:]
    words = ('--train', *train, *(('--confirm', *confirm) if confirm else ()))
    command = format_lta_command('calibrate', '--vehicle', vehicle, *words)
    console.print(f'Next: {command}', highlight=False, markup=False, soft_wrap=True)
