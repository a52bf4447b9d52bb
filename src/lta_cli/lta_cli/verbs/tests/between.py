"""lta tests between: plan the flight that tells two effects apart."""

from typing import Annotated

from lta_cli.options.common_options import VehicleOption
from lta_cli.options.study_command import report_command, StudyRun
from lta_config.command_line import format_lta_command, relative_path
from lta_discovery.planning.next_flight import FILE, plan_separating_flight, SCENE
from lta_discovery.progress import DiscoverProgress
from lta_report.report import Report
import typer


@report_command('tests-between')
def between(
    run: StudyRun,
    first: Annotated[str, typer.Argument(help='Effect, such as linear_drag.surge.')],
    second: Annotated[str, typer.Argument(help='Another effect.')],
    vehicle: VehicleOption,
    scenario: Annotated[str, typer.Option(help='Scenario to fly in, name or file.')] = SCENE,
) -> Report:
    """
    Plan the flight that tells two effects of a vehicle apart.

    Simulates manoeuvres with the vehicle file, the cheapest first, and with each effect. Writes
    next_flight.yaml, a scenario for "lta fly", or says why no flight tells them apart and what to
    measure instead.

    Exit status 0: done. 2: bad input.

    Example: lta tests between linear_drag.surge quadratic_drag.surge --vehicle gtmab
    """
    with DiscoverProgress(run.console) as progress:
        plan = plan_separating_flight(vehicle, first, second, scenario, tell=progress.show_stage)
    path = relative_path(run.folder / FILE)
    flies = plan.scenario is not None
    return Report(
        command='tests between',
        subject=f'{first}, {second}',
        headline=plan.text,
        introduction='Each effect was simulated at a size of two typical sizes.',
        tiles=[],
        blocks=(),
        data={'next_flight': plan.text, 'expected_nats': plan.nats,
              'scenario': str(path) if flies else None},
        commands={'fly it': format_lta_command('fly', '--vehicle', vehicle, '--scenario', path)}
        if flies
        else {},
        outputs={FILE: plan.format_scenario()} if flies else {},
    )  # fmt: skip
