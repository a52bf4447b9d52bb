"""lta wind: compute each platform's wind limit."""

from typing import Annotated

from lta_cli.options.study_command import study_command, StudyRun
from lta_config.files import list_shipped_names
from lta_report.report import Report
from lta_studies.wind.limits import find_limits, WindStudyRequest
from lta_studies.wind.report import build_report
import typer

ROUGHNESS = [0.03, 0.1, 0.3]  # m: grass, crops, bushes and low houses (unverified, from memory)


@study_command('wind', quick='One seed, three airspeeds, coarse steps of the wind.')
def wind(
    vehicles: Annotated[
        list[str] | None,
        typer.Argument(help='Vehicle names or files; all shipped vehicles by default.'),
    ] = None,
    roughness: Annotated[
        list[float] | None,
        typer.Option(
            help='Roughness length of the ground in metres; repeat to compare several.',
            min=1e-5,
            max=5.0,
        ),
    ] = None,
    height: Annotated[
        float,
        typer.Option(help='Height of the hull centre above ground in metres.', min=0.1, max=100.0),
    ] = 0.5,
    reference: Annotated[
        float,
        typer.Option(
            help='Height above rough ground, in metres, for which the wind limits are given.',
            min=0.5,
            max=300.0,
        ),
    ] = 10.0,
    scenario: Annotated[
        str,
        typer.Option(
            help='Scenario to fly in. The study sets the mean wind; the turbulence is that of the '
            'scenario.'
        ),
    ] = 'windy_field',
    seeds: Annotated[
        int,
        typer.Option(
            help='Number of flights at each wind speed; the drone can fly in this wind if all of '
            'them make headway.',
            min=1,
            max=1000,
        ),
    ] = 3,
    fly: Annotated[
        bool, typer.Option(help='Simulate flights; --no-fly computes only the static limits.')
    ] = True,
    *,
    run: StudyRun,
) -> Report:
    """
    Report each platform's wind limit: uniform wind, and reference wind over rough ground.

    Static limits: the airspeed that the rotors can hold at constant height and heading, and the
    airspeeds above which the hull tumbles or rises nose-up regardless of its rotors. Flown limit:
    the strongest headwind in which the drone still approaches the lamp with every seed, at the
    best of several commanded airspeeds. Only platforms with a control law are flown.

    Wind over rough ground is given at the reference height, as a weather service measures it; the
    log law yields the wind at the height of the hull. The log law is not accurate close to the
    roughness length, so compare several.

    Ctrl-C reports the platforms that are finished.

    Exit status 0: done. 2: bad input. 130: Ctrl-C.

    Example: lta wind gtmab skye --roughness 0.03 --roughness 0.3
    """
    request = WindStudyRequest(
        # Remove duplicates and keep the order
        tuple(dict.fromkeys(vehicles or list_shipped_names('vehicles'))),
        tuple(sorted(set(roughness or ROUGHNESS))),
        height, reference, scenario, 1 if run.quick else seeds, run.quick, fly,
    )  # fmt: skip
    return build_report(find_limits(request, run.folder, run.options, run.console), request)
