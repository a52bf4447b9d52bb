"""Make a challenge: cases in folders of their own, and the answers sealed beside them."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
import json
from pathlib import Path
from typing import Any, Final, final

from lta_bridge.provenance import commit
from lta_challenge.case import Case, Drawing, Known, SECONDS
from lta_challenge.digest import registry_digest, vehicle_digest
from lta_challenge.other.drawing import OtherDrawing
from lta_challenge.recording import record
from lta_challenge.rows import Kind, row
from lta_challenge.sealed import NAME as SEALED
from lta_challenge.sealed import seal
from lta_config.errors import BadInput
from lta_config.files import find
from lta_discovery.model.knobs import knobs
from lta_discovery.model.nominal import Nominal
from lta_model.vehicle import load_vehicle
from lta_report.children import done_by
from lta_report.results_folder import all_at_once, can_be_made, keep_json

NAME: Final = 'challenge.json'
VEHICLE: Final = 'gtmab'
SCHEMA: Final = 1


@final
@dataclass(frozen=True, slots=True)
class Order:
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
def known() -> Known:
    """Return the vehicle of all challenges."""
    vehicle = load_vehicle(VEHICLE)
    nominal = Nominal.of(vehicle)
    return Known(vehicle, nominal, knobs(nominal))


def folder_of(number: int) -> str:
    """Return the name of a case's folder."""
    return f'case_{number:04d}'


def draw_case(order: Order, number: int) -> Case:
    """Draw one case and fly it, with the simulator of its row."""
    about = known()
    if row(order.row).independent:
        return OtherDrawing(about.vehicle, order.seed, number, order.kind, order.seconds).drawn()
    return Drawing(about, order.seed, number, order.row, order.kind, order.seconds).drawn()


def _make_one(order: Order, number: int, folder: Path) -> tuple[int, dict[str, Any]]:
    """Draw, fly and record one case; return its answer."""
    about, case = known(), draw_case(order, number)
    place = folder / folder_of(number)
    place.mkdir(parents=True)
    vehicle = find('vehicle', VEHICLE).read_text(encoding='utf-8')
    (place / 'vehicle.yaml').write_text(vehicle, encoding='utf-8')
    told = {'challenge': str(order.seed), 'case': str(number), 'row': order.row}
    for flight in case.flights:
        record(place / flight.name, flight.streams, about.vehicle.rotor_names, told)
    return number, case.answer


def make(
    order: Order, folder: Path, jobs: int = 1, tell: Callable[[int], None] = lambda _: None
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
    row(order.row)
    can_be_made(folder)
    with all_at_once(folder, NAME) as part:
        _make(order, part, jobs, tell)
    return folder / NAME


def _make(order: Order, part: Path, jobs: int, tell: Callable[[int], None]) -> None:
    """Make all of a challenge, in whatever order the cases are done."""
    answers: dict[str, Any] = {}
    cases = [(order, number, part) for number in range(order.count)]
    for number, answer in done_by(_make_one, cases, jobs, '--jobs'):
        answers[str(number)] = answer
        tell(len(answers))
    digest = seal(answers, part / SEALED)
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
        'commit': commit(),
    }
    keep_json(about, part / NAME)


def about_of(folder: Path) -> dict[str, Any]:
    """Return what a challenge says of itself; `BadInput` where there is none."""
    try:
        found: dict[str, Any] = json.loads((folder / NAME).read_text(encoding='utf-8'))
        int(found['cases'])
    except (OSError, ValueError, TypeError, KeyError):
        raise BadInput(
            f"'{folder}' holds no challenge; make one with: lta challenge make --out {folder}"
        ) from None
    return found
