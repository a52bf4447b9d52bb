"""lta light bearing: compare the bearing errors of the paper's estimator and ours."""

import math
from typing import Annotated

from lta_cli.options.common_options import VehicleOption
from lta_cli.options.study_command import study_command, StudyRun
from lta_config.errors import BadInput, unknown_name_error
from lta_report.report import Report
from lta_report.study import hash_inputs, Study
from lta_studies.light.bearing.places import build_flight_spec, PLACES, TrueDiodes
from lta_studies.light.bearing.report import build_report, format_range
from lta_studies.light.bearing.run import BearingTrialRequest, STORE
import typer

ANY = 'any'


@study_command('bearing', quick={'poses': 20})
def bearing(
    vehicle: VehicleOption = 'gtmab',
    place: Annotated[
        list[str] | None,
        typer.Option(help='Where to simulate: indoor or outdoor; repeat for both; default: both.'),
    ] = None,
    diodes: Annotated[
        list[int] | None,
        typer.Option(
            help='Number of photodiodes in the ring; repeat to compare several; default: 4, 8, '
            '16.',
            min=1,
            max=64,
        ),
    ] = None,
    range_: Annotated[
        list[str] | None,
        typer.Option(
            '--range',
            help='Distance to the lamp in metres, or "any" (random); repeat to compare several; '
            'default: 3, 7, any.',
        ),
    ] = None,
    poses: Annotated[
        int,
        typer.Option(
            help='Number of random poses for each combination of place, diodes and distance.',
            min=1,
            max=1_000_000,
        ),
    ] = 500,
    response: Annotated[
        list[float] | None,
        typer.Option(
            help='True exponent of the simulated diodes, of which the drone only knows the '
            'vehicle file; repeat to compare several; by default as in the file.',
            min=0.3,
            max=10.0,
        ),
    ] = None,
    gain_spread: Annotated[
        list[float] | None,
        typer.Option(
            help='True spread of the gains in percent; repeat to compare several; by default as '
            'in the file.',
            min=0.0,
            max=50.0,
        ),
    ] = None,
    off_axis: Annotated[
        float,
        typer.Option(
            help="Largest angle between the lamp's axis and the drone, degrees; 0: on the axis, "
            'at a --range in metres.',
            min=0.0,
            max=60.0,
        ),
    ] = 60.0,
    turn: Annotated[
        int,
        typer.Option(
            help='Number of light blocks of a turn in place, before each pose, from which the '
            'drone learns gains and response of its photodiodes.',
            min=0,
            max=1000,
        ),
    ] = 0,
    seed: Annotated[int, typer.Option(help='Random seed.', min=0)] = 1,
    *,
    run: StudyRun,
) -> Report:
    """
    Evaluate bearing estimation: the paper's weighted mean against our fit.

    Simulates random poses in front of the lamp, through diodes, amplifiers, ADC and demodulator.
    Reports the median of the bearing error with its interval, its 95 % quantile, the coverage of
    the fit's 95 % interval, the elevation error, and the median error at the Cramer-Rao bound of
    the deviation. The drone assumes the photodiodes of the vehicle file; --response and
    --gain-spread simulate others. Indoor is the shared room with reflections; outdoor is a field
    in daylight of 80 klux, with suitable diodes.

    Exit status 0: done. 2: bad input. 130: Ctrl-C.

    Example: lta light bearing --place indoor --diodes 8 --range any --poses 10000
    """
    request = BearingTrialRequest(
        vehicle,
        tuple(dict.fromkeys(place or PLACES)),
        tuple(dict.fromkeys(diodes or (4, 8, 16))),
        # None stands for random distances
        tuple(dict.fromkeys(map(parse_range, range_ or ('3', '7', ANY)))),
        poses,
        seed,
        tuple(
            TrueDiodes(exponent, spread)
            for exponent in dict.fromkeys(response or (None,))
            for spread in dict.fromkeys(each / 100.0 for each in gain_spread or ()) or (None,)
        ),
        turn,
        math.radians(off_axis),
    )
    for name in request.places:
        if name not in PLACES:
            raise unknown_name_error('place', name, list(PLACES))
    # Also checks that the vehicle fits the scenes before any work
    specs = [build_flight_spec(PLACES[name], vehicle, 1) for name in request.places]
    inputs = (poses, seed, turn, off_axis, *(spec.contents for spec in specs))
    study = Study(request.evaluate, str, STORE, 'combinations')
    results = run.run_study(study, hash_inputs(*inputs), request.list_cases())
    return build_report(results, request)


def parse_range(text: str) -> float | None:
    """Parse a range in m; return None for "any"."""
    if text == ANY:
        return None
    try:
        distance = float(text)
    except ValueError:
        distance = math.nan
    # NaN fails this test as well
    if not 1.0 <= distance <= 100.0:
        raise BadInput(
            f"--range '{text}' is not a distance; give 1 to 100 metres, or {format_range(None)}."
        )
    return distance
