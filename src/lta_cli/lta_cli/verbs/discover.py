"""lta discover: find what a vehicle file lacks, from measured flights."""

from pathlib import Path
from typing import Annotated

from lta_cli.options.common_options import RobotOption
from lta_cli.options.study_command import report_command, StudyRun
from lta_config.errors import BadInput
from lta_discovery.demo.demo import run_discovery_demo
from lta_discovery.discovery.run import discover_effects, DiscoveryRequest
from lta_discovery.progress import DiscoverProgress
from lta_report.report import Report
import typer

BAG = 'Bag folders, results folders or .mcap files'


@report_command('discover')
def discover(
    run: StudyRun,
    vehicle: Annotated[
        str | None,
        typer.Option(help='Vehicle whose model is compared with the flights, name or file.'),
    ] = None,
    train: Annotated[
        list[Path] | None, typer.Option(metavar='BAG...', help=f'Flights to learn from. {BAG}.')
    ] = None,
    confirm: Annotated[
        list[Path] | None,
        typer.Option(metavar='BAG...', help='Other flights of the same vehicle to learn from.'),
    ] = None,
    holdout: Annotated[
        list[Path] | None,
        typer.Option(
            metavar='BAG...', help='Flights whose forecasts judge the result; nothing is fitted.'
        ),
    ] = None,
    robot: RobotOption = None,
    demo: Annotated[
        bool,
        typer.Option(
            '--demo', help='Demonstration: simulate flights with a hidden effect and discover it.'
        ),
    ] = False,
    plan: Annotated[
        bool,
        typer.Option('--plan', help='Also plan the next flight that tells alternatives apart.'),
    ] = False,
    calibration: Annotated[
        bool,
        typer.Option(
            '--calibration/--no-calibration',
            help='Calibrate the vehicle first, where the flights call for it.',
        ),
    ] = True,
    seed: Annotated[int, typer.Option(help='Random seed of --demo.', min=0, max=2**31 - 1)] = 1,
) -> Report:
    """
    Find where a vehicle's model disagrees with its flights, and name what is missing.

    Where the flights call for it, the vehicle is calibrated first ("lta calibrate"): gains, delay,
    lift, marker frame. The search goes on from the calibrated values, and calibrated.yaml is the
    vehicle file with them.

    Effects of the library, numbers of the file that are wrong, and forces of other forms are
    compared by one posterior. A name is given if its probability is 95 % or more, with all names
    that these flights cannot tell from it. The result may also be that nothing is missing, or that
    the flights do not decide.

    Writes report.html, vehicle.yaml (the vehicle file with what is named), overlay.mcap (measured
    and forecast, for Foxglove) and discovery.json. With --plan, also next_flight.yaml, a scenario
    for "lta fly", where a flight tells alternatives apart.

    A single flight is split in time, which gives weaker evidence. Method and accuracy:
    docs/discovery.md.

    Exit status 0: done, whatever the result. 2: bad input, or flights too poor to analyse.

    Example: lta discover --vehicle gtmab --train A B --holdout C

    Example: lta discover --demo
    """
    bags = {'train': train or [], 'confirm': confirm or [], 'holdout': holdout or []}
    # Refuse contradictory options before any work
    if demo and (any(bags.values()) or vehicle):
        raise BadInput(
            '--demo simulates its own flights; remove --vehicle, --train, --confirm and --holdout.'
        )
    if not demo and vehicle is None:
        raise BadInput(
            'A vehicle file to compare the flights with is missing; name one with --vehicle, or '
            'try --demo.'
        )
    with DiscoverProgress(run.console) as progress:
        if vehicle is None:
            return run_discovery_demo(seed, run.folder, progress.show_stage)
        request = DiscoveryRequest(vehicle, bags, robot, plan, calibration)  # type: ignore[arg-type]
        return discover_effects(request, progress.show_stage)
