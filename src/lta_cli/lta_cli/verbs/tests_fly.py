# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""lta tests fly: fly by motion capture what calibrates a vehicle, and record it."""

from typing import final

from lta_analysis.console import print_lines
from lta_cli.verbs.launch import print_event, print_node_line
from lta_config.command_line import format_lta_command, relative_path
from lta_config.errors import BadInput
from lta_flight.flight import is_refusal, parse_status
from lta_flight.graph import run_graph
from lta_flight.preflight import check_plan
from lta_graph.launch_plan import parse_arguments
from lta_graph.launches import FLY
from lta_model.vehicle import load_vehicle
from lta_report.request import Action, argument, Folder, option, Outcome, VEHICLE_NAME
from lta_report.results_folder import resolve_folder
from rich.console import Console

PILOT = 'pilot'  # the node that ends a flight
ARMING_NODE = 'crazyflie_bridge'  # the node that arms a real drone


@final
class TestsFlyRequest(Action, command='tests fly'):
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

    vehicle: str = VEHICLE_NAME
    arguments: tuple[str, ...] = argument(
        'Arguments of lta launch fly, such as of the tracker.', default=(),
        metavar='[NAME:=VALUE]...',
    )  # fmt: skip
    flights: int = option('Number of flights; the last one confirms.', default=2, low=1, high=20)
    room: float = option(
        'Way across the origin of the tracker that the drone needs, in metres.', default=6.0,
        low=1.0, high=100.0,
    )  # fmt: skip
    height: float = option(
        'Height of the hull centre, in metres.', default=1.2, low=0.1, high=100.0
    )
    seconds: float = option(
        'Time of each flight in which sticks move.', default=60.0, low=1.0, high=600.0
    )
    out: Folder | None = option(
        'Folder of the results; in runs/ by default.', default=None, metavar='FOLDER'
    )

    def run(self, console: Console) -> Outcome[None]:
        """Fly all flights, and print the command that calibrates by them."""
        folder = resolve_folder(self.out, 'tests')
        control = load_vehicle(self.vehicle).file.control
        plans = []
        for k in range(self.flights):
            values = {
                'vehicle': self.vehicle,
                **({'gains': control.gains} if control and control.gains else {}),
                'commanded': 'true',
                'tracker': 'true',
                'teleop': 'true',
                'pilot': 'true',
                'pilot_room': f'{self.room}',
                'pilot_height': f'{self.height}',
                'pilot_seconds': f'{self.seconds}',
                'seed': f'{k + 1}',
                'bag': f'{folder / f"flight_{k + 1}"}',
                **parse_arguments(list(self.arguments)),
            }
            plans.append(FLY.build_plan(values))
            check_plan(plans[-1])
        bags = []
        for k, plan in enumerate(plans):
            print_lines(console, f'Flight {k + 1} of {self.flights}')
            if any(process.executable == ARMING_NODE for process in plan.processes):
                arm = format_lta_command('call', f'{ARMING_NODE}/arm', 'true')
                print_lines(console, f'In another terminal, within a minute of take_off: {arm}')
            end = run_graph(plan, print_flight_line, print_event)
            if is_refusal(end):
                raise BadInput(end.lines[-1])
            if end.name != PILOT or not end.success:
                return Outcome(None, status=1)
            bags.append(str(relative_path(folder / f'flight_{k + 1}')))
        train, confirm = bags[: max(self.flights - 1, 1)], bags[1:][-1:]
        words = ('--train', *train, *(('--confirm', *confirm) if confirm else ()))
        command = format_lta_command('calibrate', '--vehicle', self.vehicle, *words)
        print_lines(console, f'Next: {command}')
        return Outcome(None)


def print_flight_line(node: str, line: str) -> None:
    """Print a line of a node, except the simulator's outcome: these flights reach no lamp."""
    if parse_status(line) is None:
        print_node_line(node, line)
