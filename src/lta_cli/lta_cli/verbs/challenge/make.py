"""lta challenge make: generate flights with hidden effects."""

from typing import Annotated, Final

from lta_challenge.make import ChallengeRequest, generate_challenge
from lta_challenge.rows import parse_case_kind
from lta_cli.options.common_options import Out, plain_console, WorkerCount
from lta_config.errors import BadInput
from lta_config.machine import count_cores
from lta_report.formatting import format_count
from lta_report.results_folder import resolve_folder
from lta_report.study_progress import StudyProgress
import typer

SHORTEST: Final = 30.0  # s; the initial transient of a flight is not usable


def make(
    seed: Annotated[int, typer.Option(help='Random seed of the challenge.', min=0)] = 1,
    n: Annotated[int, typer.Option('--n', help='Number of cases.', min=1)] = 20,
    row: Annotated[
        str,
        typer.Option(
            help='Kind of flights. base: all sensors. worse: larger vehicle tolerances and sensor '
            'noise. structured: model errors in every flight. pose: only pose and commands are '
            'recorded. hover: only hovering flights. wrench: flown by force and moment commands. '
            'other: flown in an independent simulator. rough: wrong vehicle files, and logs with '
            'hand releases, starts on the floor, gaps, spikes and short flights; their lengths '
            'are fixed.'
        ),
    ] = 'base',
    kind: Annotated[
        str | None,
        typer.Option(
            help='Hidden effects in each case. clean: none. single: one of the effect library. '
            'pair: two of the library. outside: one that is not in the library. mixed: one of the '
            'library and one outside it. By default, a random kind for each case.'
        ),
    ] = None,
    seconds: Annotated[
        tuple[float, float],
        typer.Option(help='Shortest and longest duration of the flights, two numbers in seconds.'),
    ] = (60.0, 180.0),
    workers: WorkerCount = None,
    out: Out = None,
) -> None:
    """
    Generate cases: flights of a vehicle that is off by its tolerances and has a hidden effect.

    Each case is a folder with a vehicle file and the bags train, confirm and holdout. Hidden is
    nothing, one or two effects of the library, something outside the library, or both. In cases
    with an odd number the outside effect is of a kind that was not known while discovery was
    developed. The answer is in answers.sealed, which no study opens. A case depends only on seed,
    number, row and kind.

    The flights come from a separate integrator, rigid body, rotors, pilot, sensors and noise; they
    share only the effect equations with the project's model. Cases of the row "other" come from a
    simulator that shares no equations and has its own forces outside the library.

    Exit status 0: done. 2: bad input.

    Example: lta challenge make --seed 1 --n 20 --out runs/hidden
    """
    console = plain_console()
    # s; longer flights take hours to analyse
    if not SHORTEST <= seconds[0] <= seconds[1] <= 600.0:
        raise BadInput(
            f'--seconds must be two durations from {SHORTEST:g} to 600 s, the shorter one first.'
        )
    order = ChallengeRequest(
        seed, n, row, None if kind is None else parse_case_kind(kind), seconds
    )
    place = resolve_folder(out, f'challenge-{seed}')
    with StudyProgress(console, n, unit='cases') as progress:
        generate_challenge(order, place, workers or count_cores(), progress.count_item)
    console.print(f'{format_count(n, "case")} in {place}', highlight=False, soft_wrap=True)
