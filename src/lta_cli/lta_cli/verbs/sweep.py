"""lta sweep: many flights of one design."""

from collections import Counter
import math
from pathlib import Path
from typing import Annotated

from lta_cli.options.json_option import print_json
from lta_cli.options.out_option import parse_folder
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
    file: Annotated[str, typer.Argument(help='A shipped name (heaviness) or a sweep file.')],
    out: Annotated[
        Path | None,
        typer.Option(
            help='Folder of the results; runs/sweep-<name>-<hash> by default.',
            parser=parse_folder,
            metavar='FOLDER',
        ),
    ] = None,
    workers: Annotated[
        int | None, typer.Option(help='Worker processes; one per processor by default.', min=1)
    ] = None,
    scheduler: Annotated[
        str | None,
        typer.Option(metavar='ADDRESS', help='Fly on the Dask cluster of this scheduler instead.'),
    ] = None,
    device: Annotated[
        Device | None,
        typer.Option(help='Fly as one batch: on all cores (cpu-batch) or on a GPU (gpu).'),
    ] = None,
    duties: Annotated[
        str | None,
        typer.Option(
            metavar='A,B,...', help='With --device: an open loop with this duty of each rotor.'
        ),
    ] = None,
    retry: Annotated[
        bool, typer.Option('--retry-failed', help='Fly again what could not be flown.')
    ] = False,
    page: Annotated[bool, typer.Option(help='Write the page of the sweep.')] = True,
    json: Annotated[bool, typer.Option('--json', help='Print the summary as JSON.')] = False,
) -> None:
    """
    Fly a grid or a Monte Carlo of scenarios, one process a processor, into one table and a page.

    A sweep file names vehicle, scenario, strategy, gains and seeds, and what to vary: any
    parameter by its path (see "lta simulate --help"), as a list of values or as a distribution
    (normal, uniform, loguniform, choice) that is drawn "samples" times. Lists are combined, each
    value with each; every point of that grid gets the same draws and seeds. The drone is told of
    what is varied, as if it stood in its files. All is checked before the first flight.

    Each flight is kept as it ends: a sweep that was stopped or killed goes on where it was when
    the same command is given again. A flight that cannot be flown is kept with its seed and the
    reason. flights.parquet has a row a flight, SI units and meanings with the columns.

    --device flies thousands of loops side by side, strategy bag only: the lamp is heard from
    geometry and noise instead of ADC blocks, so that flights agree with the others in
    distribution, not seed by seed. A batch tells no cruise and no errors of the estimator.

    Exit status 0: all flights were flown. 1: some could not be. 2: bad input, nothing was flown.
    130: Ctrl-C.

    Example: lta sweep heaviness --workers 2
    """
    console = plain_console(stderr=json)
    asked = parse_duties(duties)
    check_options(device, asked, workers, scheduler)
    order = SweepRequest(file, out, workers, scheduler, retry, page, device, asked)
    try:
        done = sweep_once(order, console)
    except KeyboardInterrupt:
        console.print('What was flown is kept; the same command goes on from there.')
        raise
    if json:
        print_json(sweep_to_dict(done))
    print_summary(done, console)
    if any(row.outcome == FAILED for row in done.rows):
        raise typer.Exit(1)


def parse_duties(text: str | None) -> tuple[float, ...]:
    """Return the duties in a text; `BadInput` where they are none."""
    try:
        found = tuple(float(word) for word in text.split(',')) if text else ()
    except ValueError:
        found = (math.nan,)
    if not all(-1.0 <= duty <= 1.0 for duty in found):
        raise BadInput(f"The duties are '{text}'; give numbers from -1 to 1 with commas between.")
    return found


def check_options(
    device: Device | None, duties: tuple[float, ...], workers: int | None, scheduler: str | None
) -> None:
    """Refuse options that exclude each other."""
    if duties and device is None:
        raise BadInput('An open loop (--duties) is flown as a batch; add --device.')
    if device is not None and (workers is not None or scheduler is not None):
        raise BadInput('A batch (--device) needs no --workers and no --scheduler; leave them out.')


def sweep_to_dict(done: SweepRun) -> dict[str, object]:
    """Return what --json prints."""
    share = reached_share(done.rows)
    return {
        'flights': len(done.rows),
        'outcomes': dict(Counter(row.outcome for row in done.rows)),
        'reached_share': share.value,
        'reached_low': share.low,
        'reached_high': share.high,
        'flown': done.flown,
        'workers_lost': done.deaths,
        'rate': done.flown / done.wall if done.wall else 0.0,
        'table': str(done.table),
        **({} if done.page is None else {'page': str(done.page)}),
        'units': {'rate': '1/s', 'reached_share': '1', 'reached_low': '1', 'reached_high': '1'},
    }


def print_summary(done: SweepRun, console: Console) -> None:
    """Say what came out and where it is."""
    lines = [format_title(done.plan, done.rows)]
    if done.flown:
        rate = done.flown / done.wall
        lines.append(f'{done.flown} flights in {done.wall:.0f} s: {rate:.2f} flights/s.')
    else:
        lines.append('All of it had been flown before.')
    if done.deaths:
        lines.append(f'{done.deaths} workers were lost; their flights were given to others.')
    failures = Counter(row.sentence for row in done.rows if row.outcome == FAILED)
    for sentence, count in failures.most_common(3):
        lines.append(f'{count} failed: {sentence}')
    lines.append(f'Table {done.table}')
    if done.page is not None:
        lines.append(format_page_line(done.page))
    console.print('\n'.join(lines), highlight=False, markup=False, soft_wrap=True)
