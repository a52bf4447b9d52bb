"""lta tests plan: list the tests of an afternoon that calibrate a vehicle."""

from typing import Annotated

from lta_cli.options.common_options import VehicleName
from lta_cli.options.study_command import report_command
from lta_discovery.lab_tests.design import ROOM
from lta_discovery.lab_tests.plan import plan_lab_tests
from lta_discovery.lab_tests.plan_report import build_plan_report
from lta_model.vehicle import load_vehicle
from lta_report.report import Report
import typer


@report_command('tests-plan')
def plan(
    vehicle: VehicleName,
    wrench: Annotated[
        bool,
        typer.Option(
            '--wrench', help='The vehicle is commanded by force and moment instead of duties.'
        ),
    ] = False,
    room: Annotated[
        float,
        typer.Option(help='Longest way of a test in metres; steps are made smaller.', min=0.5),
    ] = ROOM,
) -> Report:
    """
    List the tests of an afternoon with a tracker that calibrate a vehicle.

    It needs the logged position and attitude of the vehicle (motion capture, or a camera that sees
    markers on it) and its commands, on one clock. Weigh it, let it float, let it swing, a step on
    each commanded axis, a spin-down, and two free flights; for each why, how long, how large, and
    what can go wrong. All follows from the vehicle file: each test is rehearsed with its model,
    and listed if its poses teach something that shorter tests do not. The page can be printed.

    Exit status 0: done. 2: bad input.

    Example: lta tests plan gtmab --room 3
    """
    loaded_vehicle = load_vehicle(vehicle)
    test_plan = plan_lab_tests(loaded_vehicle, vehicle, 'wrench' if wrench else 'rotors', room)
    return build_plan_report(test_plan, loaded_vehicle)
