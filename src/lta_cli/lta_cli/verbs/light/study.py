"""lta light study: repeat the paper's study of the number of photodiodes."""

import math
from typing import Annotated

from lta_cli.options.study_command import study_command, StudyRun
from lta_report.progress_bar import ProgressBar
from lta_report.report import Report
from lta_studies.light.bearing.places import build_flight_spec, PLACES
from lta_studies.light.bearing.study import (
    ASIDE,
    COUNTS,
    DIRECTIONS,
    READINGS,
    study_rings,
)
from lta_studies.light.bearing.study_report import build_report
import typer


@study_command('study', quick={'readings': 5})
def light_study(
    vehicle: Annotated[
        str, typer.Option(help='Vehicle that carries the photodiodes, name or file.')
    ] = 'gtmab',
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
    for place in PLACES.values():
        # Check that the vehicle fits the scenes before any work
        build_flight_spec(place, vehicle, 1)
    # Steps of the progress bar
    total = len(PLACES) * len(COUNTS) * DIRECTIONS
    with ProgressBar(run.console, begin='study', total=total) as bar:
        turned = math.radians(aside)
        rings = study_rings(vehicle, readings, seed, lambda: bar.update_bar(advance=1), turned)
    return build_report(rings, vehicle, readings, seed, turned)
