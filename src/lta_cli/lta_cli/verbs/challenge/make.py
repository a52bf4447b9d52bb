"""lta challenge make: flights in which something is hidden."""

from typing import Annotated, Final

from lta_challenge.make import ChallengeRequest
from lta_challenge.make import make_challenge as make_challenge
from lta_challenge.progress import challenge_bar, Jobs
from lta_challenge.rows import parse_kind
from lta_cli.options.out_option import Out
from lta_cli.options.plain_console import plain_console
from lta_config.errors import BadInput
from lta_report.results_folder import resolve_folder
from lta_studies.platforms.run import count_processors
import typer

SHORTEST: Final = 30.0  # s; the beginning and what is lost of it cannot be used


def make(
    seed: Annotated[int, typer.Option(help='Of the challenge.', min=0)] = 1,
    n: Annotated[int, typer.Option('--n', help='How many cases.', min=1)] = 20,
    row: Annotated[
        str, typer.Option(help='base, worse, structured, pose, hover, wrench or other.')
    ] = 'base',
    kind: Annotated[
        str | None, typer.Option(help='clean, single, pair, outside or mixed; drawn by default.')
    ] = None,
    seconds: Annotated[
        tuple[float, float], typer.Option(help='Least and greatest length of a flight.')
    ] = (60.0, 180.0),
    jobs: Jobs = None,
    out: Out = None,
) -> None:
    """
    Make cases: a vehicle off by its tolerances, flights of it, and something hidden in them.

    Each case is a folder with a vehicle file and three bags, train, confirm and holdout. Hidden
    is nothing, one effect of the library, two, something that is in no library, or an effect and
    something outside; in cases of odd number that is of a kind that was kept from discovery until
    it was finished. What it is stands in answers.sealed, which no study opens. A case depends on
    seed, number, row and kind only.

    The flights are made by an integrator, rigid body, rotors, pilot, sensors and noise of their
    own; of the project's model they share the equations of the effects. Those of the row other
    are made by a simulator that shares no equation with it either, and that has its own forces
    outside the library.

    Exit status 0: done. 2: bad input.

    Example: lta challenge make --seed 1 --n 20 --out hidden
    """
    console = plain_console()
    if not SHORTEST <= seconds[0] <= seconds[1] <= 600.0:
        raise BadInput(f'Flights are {SHORTEST:g} to 600 s long; give the shorter length first.')
    order = ChallengeRequest(seed, n, row, None if kind is None else parse_kind(kind), seconds)
    place = resolve_folder(out, f'challenge-{seed}')
    with challenge_bar(console, 'flying', n) as bar:
        make_challenge(
            order, place, jobs or count_processors(), lambda done: bar.update_bar(completed=done)
        )
    console.print(f'{n} cases in {place}', highlight=False, soft_wrap=True)
