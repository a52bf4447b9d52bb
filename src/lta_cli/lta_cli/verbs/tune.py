"""lta tune: tune controller gains over a range of helium losses."""

from typing import Annotated

from lta_cli.options.study_command import study_command, StudyRun
from lta_config.command_line import format_lta_command
from lta_config.parameter_override import parse_quantity
from lta_report.report import Report
from lta_studies.tune.report import build_report
from lta_studies.tune.run import fly_responses, tune_once, TuningRequest
from lta_studies.tune.step_response import TuningCase, TuningScene
import typer


def parse_mass(text: str) -> float:
    """Parse a mass in g or kg and return it in kg."""
    quantity = parse_quantity(text)
    # To kg; other units are not a mass
    factor = {'g': 1e-3, 'kg': 1.0}.get(quantity['unit']) if quantity else None
    if quantity is None or factor is None or not isinstance(quantity['value'], int | float):
        raise typer.BadParameter(
            f"'{text}' is not a mass; give a number with a unit, such as '6 g'"
        )
    return float(quantity['value']) * factor


@study_command('tune', quick={'cases': 2, 'budget': 20, 'draws': 4})
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
    *,
    run: StudyRun,
) -> Report:
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

    The results folder, by default runs/tune-<name>-<hash>, gets the new gains as gains.yaml. Every
    candidate is stored there, and repeating the command resumes. Ctrl-C stops at once and writes
    the best gains so far. The vehicle's own gains are not replaced: copy the new file if it is
    better.

    Exit status 0: done. 2: bad input, nothing was flown. 130: Ctrl-C.

    Example: lta tune gtmab --most '6 g' --budget 121 --out runs/tuned
    """
    arguments = [f'--least={1e3 * least:g} g', f'--most={1e3 * most:g} g', f'--cases={cases}']
    # The options of the stored command, so that repeating it resumes
    arguments += [
        f'--budget={budget}',
        f'--seed={seed}',
        *(f'--number={n}' for n in numbers or ()),
    ]
    start = [] if gains is None else ['--gains', gains]
    order = TuningRequest(
        vehicle, gains, least, most, cases, budget, draws, seed, tuple(numbers or ()), run.options,
        run.out, format_lta_command('tune', vehicle, *start, *arguments),
    )  # fmt: skip
    done = tune_once(order, run.console)
    run.open_folder(done.folder)
    if not run.page:
        return build_report(done, None)
    # Fly old and new gains once more, to plot their step responses
    scene = TuningScene(vehicle)
    cases_flown = [TuningCase(loss, seed + k) for k, loss in enumerate(done.losses)]
    old, new = (fly_responses(scene, side.gains, cases_flown) for side in (done.old, done.new))
    return build_report(done, (old, new))
