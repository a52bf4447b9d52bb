"""lta sweep: fly a parameter sweep or a Monte Carlo study."""

import math
from typing import Annotated

from lta_cli.options.study_command import study_command, StudyRun
from lta_config.errors import BadInput
from lta_flight.batch.fly import Device
from lta_flight.sweep.report import build_report
from lta_flight.sweep.run import sweep_once, SweepRequest
from lta_report.report import Report
from lta_report.study import StudyOptions
import typer


@study_command('sweep', quick='Fly only the first seed or sample of each case.')
def sweep(
    file: Annotated[
        str,
        typer.Argument(help='Sweep file, or the name of a shipped one, such as heaviness.'),
    ],
    device: Annotated[
        Device | None,
        typer.Option(
            help='Simulate all flights as one batch: on all cores (cpu-batch) or on a GPU (gpu).'
        ),
    ] = None,
    duties: Annotated[
        str | None,
        typer.Option(
            metavar='A,B,...',
            help='With --device: fly open loop with a constant duty from -1 to 1 for each rotor.',
        ),
    ] = None,
    *,
    run: StudyRun,
) -> Report:
    """
    Fly a parameter grid or a Monte Carlo study in parallel; write one table and a page.

    A sweep file names vehicle, scenario, strategy, gains, seeds and the parameters to vary, by
    path (see "lta simulate --help"): each a list of values or a distribution (normal, uniform,
    loguniform, choice) sampled "samples" times. Lists form a full grid, and every grid point gets
    the same samples and seeds. The drone's own model uses the varied values, too. Everything is
    checked before the first flight.

    Finished flights are stored in the results folder, by default runs/sweep-<name>-<hash>. A
    stopped sweep reports its finished flights, and repeating the command resumes it. Failed
    flights are stored with their seed and the reason. flights.parquet has one row per flight, with
    SI units and descriptions in the column metadata.

    --device flies thousands of closed loops at once, after one compilation of a minute or two for
    each strategy. It models the received lamp signal by geometry and noise instead of ADC blocks,
    so flights agree in distribution, not seed by seed. A batch reports no cruise data and no
    estimator errors. It supports every strategy, routes and several lamps, but no courses, only
    the control law cascade, and no effects on measurements.

    Exit status 0: all flights were flown. 1: some failed. 2: bad input, nothing was flown; or the
    workers failed. 130: Ctrl-C.

    Example: lta sweep heaviness --workers 2
    """
    duty_list = parse_duties(duties)
    check_exclusive_options(device, duty_list, run.options)
    order = SweepRequest(file, run.out, run.options, device, duty_list, run.quick)
    done = sweep_once(order, run.console)
    run.open_folder(done.folder)
    return build_report(done)


def parse_duties(text: str | None) -> tuple[float, ...]:
    """Parse rotor duties separated by commas, or raise `BadInput`."""
    try:
        duties = tuple(float(word) for word in text.split(',')) if text else ()
    except ValueError:
        # NaN fails the range check below, which has the error message
        duties = (math.nan,)
    if not all(-1.0 <= duty <= 1.0 for duty in duties):
        raise BadInput(
            f"--duties '{text}' is invalid; give numbers from -1 to 1, such as 0.2,0.2."
        )
    return duties


def check_exclusive_options(
    device: Device | None, duties: tuple[float, ...], options: StudyOptions
) -> None:
    """Refuse options that exclude each other."""
    if duties and device is None:
        raise BadInput('--duties needs batch mode; add --device cpu-batch or --device gpu.')
    if device is not None and (options.workers, options.scheduler) != (None, None):
        raise BadInput(
            '--device cannot be combined with --workers or --scheduler; remove one of them.'
        )
