"""lta light link: compute illuminance and signal-to-noise ratio of a lamp by distance."""

from typing import Annotated

from lta_cli.options.common_options import VehicleOption
from lta_cli.options.study_command import report_command, StudyRun
from lta_model.scenario import load_scenario
from lta_model.vehicle import load_vehicle
from lta_report.report import Report
from lta_studies.light.link.link_budget import compute_lamp_link
from lta_studies.light.link.report import build_report
from rich.progress import track
import typer

SCENES = ['lamp_room', 'sunny_field']
DISTANCES = [0.5, 1.0, 2.0, 3.0, 5.0, 7.0, 10.0, 15.0]  # m


@report_command('link')
def link(
    scenario: Annotated[
        list[str] | None,
        typer.Option(
            help='Scenario with a lamp; repeat to compare several; default: lamp_room, '
            'sunny_field.'
        ),
    ] = None,
    vehicle: VehicleOption = 'gtmab',
    distance: Annotated[
        list[float] | None,
        typer.Option(
            help='Distance from the lamp in metres; repeat to compare several; default: 0.5 to '
            '15.',
            min=0.05,
            max=1000.0,
        ),
    ] = None,
    altitude: Annotated[
        float, typer.Option(help='Height of the hull centre in metres.', min=0.05, max=1000.0)
    ] = 1.3,
    feedback: Annotated[
        float | None,
        typer.Option(
            help="Feedback resistor of the photodiodes in kohm; default: the vehicle's own.",
            min=0.001,
            max=1e6,
        ),
    ] = None,
    blocks: Annotated[
        int, typer.Option(help='Number of ADC blocks simulated at each distance.', min=1, max=1000)
    ] = 20,
    *,
    run: StudyRun,
) -> Report:
    """
    Compute the link budget: illuminance at the photodiodes and SNR, by distance from a lamp.

    The drone is on the axis of the scene's first lamp and faces it. Direct: on a plane that faces
    the lamp. Read: at the brightest diode, with its angular response, room reflections and the
    shadow of the hull. Echo: at the darkest diode. SNR: as the demodulator reports it. In light
    that saturates the diodes there is none; --feedback tries another resistor.

    Exit status 0: done. 2: bad input.

    Example: lta light link --scenario lamp_room --distance 3 --distance 7
    """
    scenes = list(dict.fromkeys(scenario or SCENES))
    distances = sorted(set(distance or DISTANCES))
    # Load all before the first is computed
    read = [load_scenario(name) for name in scenes]
    links = [
        compute_lamp_link(
            load_vehicle(vehicle, each.air.density), each, distances, altitude, blocks, feedback
        )
        # The density of the scene's air belongs to the vehicle model
        for each in track(read, 'light link', console=run.console, transient=True)
    ]
    return build_report(links, vehicle, altitude)
