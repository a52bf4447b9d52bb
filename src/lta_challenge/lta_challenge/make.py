"""Make a challenge: a folder for each case, and the encoded answers."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
import json
from pathlib import Path
from typing import Any, Final, final

from lta_bridge.provenance import read_commit
from lta_challenge.answer_key import NAME as SEALED
from lta_challenge.answer_key import write_answers
from lta_challenge.case import CaseGenerator, ChallengeCase, ChallengeVehicle, SECONDS
from lta_challenge.digest import registry_digest, vehicle_digest
from lta_challenge.other.case_generator import OtherCaseGenerator
from lta_challenge.recording import write_bag
from lta_challenge.rows import find_row, Kind
from lta_config.errors import BadInput
from lta_config.files import find_file
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import list_free_parameters
from lta_model.vehicle import load_vehicle
from lta_report.results_folder import check_creatable, stage_results, write_json
from lta_report.worker_pool import run_in_workers

NAME: Final = 'challenge.json'
VEHICLE: Final = 'gtmab'
SCHEMA: Final = 1


@final
@dataclass(frozen=True, slots=True)
class ChallengeRequest:
    """
    What to make.

    Attributes
    ----------
    seed, count : int
        Of the challenge; how many cases.
    row : str
        What the flights are like.
    kind : str or None
        What is hidden; drawn where nothing is asked for.
    seconds : pair of float
        Between which the lengths of the flights are. [s]

    """

    seed: int
    count: int
    row: str = 'base'
    kind: Kind | None = None
    seconds: tuple[float, float] = SECONDS


@cache
def load_challenge_vehicle() -> ChallengeVehicle:
    """Return the vehicle of all challenges."""
    vehicle = load_vehicle(VEHICLE)
    nominal = NominalVehicle.from_vehicle(vehicle)
    return ChallengeVehicle(vehicle, nominal, list_free_parameters(nominal))


def case_folder(number: int) -> str:
    """Return the name of a case's folder."""
    return f'case_{number:04d}'


def draw_case(order: ChallengeRequest, number: int) -> ChallengeCase:
    """Draw one case and fly it, with the simulator of its row."""
    about = load_challenge_vehicle()
    if find_row(order.row).independent:
        return OtherCaseGenerator(
            about.vehicle, order.seed, number, order.kind, order.seconds
        ).generate_case()
    return CaseGenerator(
        about, order.seed, number, order.row, order.kind, order.seconds
    ).generate_case()


def _make_case(order: ChallengeRequest, number: int, folder: Path) -> tuple[int, dict[str, Any]]:
    """Draw, fly and record one case; return its answer."""
    about, case = load_challenge_vehicle(), draw_case(order, number)
    place = folder / case_folder(number)
    place.mkdir(parents=True)
    vehicle = find_file('vehicle', VEHICLE).read_text(encoding='utf-8')
    (place / 'vehicle.yaml').write_text(vehicle, encoding='utf-8')
    told = {'challenge': str(order.seed), 'case': str(number), 'row': order.row}
    for flight in case.flights:
        write_bag(place / flight.name, flight.streams, about.vehicle.rotor_names, told)
    return number, case.answer


def make_challenge(
    order: ChallengeRequest,
    folder: Path,
    jobs: int = 1,
    tell: Callable[[int], None] = lambda _: None,
) -> Path:
    """
    Make a challenge; return the file that says what it is.

    Parameters
    ----------
    order : Order
        What to make. A case depends on seed, number, row and kind only.
    folder : Path
        Where to; empty or not there.
    jobs : int
        Processes.
    tell : callable
        Told how many cases there are, each time there is one more.

    Raises
    ------
    BadInput
        If the folder holds anything, or there is no such row.

    """
    find_row(order.row)
    check_creatable(folder)
    with stage_results(folder, NAME) as part:
        _make_cases(order, part, jobs, tell)
    return folder / NAME


def _make_cases(
    order: ChallengeRequest, part: Path, jobs: int, tell: Callable[[int], None]
) -> None:
    """Make all of a challenge, in whatever order the cases are done."""
    answers: dict[str, Any] = {}
    cases = [(order, number, part) for number in range(order.count)]
    for number, answer in run_in_workers(_make_case, cases, jobs, '--jobs'):
        answers[str(number)] = answer
        tell(len(answers))
    digest = write_answers(answers, part / SEALED)
    about = {
        'schema': SCHEMA,
        'seed': order.seed,
        'cases': order.count,
        'row': order.row,
        'kind': order.kind or '',
        'seconds': list(order.seconds),
        'vehicle': VEHICLE,
        'answers_sha256': digest,
        'registry': registry_digest(),
        'vehicle_digest': vehicle_digest(VEHICLE),
        'commit': read_commit(),
    }
    write_json(about, part / NAME)


def read_challenge(folder: Path) -> dict[str, Any]:
    """Return what a challenge says of itself; `BadInput` where there is none."""
    try:
        found: dict[str, Any] = json.loads((folder / NAME).read_text(encoding='utf-8'))
        int(found['cases'])
    except (OSError, ValueError, TypeError, KeyError):
        raise BadInput(
            f"'{folder}' has no challenge; make one with: lta challenge make --out {folder}"
        ) from None
    return found
