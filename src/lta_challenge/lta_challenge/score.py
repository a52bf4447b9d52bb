"""Score a challenge: run discovery on its cases and compare with the answers."""

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
import json
from pathlib import Path
from typing import Any, Final, final

from lta_bridge.provenance import read_commit
from lta_challenge.answer_key import NAME as SEALED
from lta_challenge.answer_key import read_answers, read_digest
from lta_challenge.case_score import score_case, ScoredCase
from lta_challenge.digest import compute_registry_digest, vehicle_digest
from lta_challenge.make import case_folder, read_challenge
from lta_challenge.score_statistics import (
    compute_score_figures,
    count_outcomes,
    finite_median,
    median_errors,
    ShareEstimate,
    shares_by_strength,
)
from lta_challenge.trial import run_trial
from lta_config.errors import BadInput
from lta_report.results_folder import write_json
from lta_report.worker_pool import run_in_workers

RESULTS: Final = 'results'


@final
@dataclass(frozen=True, slots=True)
class ChallengeScore:
    """
    The score of a challenge.

    Attributes
    ----------
    about : dict
        Description of the challenge and the versions that analysed its cases.
    cases : tuple of ScoredCase
        Cases in the order of their numbers.

    """

    about: dict[str, Any]
    cases: tuple[ScoredCase, ...]


def collect_versions() -> dict[str, str]:
    """Return the versions that a stored result depends on."""
    return {'registry': compute_registry_digest(), 'vehicle_digest': vehicle_digest('gtmab')}


def _load_result(path: Path, now: dict[str, str]) -> dict[str, Any] | None:
    """Return a complete, up-to-date stored result; None if there is none."""
    try:
        found: dict[str, Any] = json.loads(path.read_text(encoding='utf-8'))
    except (OSError, ValueError):
        return None
    # A result without its oracle was interrupted
    whole = 'oracle' in found or found.get('refused')
    return found if whole and found.get('stamp') == now else None


def _run_case(folder: Path, number: int, now: dict[str, str]) -> int:
    """Run discovery on one case and store the result."""
    answer = read_answers(folder / SEALED)[str(number)]
    place = folder / RESULTS / f'{number:04d}.json'
    # `run_trial` writes the finding before it uses the answer
    found = run_trial(folder / case_folder(number), answer, place)
    write_json({**found, 'stamp': now, 'commit': read_commit()}, place)
    return number


def _check_complete(folder: Path, todo: Sequence[int], about: dict[str, Any]) -> None:
    """Raise `BadInput` if a case is missing or the answers were changed."""
    # The digest in challenge.json was written when the challenge was made
    if read_digest(folder / SEALED) != about['answers_sha256']:
        raise BadInput(
            f"The answer key '{folder / SEALED}' was changed after it was created; "
            'create the challenge again with "lta challenge make".'
        )
    for place in (folder / case_folder(number) for number in todo):
        if not place.is_dir():
            raise BadInput(
                f"The case folder '{place}' is missing; create the challenge again with "
                '"lta challenge make".'
            )


def score_challenge(
    folder: Path,
    jobs: int = 1,
    most: int | None = None,
    tell: Callable[[int, int], None] = lambda _done, _all: None,
) -> ChallengeScore:
    """
    Score a challenge; resume an interrupted run.

    Parameters
    ----------
    folder : Path
        Folder of the challenge.
    jobs : int
        Number of processes.
    most : int, optional
        Score only the first cases; all by default.
    tell : callable
        Called with the numbers of finished and of all cases.

    Raises
    ------
    BadInput
        If there is no challenge, a case is missing, or the answers were changed.

    """
    about, now = read_challenge(folder), collect_versions()
    count = min(int(about['cases']), most or int(about['cases']))
    results = folder / RESULTS
    # Results of other effects or another vehicle file are computed again
    todo = [n for n in range(count) if _load_result(results / f'{n:04d}.json', now) is None]
    _check_complete(folder, todo, about)
    results.mkdir(exist_ok=True)
    done = count - len(todo)
    tell(done, count)
    asked = [(folder, number, now) for number in todo]
    for _ in run_in_workers(_run_case, asked, jobs, '--jobs', goes_on=True):
        done += 1
        tell(done, count)
    answers = read_answers(folder / SEALED)
    cases, commits = list[ScoredCase](), dict[str, None]()
    for number in range(count):
        found = _load_result(results / f'{number:04d}.json', now)
        assert found is not None
        cases.append(score_case(number, answers[str(number)], found))
        # A dictionary keeps the order of the commits and removes duplicates
        commits[found['commit']] = None
    return ChallengeScore(
        {**about, **now, 'scored': count, 'commit': ', '.join(commits)}, tuple(cases)
    )


def score_to_dict(scored: ChallengeScore) -> dict[str, Any]:
    """Return a score as JSON data."""
    cases = scored.cases
    intervals = [each for one in cases for each in one.intervals]
    return {
        'about': scored.about,
        'figures': [
            {'name': f.name, **share_to_dict(f.share), 'least': null_unless_finite(f.least),
             'most': null_unless_finite(f.most), 'met': f.target_met}
            for f in compute_score_figures(cases)
        ],
        'by_strength': [
            {'from': low, 'to': null_unless_finite(high), 'exact': share_to_dict(a),
             'wrong': share_to_dict(b), 'silent': share_to_dict(c)}
            for low, high, a, b, c in shares_by_strength(cases)
        ],
        'matrix': count_outcomes(cases),
        'position_error_3s_m': {
            name: null_unless_finite(value) for name, value in median_errors(cases).items()
        },
        'parameter_error': null_unless_finite(finite_median(each.error for each in intervals)),
        'seconds': null_unless_finite(finite_median(one.seconds for one in cases)),
        'cases': [
            asdict(one) | {'outcome': one.outcome, 'late': one.late} for one in cases
        ],
    }  # fmt: skip


def share_to_dict(share: ShareEstimate) -> dict[str, float | None]:
    """Return a share as JSON data."""
    return {name: null_unless_finite(value) for name, value in share._asdict().items()}


def null_unless_finite(value: float) -> float | None:
    """Return a number, or None if it is not finite."""
    # Only NaN differs from itself
    return value if value == value and abs(value) != float('inf') else None
