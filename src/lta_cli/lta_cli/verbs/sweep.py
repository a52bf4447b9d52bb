"""lta sweep: fly a parameter sweep or a Monte Carlo study."""

from collections import Counter
import math
from pathlib import Path
from typing import Annotated

from lta_cli.options.output_options import parse_folder, print_json
from lta_cli.options.plain_console import plain_console
from lta_config.errors import BadInput
from lta_flight.batch.fly import Device
from lta_flight.sweep.job_runner import FAILED
from lta_flight.sweep.page import format_title
from lta_flight.sweep.run import sweep_once, SweepRequest, SweepRun
from lta_flight.sweep.statistics import reached_share
from lta_report.results_folder import format_page_line
from rich.console import Console
import typer


def sweep(
    file: Annotated[
        str,
        typer.Argument(help='Sweep file, or the name of a shipped one, such as heaviness.'),
    ],
    out: Annotated[
        Path | None,
        typer.Option(
            help='Folder of the results; runs/sweep-<name>-<hash> by default.',
            parser=parse_folder,
            metavar='FOLDER',
        ),
    ] = None,
    workers: Annotated[
        int | None,
        typer.Option(help='Number of worker processes; one per processor by default.', min=1),
    ] = None,
    scheduler: Annotated[
        str | None,
        typer.Option(
            metavar='ADDRESS',
            help='Fly on a Dask cluster; address of its scheduler, such as tcp://127.0.0.1:8786.',
        ),
    ] = None,
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
    retry: Annotated[bool, typer.Option('--retry-failed', help='Repeat failed flights.')] = False,
    page: Annotated[bool, typer.Option(help='Write an HTML report of the sweep.')] = True,
    json: Annotated[bool, typer.Option('--json', help='Print the summary as JSON.')] = False,
) -> None:
    """
    Fly a parameter grid or a Monte Carlo study in parallel; write one table and a page.

    A sweep file names vehicle, scenario, strategy, gains, seeds and the parameters to vary, by
    path (see "lta simulate --help"): each a list of values or a distribution (normal, uniform,
    loguniform, choice) sampled "samples" times. Lists form a full grid, and every grid point gets
    the same samples and seeds. The drone's own model uses the varied values, too. Everything is
    checked before the first flight.

    Finished flights are stored, and repeating the command resumes a stopped sweep. Failed flights
    are stored with their seed and the reason. flights.parquet has one row per flight, with SI
    units and descriptions in the column metadata.

    --device flies thousands of closed loops at once, after one compilation of up to a minute for
    each strategy. It models the received lamp signal by geometry and noise instead of ADC blocks,
    so flights agree in distribution, not seed by seed. A batch reports no cruise data and no
    estimator errors. It supports every strategy, routes and several lamps, but no recorded wind,
    no courses, only the control law cascade, and no effects on measurements.

    Exit status 0: all flights were flown. 1: some failed. 2: bad input, nothing was flown. 130:
    Ctrl-C.

    Example: lta sweep heaviness --workers 2
    """
    console = plain_console(stderr=json)
    asked = parse_duties(duties)
    check_exclusive_options(device, asked, workers, scheduler)
    order = SweepRequest(file, out, workers, scheduler, retry, page, device, asked)
    try:
        done = sweep_once(order, console)
    except KeyboardInterrupt:
        # The entry point sets the exit status 130
        console.print('Finished flights are stored; repeat the command to resume.')
        raise
    if json:
        print_json(sweep_to_dict(done))
    print_summary(done, console)
    # Flights that missed the goal are results; only failed ones are errors
    if any(row.outcome == FAILED for row in done.rows):
        raise typer.Exit(1)


def parse_duties(text: str | None) -> tuple[float, ...]:
    """Parse rotor duties separated by commas, or raise `BadInput`."""
    try:
        found = tuple(float(word) for word in text.split(',')) if text else ()
    except ValueError:
        # NaN fails the range check below, which has the error message
        found = (math.nan,)
    if not all(-1.0 <= duty <= 1.0 for duty in found):
        raise BadInput(
            f"--duties '{text}' is invalid; give numbers from -1 to 1, such as 0.2,0.2."
        )
    return found


def check_exclusive_options(
    device: Device | None, duties: tuple[float, ...], workers: int | None, scheduler: str | None
) -> None:
    """Refuse options that exclude each other."""
    if duties and device is None:
        raise BadInput('--duties needs batch mode; add --device cpu-batch or --device gpu.')
    if device is not None and (workers is not None or scheduler is not None):
        raise BadInput(
            '--device cannot be combined with --workers or --scheduler; remove one of them.'
        )


def sweep_to_dict(done: SweepRun) -> dict[str, object]:
    """Return the content of --json."""
    share = reached_share(done.rows)
    return {
        'flights': len(done.rows),
        'outcomes': dict(Counter(row.outcome for row in done.rows)),
        'reached_share': share.value,
        'reached_low': share.low,
        'reached_high': share.high,
        'flown': done.flown,
        'workers_lost': done.deaths,
        # Zero if all flights were already stored
        'rate': done.flown / done.wall if done.wall else 0.0,
        'table': str(done.table),
        **({} if done.page is None else {'page': str(done.page)}),
        'units': {'rate': '1/s', 'reached_share': '1', 'reached_low': '1', 'reached_high': '1'},
    }


def print_summary(done: SweepRun, console: Console) -> None:
    """Print a summary and the paths of the results."""
    lines = [format_title(done.plan, done.rows)]
    if done.flown:
        rate = done.flown / done.wall
        lines.append(f'{done.flown} flights in {done.wall:.0f} s: {rate:.2f} flights/s.')
    else:
        lines.append('All flights were already stored; nothing was flown.')
    if done.deaths:
        lines.append(
            f'{done.deaths} worker processes ended unexpectedly; their flights were repeated or '
            'count as failed. Fly failed ones again with --retry-failed.'
        )
    failures = Counter(row.sentence for row in done.rows if row.outcome == FAILED)
    # The three most frequent reasons; the table has all
    for sentence, count in failures.most_common(3):
        lines.append(f'{count} failed: {sentence}')
    lines.append(f'Table {done.table}')
    if done.page is not None:
        lines.append(format_page_line(done.page))
    console.print('\n'.join(lines), highlight=False, markup=False, soft_wrap=True)
