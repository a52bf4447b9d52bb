"""lta light study: repeat the paper's study of the number of photodiodes."""

from functools import partial
from itertools import product
import math
from typing import Annotated

from lta_cli.options.common_options import VehicleOption
from lta_cli.options.study_command import study_command, StudyRun
from lta_report.report import Report
from lta_report.study import hash_inputs, Study
from lta_studies.light.bearing.places import build_flight_spec, PLACES
from lta_studies.light.bearing.study import (
    ASIDE,
    COUNTS,
    READINGS,
    STORE,
    study_case,
)
from lta_studies.light.bearing.study_report import build_report
import typer


@study_command('study', quick={'readings': 5})
def light_study(
    vehicle: VehicleOption = 'gtmab',
    readings: Annotated[
        int,
        typer.Option(help='Number of photodiode readings in each direction.', min=1, max=10_000),
    ] = READINGS,
    seed: Annotated[int, typer.Option(help='Random seed.', min=0)] = 1,
    aside: Annotated[
        float,
        typer.Option(help="Angle between the lamp's axis and the drone, degrees.", min=0, max=60),
    ] = math.degrees(ASIDE),
    *,
    run: StudyRun,
) -> Report:
    """
    Repeat the paper's study of the number of photodiodes, with its estimator and with ours.

    Simulates 4, 8 and 16 diodes with the lamp 3 m away in 16 directions, 50 readings each, indoors
    and outdoors. Reports median errors, checks the paper's statements, and explains those that
    cannot hold.

    Exit status 0: done. 2: bad input. 130: Ctrl-C.

    Example: lta light study --seed 7
    """
    # Also checks that the vehicle fits the scenes before any work
    specs = [build_flight_spec(place, vehicle, 1) for place in PLACES.values()]
    cases = list(product(PLACES, COUNTS))
    turned = math.radians(aside)
    study = Study(partial(study_case, vehicle, readings, seed, turned), str, STORE, 'rings')
    inputs = (readings, seed, turned, *(spec.contents for spec in specs))
    results = run.run_study(study, hash_inputs(*inputs), cases)
    return build_report(results, vehicle, readings, seed, turned)
