"""lta energy hover: compare two hovering drones on identical cells."""

from typing import Annotated

from lta_cli.options.study_command import study_command, StudyRun
from lta_report.report import Report
from lta_report.study import hash_inputs, Study
from lta_studies.energy import paper
from lta_studies.energy.hover.report import build_report
from lta_studies.energy.hover.run import HoverRequest, STORE
import typer


@study_command('hover', quick={'seconds': 60})
def hover(
    vehicle: Annotated[
        str, typer.Option(help='Buoyant vehicle, name or file; both drones use its battery cell.')
    ] = 'gtmab',
    multirotor: Annotated[
        str, typer.Option('--beside', help='Multirotor to compare with, name or file.')
    ] = 'multirotor',
    seconds: Annotated[
        float, typer.Option(help='Duration in seconds.', min=1.0, max=7200.0)
    ] = paper.HOVER_TIME,
    *,
    run: StudyRun,
) -> Report:
    """
    Hover for 450 s on identical cells: a buoyant drone and a multirotor.

    Both fly in closed loop on the first one's cell, fully charged at the start. The cell voltage
    is compared with the same cell under the powers that the seed paper states: 1333 mW, and three
    times that for a standard drone. A drone drops out when its supply fails.

    Exit status 0: done, whichever lasted. 2: bad input.

    Example: lta energy hover --seconds 60
    """
    request = HoverRequest(vehicle, multirotor, seconds)
    identity = hash_inputs(seconds, *(spec.contents for spec in request.build_specs()))
    hovers = run.run_study(Study(request.fly, str, STORE, 'flights'), identity, range(2))
    return build_report(request.compare(hovers))
