"""lta tune: tune controller gains over a range of helium losses."""

from dataclasses import asdict
import math
from pathlib import Path
from typing import Annotated, Any

from lta_cli.options.output_options import Json, parse_folder, print_json
from lta_cli.options.plain_console import plain_console
from lta_cli.options.worker_options import WorkerCount
from lta_config.command_line import format_lta_command, relative_path
from lta_config.parameter_override import parse_quantity
from lta_report.json_value import replace_nonfinite
from lta_report.results_folder import format_page_line
from lta_studies.tune.compare import compare_costs, NAMES
from lta_studies.tune.margins import to_decibels
from lta_studies.tune.page import write_page
from lta_studies.tune.report_tables import (
    build_comparison_rows,
    build_helium_limit_rows,
    format_headline,
)
from lta_studies.tune.run import (
    fly_responses,
    GainSetResult,
    tune_once,
    TuningRequest,
    TuningResult,
)
from lta_studies.tune.step_response import TuningCase, TuningScene
from rich.console import Console
import typer

UNITS = {
    'loss': 'kg',
    'helium': 'g',
    'days': 'd',
    'phase': 'deg',
    'gain': 'dB',
    'delay': 's',
    'crossover': 'rad/s',
    'growth': '1/s',
    'swing': 'rad/s',
    'swing_angle': 'rad',
    'settle': 's',
    'overshoot': '1',
    'steady': '1',
}


def parse_mass(text: str) -> float:
    """Parse a mass in g or kg and return it in kg."""
    found = parse_quantity(text)
    # To kg; other units are not a mass
    factor = {'g': 1e-3, 'kg': 1.0}.get(found['unit']) if found else None
    if found is None or factor is None or not isinstance(found['value'], int | float):
        raise typer.BadParameter(
            f"'{text}' is not a mass; give a number with a unit, such as '6 g'"
        )
    return float(found['value']) * factor


def tune(
    vehicle: Annotated[str, typer.Argument(help='Vehicle name or file.')] = 'gtmab',
    gains: Annotated[
        str | None,
        typer.Option(help="Initial gains, name or file; the vehicle's by default."),
    ] = None,
    least: Annotated[
        float,
        typer.Option(
            help='Smallest loss of lift that the gains must handle, in g or kg.',
            parser=parse_mass,
            metavar='MASS',
        ),
        # Typer passes a text default through the parser
    ] = '0 g',  # type: ignore[assignment]
    most: Annotated[
        float,
        typer.Option(
            help='Largest loss of lift that the gains must handle, in g or kg.',
            parser=parse_mass,
            metavar='MASS',
        ),
    ] = '6 g',  # type: ignore[assignment]
    cases: Annotated[
        int,
        typer.Option(
            help='Number of lift losses, evenly spaced from --least to --most; each candidate set '
            'of gains is flown once with each loss.',
            min=1,
        ),
    ] = 4,
    budget: Annotated[
        int, typer.Option(help='Number of candidate sets of gains to fly.', min=1)
    ] = 121,
    draws: Annotated[
        int,
        typer.Option(
            help='Number of flights with random losses of lift on which old and new gains are '
            'compared.',
            min=2,
        ),
    ] = 20,
    numbers: Annotated[
        list[str] | None,
        typer.Option(
            '--number',
            metavar='PATH',
            help='Gain to tune, such as climb.kp; repeat to tune several. By default, all gains '
            'above 0.',
        ),
    ] = None,
    seed: Annotated[int, typer.Option(help='Random seed.', min=0, max=2**31 - 1)] = 1,
    workers: WorkerCount = None,
    out: Annotated[
        Path | None,
        typer.Option(help='Gains file to write; FOLDER/gains.yaml by default.', metavar='FILE'),
    ] = None,
    where: Annotated[
        Path | None,
        typer.Option(
            '--folder',
            help='Folder of the search log and the report; runs/tune-<name>-<hash> by default.',
            parser=parse_folder,
            metavar='FOLDER',
        ),
    ] = None,
    page: Annotated[bool, typer.Option(help='Write an HTML report of the tuning.')] = True,
    json: Json = False,
) -> None:
    """
    Tune controller gains that stay stable over a range of helium losses.

    For each loss, a candidate flies a step-response test (take-off, then steps of altitude,
    heading and forward speed, and a turn at speed) and one mission to the lamp, with sensor noise.
    The controller does not know the loss. The cost combines settling time, overshoot, steady-state
    error, oscillation (measured, or predicted by the linearised loop), rotor effort and mission
    time; half its mean and half its maximum over the losses count. CMA-ES searches the logarithms
    of the gains, within a factor of 6 and their declared bounds. Limits stay fixed unless --number
    names them.

    Old and new gains are then compared on new random cases that the search did not use. Stability
    margins of altitude, heading and speed come from the linearised loop, in hover and at 0.4 m/s.
    Flights determine the helium loss at which the gains fail.

    Every candidate is stored, and repeating the command resumes. Ctrl-C ends the search and keeps
    the best candidate. The vehicle's own gains are not replaced: copy the new file if it is
    better.

    Exit status 0: done. 2: bad input, nothing was flown. 130: Ctrl-C before the first candidate.

    Example: lta tune gtmab --most '6 g' --budget 121 --out gains.yaml
    """
    console = plain_console(stderr=json)
    asked = [f'--least={1e3 * least:g} g', f'--most={1e3 * most:g} g', f'--cases={cases}']
    # The options of the stored command, so that repeating it resumes
    asked += [f'--budget={budget}', f'--seed={seed}', *(f'--number={n}' for n in numbers or ())]
    start = [] if gains is None else ['--gains', gains]
    order = TuningRequest(
        vehicle, gains, least, most, cases, budget, draws, seed, tuple(numbers or ()), workers,
        where, out, format_lta_command('tune', vehicle, *start, *asked),
    )  # fmt: skip
    # Everything is stored during the search; Ctrl-C keeps the best candidate
    done = tune_once(order, console)
    target = None
    if page:
        scene = TuningScene(vehicle)
        examined = [TuningCase(loss, seed + k) for k, loss in enumerate(done.losses)]
        # Fly old and new gains once more, to plot their step responses
        target = write_page(
            done, *(fly_responses(scene, side.gains, examined) for side in (done.old, done.new))
        )
    if json:
        print_json(tuning_to_dict(done, target))
    print_summary(done, target, console)


def tuning_to_dict(done: TuningResult, page: Path | None) -> Any:  # noqa: ANN401 - what JSON holds
    """Return the content of --json."""
    gap = compare_costs(done.old.flights, done.new.flights)
    return replace_nonfinite(
        {
            'candidates': len(done.found.history),
            'flights': len(done.found.history) * len(done.losses),
            'stopped': done.found.stopped,
            'cost': {'old': done.found.first, 'new': done.found.cost},
            'fresh_difference': asdict(gap),
            'gains': dict(done.found.numbers),
            'old': gain_set_to_dict(done.old),
            'new': gain_set_to_dict(done.new),
            'file': str(done.file),
            **({} if page is None else {'page': str(page)}),
            'units': UNITS,
        }
    )


def gain_set_to_dict(side: GainSetResult) -> dict[str, object]:
    """Return the results of one set of gains as JSON data."""
    steps = {
        name: {
            figure: asdict(side.flights.summarize_step(k, figure))
            for figure in ('settle', 'overshoot', 'steady')
        }
        for k, name in enumerate(NAMES)
    }
    # A margin is None if the loop never reaches the critical gain or phase
    margins = []
    for each in side.steadiness:
        found = each.margins
        row: dict[str, object] = {
            'loop': each.loop, 'speed': each.speed, 'loss': each.loss, 'stable': each.stable,
            'growth': each.growth, 'swing': each.swing,
        }  # fmt: skip
        if found is not None:
            # Gain in dB, phase in degrees, as in Bode plots
            row |= {
                'gain': None if found.gain is None else to_decibels(found.gain),
                'gain_down': None if found.gain_down is None else to_decibels(found.gain_down),
                'phase': None if found.phase is None else math.degrees(found.phase),
                # Seconds of additional delay at which the loop becomes unstable
                'delay': found.delay,
                'crossover': found.crossover,
            }
        margins.append(row)
    limit = side.limit
    return {
        'lost': side.flights.lost_share._asdict(),
        'reached': side.flights.reached_share._asdict(),
        'cost': asdict(side.flights.compute_metric_quartiles('cost')),
        'swing_angle': asdict(side.flights.compute_metric_quartiles('swing')),
        'steps': steps,
        'margins': margins,
        'helium': {**asdict(limit), 'days': list(limit.days)},
    }


def print_summary(done: TuningResult, page: Path | None, console: Console) -> None:
    """Print a summary and the paths of the results."""
    # Column widths fit the longest label and value
    lines = [format_headline(done), f'{"":<40}{"old":<26}new']
    rows = build_comparison_rows(done) + build_helium_limit_rows(done.old.limit, done.new.limit)
    lines += [f'{name:<40}{old:<26}{new}' for name, old, new in rows]
    if done.found.stopped:
        lines.append(
            f'Stopped after {len(done.found.history)} candidates; repeat the command to resume.'
        )
    lines.append(f'Gains {relative_path(done.file)}')
    if page is not None:
        lines.append(format_page_line(page))
    console.print('\n'.join(lines), highlight=False, markup=False, soft_wrap=True)
