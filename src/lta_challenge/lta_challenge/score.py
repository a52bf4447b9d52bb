"""Score a challenge: put its cases to discovery, open the answers, count."""

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
import json
from pathlib import Path
from typing import Any, Final, final

from lta_bridge.provenance import commit
from lta_challenge.digest import registry_digest, vehicle_digest
from lta_challenge.judged import Judged, judged
from lta_challenge.make import about_of, folder_of
from lta_challenge.sealed import digest_of, opened
from lta_challenge.sealed import NAME as SEALED
from lta_challenge.tally import by_strength, Counted, figures, ladder, matrix, middle
from lta_challenge.trial import put
from lta_config.errors import BadInput
from lta_report.children import done_by
from lta_report.results_folder import keep_json

RESULTS: Final = 'results'
NAME: Final = 'score.json'


@final
@dataclass(frozen=True, slots=True)
class Scored:
    """
    A challenge that has been scored.

    Attributes
    ----------
    about : dict
        Of the challenge, with what scored it; its commit is that or those that studied the cases.
    cases : tuple of Judged
        In the order of their numbers.

    """

    about: dict[str, Any]
    cases: tuple[Judged, ...]


def stamp() -> dict[str, str]:
    """Return what a result depends on beside its case."""
    return {'registry': registry_digest(), 'vehicle_digest': vehicle_digest('gtmab')}


def _kept(path: Path, now: dict[str, str]) -> dict[str, Any] | None:
    """Return a whole result of the present effects and vehicle; None where there is none."""
    try:
        found: dict[str, Any] = json.loads(path.read_text(encoding='utf-8'))
    except (OSError, ValueError):
        return None
    whole = 'oracle' in found or found.get('refused')
    return found if whole and found.get('stamp') == now else None


def _put_one(folder: Path, number: int, now: dict[str, str]) -> int:
    """Put one case to discovery and keep its result."""
    answer = opened(folder / SEALED)[str(number)]
    place = folder / RESULTS / f'{number:04d}.json'
    found = put(folder / folder_of(number), answer, place)
    keep_json({**found, 'stamp': now, 'commit': commit()}, place)
    return number


def _whole(folder: Path, todo: Sequence[int], about: dict[str, Any]) -> None:
    """Refuse a challenge of which a case to study is gone, or whose answers are others."""
    if digest_of(folder / SEALED) != about['answers_sha256']:
        raise BadInput(
            f"'{folder / SEALED}' was changed after it was sealed; make the challenge again."
        )
    for place in (folder / folder_of(number) for number in todo):
        if not place.is_dir():
            raise BadInput(f"'{place}' is gone; make the challenge again.")


def score(
    folder: Path,
    jobs: int = 1,
    most: int | None = None,
    tell: Callable[[int, int], None] = lambda _done, _all: None,
) -> Scored:
    """
    Score a challenge; go on where an earlier run ended.

    Parameters
    ----------
    folder : Path
        Of the challenge.
    jobs : int
        Processes.
    most : int, optional
        Cases to look at, the first of it; all by default.
    tell : callable
        Told how many cases are done, and how many there are.

    Raises
    ------
    BadInput
        If there is no challenge, a case of it is gone, or its answers were changed.

    """
    about, now = about_of(folder), stamp()
    count = min(int(about['cases']), most or int(about['cases']))
    results = folder / RESULTS
    todo = [n for n in range(count) if _kept(results / f'{n:04d}.json', now) is None]
    _whole(folder, todo, about)
    results.mkdir(exist_ok=True)
    done = count - len(todo)
    tell(done, count)
    asked = [(folder, number, now) for number in todo]
    for _ in done_by(_put_one, asked, jobs, '--jobs', goes_on=True):
        done += 1
        tell(done, count)
    answers = opened(folder / SEALED)
    cases, commits = list[Judged](), dict[str, None]()
    for number in range(count):
        found = _kept(results / f'{number:04d}.json', now)
        assert found is not None
        cases.append(judged(number, answers[str(number)], found))
        commits[found['commit']] = None
    return Scored({**about, **now, 'scored': count, 'commit': ', '.join(commits)}, tuple(cases))


def told(scored: Scored) -> dict[str, Any]:
    """Return a score as plain data."""
    cases = scored.cases
    intervals = [each for one in cases for each in one.intervals]
    return {
        'about': scored.about,
        'figures': [
            {'name': f.name, **plain(f.share), 'least': none(f.least), 'most': none(f.most),
             'met': f.met} for f in figures(cases)
        ],
        'by_strength': [
            {'from': low, 'to': none(high), 'exact': plain(a), 'wrong': plain(b),
             'silent': plain(c)} for low, high, a, b, c in by_strength(cases)
        ],
        'matrix': matrix(cases),
        'position_error_3s_m': {name: none(value) for name, value in ladder(cases).items()},
        'parameter_error': none(middle(each.error for each in intervals)),
        'seconds': none(middle(one.seconds for one in cases)),
        'cases': [
            asdict(one) | {'outcome': one.outcome, 'late': one.late} for one in cases
        ],
    }  # fmt: skip


def plain(share: Counted) -> dict[str, float | None]:
    """Return a share as JSON has it."""
    return {name: none(value) for name, value in share._asdict().items()}


def none(value: float) -> float | None:
    """Return a number as JSON has it: None for what is none."""
    return value if value == value and abs(value) != float('inf') else None


def keep(scored: Scored, folder: Path) -> str:
    """Write score.json and return its text."""
    return keep_json(told(scored), folder / NAME)
