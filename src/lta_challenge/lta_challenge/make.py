"""Make a challenge: a folder for each case, and the encoded answers."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, partial
import json
from pathlib import Path
import shutil
from typing import Any, Final, final

from lta_bridge.provenance import read_commit
from lta_challenge.answer_key import NAME as SEALED
from lta_challenge.answer_key import write_answers
from lta_challenge.case import CaseGenerator, ChallengeCase, ChallengeVehicle, SECONDS
from lta_challenge.digest import compute_registry_digest, vehicle_digest
from lta_challenge.other.case_generator import OtherCaseGenerator
from lta_challenge.recording import write_bag
from lta_challenge.rough_case import RoughCaseGenerator
from lta_challenge.rows import find_challenge_row, Kind
from lta_config.errors import BadInput
from lta_config.files import find_file
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import list_free_parameters
from lta_model.vehicle import load_vehicle
from lta_report.results_folder import check_creatable, stage_results, write_json
from lta_report.workers import ItemFailure, LocalWorkers

NAME: Final = 'challenge.json'
VEHICLE: Final = 'gtmab'
SCHEMA: Final = 1


@final
@dataclass(frozen=True, slots=True)
class ChallengeRequest:
    """A challenge to generate."""

    # Random seed, and number of cases
    seed: int
    count: int
    row: str = 'base'  # kind of flights, see `rows.ROWS`
    kind: Kind | None = None  # kind of hidden effects; None draws it for each case
    seconds: tuple[float, float] = SECONDS  # range of flight lengths [s]


@cache
def load_challenge_vehicle() -> ChallengeVehicle:
    """Load the vehicle that all challenges use."""
    vehicle = load_vehicle(VEHICLE)
    nominal = NominalVehicle.from_vehicle(vehicle)
    return ChallengeVehicle(vehicle, nominal, list_free_parameters(nominal))


def case_folder(number: int) -> str:
    """Return the name of a case's folder."""
    return f'case_{number:04d}'


def read_vehicle_text() -> str:
    """Return the text of the file of the vehicle that all challenges use."""
    return find_file('vehicle', VEHICLE).read_text(encoding='utf-8')


def draw_case(order: ChallengeRequest, number: int) -> ChallengeCase:
    """Generate one case with the simulator of its row."""
    about, row = load_challenge_vehicle(), find_challenge_row(order.row)
    if row.rough:
        return RoughCaseGenerator(about, read_vehicle_text(), order.seed, number).generate_case()
    if row.independent:
        return OtherCaseGenerator(
            about.vehicle, order.seed, number, order.kind, order.seconds
        ).generate_case()
    return CaseGenerator(
        about, order.seed, number, order.row, order.kind, order.seconds
    ).generate_case()


def _generate_case(order: ChallengeRequest, folder: Path, number: int) -> dict[str, Any]:
    """Generate and record one case; return its answer."""
    about, case = load_challenge_vehicle(), draw_case(order, number)
    place = folder / case_folder(number)
    # A worker may have died over it
    shutil.rmtree(place, ignore_errors=True)
    place.mkdir(parents=True)
    text = case.vehicle_file or read_vehicle_text()
    (place / 'vehicle.yaml').write_text(text, encoding='utf-8')
    metadata = {'challenge': str(order.seed), 'case': str(number), 'row': order.row}
    for flight in case.flights:
        write_bag(place / flight.name, flight.streams, about.vehicle.rotor_names, metadata)
    return case.answer


def generate_challenge(
    order: ChallengeRequest,
    folder: Path,
    workers: int = 1,
    on_case: Callable[[], None] = lambda: None,
) -> Path:
    """
    Generate a challenge; return the path of its description.

    `order`: what to generate. A case depends on seed, number, row, kind and flight lengths only.
    `folder`: new or empty folder. `on_case`: called after each finished case. Raise `BadInput` if
    the folder is not empty, the row is unknown, or a case cannot be generated.
    """
    find_challenge_row(order.row)
    check_creatable(folder)
    # The folder appears only when complete: an interrupted run leaves no partial challenge
    with stage_results(folder, NAME) as part:
        _generate_cases(order, part, workers, on_case)
    return folder / NAME


def _generate_cases(
    order: ChallengeRequest, part: Path, workers: int, on_case: Callable[[], None]
) -> None:
    """Generate all cases in parallel, then write the answers and the description."""
    answers: dict[str, Any] = {}
    with LocalWorkers(partial(_generate_case, order, part), workers) as pool:
        for number, answer in pool.run(range(order.count)):
            if isinstance(answer, ItemFailure):
                raise BadInput(f'Case {number} cannot be generated. {answer.reason}')
            answers[str(number)] = answer
            on_case()
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
        'registry': compute_registry_digest(),
        'vehicle_digest': vehicle_digest(VEHICLE),
        'commit': read_commit(),
    }
    write_json(about, part / NAME)


def read_challenge(folder: Path) -> dict[str, Any]:
    """Read the description of a challenge; raise `BadInput` if there is none."""
    try:
        content: dict[str, Any] = json.loads((folder / NAME).read_text(encoding='utf-8'))
        # Check that it is a challenge and not another JSON file of this name
        int(content['cases'])
    except (OSError, ValueError, TypeError, KeyError):
        raise BadInput(
            f"'{folder}' contains no challenge; create one: lta challenge make --out {folder}"
        ) from None
    return content
