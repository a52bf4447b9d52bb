"""lta hardware bench: bench-test one motor of a tethered drone."""

from contextlib import closing
import math
import sys
import time
from typing import Annotated

from lta_analysis.console import plain_console
from lta_bridge.crazyflie.connection_manager import CONNECT_TIME
from lta_bridge.crazyflie.drone_lock import DroneLock
from lta_bridge.crazyflie.link import CrazyflieLink, LinkFailed
from lta_bridge.crazyflie.links import create_link
from lta_bridge.crazyflie.log_table import BLOCKS
from lta_bridge.hardware.motor import interrupt_on_signals, MotorBench, MotorTurnResult
from lta_cli.options.common_options import Json, print_json, VehicleOption
from lta_config.errors import BadInput, unknown_name_error
from lta_config.schema.crazyflie_file import find_crazyflie, MOTORS
from lta_model.vehicle import load_vehicle
from lta_report.progress_bar import ProgressBar
from rich.console import Console
from rich.progress import BarColumn, TextColumn
import typer

MOST = 0.3  # duty: turns every rotor, lifts nothing
LONGEST = 10.0  # s
LEAST = 1.0 / 256.0  # smallest duty of 8-bit PWM that turns a motor; the app keeps m1 just above 0


def bench(
    motor: Annotated[
        str, typer.Argument(help='Motor to turn: m1, m2, m3 or m4, numbered as on the Crazyflie.')
    ],
    uri: Annotated[str, typer.Option(help='URI of the Crazyflie.')] = (
        'radio://0/80/2M/E7E7E7E7E7'
    ),
    vehicle: VehicleOption = 'gtmab',
    duty: Annotated[
        float, typer.Option(help='Motor duty as a fraction of full power.', min=0.01, max=MOST)
    ] = 0.1,
    seconds: Annotated[
        float, typer.Option(help='Duration in seconds.', min=0.2, max=LONGEST)
    ] = 2.0,
    json: Json = False,
) -> None:
    """
    Turn one motor of a TETHERED drone at low duty, after a typed confirmation.

    The drone must run the app of firmware/crazyflie, which stops the motor 200 ms after the last
    command, even if this program dies. Ctrl-C, an error or a lost link disarm the drone.

    Exit status 0: only this motor turned. 1: it did not turn, or another one did. 2: bad input, or
    not confirmed. 130: Ctrl-C.

    Example: lta hardware bench m1 --duty 0.1 --seconds 2
    """
    console = plain_console(stderr=json)
    craft = load_vehicle(vehicle)
    file = find_crazyflie(vehicle, craft.file.name)
    if motor not in MOTORS:
        raise unknown_name_error('motor', motor, list(MOTORS))
    # Setpoints reach the firmware's controller, which turns several motors
    if file.command != 'motors':
        raise BadInput(
            f"Vehicle '{vehicle}' uses the stock firmware, which cannot turn a single motor "
            'safely; flash the app in firmware/crazyflie and choose a --vehicle that uses it.'
        )
    # Not opened yet: the radio stays silent until the user has confirmed
    link = create_link(uri, BLOCKS, time.time_ns)
    # Nobody else may command the drone meanwhile
    with closing(DroneLock(uri)):
        confirm_motor(motor, file.motors[motor], duty, seconds, console)
        turned = turn_motor(
            MotorBench(link, file, craft, motor), link, (motor, duty, seconds), console
        )
    # Half the command is enough to show that the motor turned; the others must stand still
    right = turned.duty > 0.5 * duty and turned.others < LEAST
    if json:
        # JSON has no NaN
        volts = turned.voltage if math.isfinite(turned.voltage) else None
        print_json({**turned._asdict(), 'voltage': volts, 'alone': right})
    console.print(format_outcome(motor, turned, right), highlight=False, soft_wrap=True)
    if not right:
        raise typer.Exit(1)


def turn_motor(
    bench: MotorBench, link: CrazyflieLink, request: tuple[str, float, float], console: Console
) -> MotorTurnResult:
    """Open the link, turn the motor and always close the link."""
    motor, duty, seconds = request
    columns = (TextColumn('{task.description}'), BarColumn())
    with interrupt_on_signals():
        try:
            # Opened inside the signal handler, so that Ctrl-C closes it
            link.open(CONNECT_TIME)
            with ProgressBar(console, *columns, begin=f'{motor} turns', total=seconds) as bar:
                return bench.turn_motor(duty, seconds, lambda been: bar.update_bar(completed=been))
        except LinkFailed as error:
            # A lost link stops the motor: the firmware's time-out disarms the drone
            sys.stderr.write(f'The test of motor {motor} failed: {error}.\n')
            raise typer.Exit(1) from None
        finally:
            link.close()


def confirm_motor(motor: str, rotor: str, duty: float, seconds: float, console: Console) -> None:
    """
    Ask the user to confirm by typing the motor's name.

    Raises BadInput if anything else is typed, or stdin is closed.
    """
    answer = f'spin {motor}'
    console.print(
        f'Motor {motor} ({rotor}) is about to turn at {duty:.0%} duty for {seconds:g} s. '
        f"Tether the drone, keep fingers and strings away, then type '{answer}':",
        highlight=False, soft_wrap=True,
    )  # fmt: skip
    # A closed stdin gives an empty line, which is refused
    if sys.stdin.readline().strip() != answer:
        raise BadInput(f"Cancelled: '{answer}' was not typed, so no motor turned.")


def format_outcome(motor: str, turned: MotorTurnResult, right: bool) -> str:
    """Return the result of the test as text."""
    cell = (
        f'; the battery voltage fell to {turned.voltage:.2f} V'
        if math.isfinite(turned.voltage)
        else ''
    )
    text = (
        f'Motor {motor} turned at up to {turned.duty:.0%} duty, the others at '
        f'{turned.others:.0%}{cell}.'
    )
    if right:
        return (
            f'{text} Check that the right rotor turned, and that it blew in the right direction.'
        )
    return f'{text} This differs from the command; check the firmware before flying.'
