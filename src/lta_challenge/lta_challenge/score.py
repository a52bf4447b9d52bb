"""Score a challenge: run discovery on its cases and compare with the answers."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from functools import partial
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
from lta_report.line_log import LogKind
from lta_report.study import Study, StudyOptions
from lta_report.study_store import StoreFormat
from pydantic import TypeAdapter
from rich.console import Console

RESULTS: Final = 'results'  # folder of the store
STORE: Final = StoreFormat(
    LogKind('cases.jsonl', 'challenge', 'challenge', 'lta challenge make --out'),
    TypeAdapter(dict[str, Any]),
    shares_folder=True,
)


@final
@dataclass(frozen=True, slots=True)
class ChallengeScore:
    """The score of a challenge."""

    about: dict[str, Any]  # description of the challenge and the versions that analysed its cases
    cases: tuple[ScoredCase, ...]  # cases in the order of their numbers


def collect_versions() -> dict[str, str]:
    """Return the versions that a stored result depends on."""
    return {'registry': compute_registry_digest(), 'vehicle_digest': vehicle_digest('gtmab')}


def _run_case(folder: Path, number: int) -> dict[str, Any]:
    """Run discovery on one case."""
    result = run_trial(
        folder / case_folder(number), lambda: read_answers(folder / SEALED)[str(number)]
    )
    return {**result, 'commit': read_commit()}


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
    folder: Path, options: StudyOptions, console: Console, most: int | None = None
) -> ChallengeScore:
    """
    Score a challenge; resume an interrupted run.

    `folder`: folder of the challenge. `options`: number of workers, and whether to repeat failed
    cases. `most`: score only the first cases; all by default. Raise `BadInput` if there is no
    challenge, a case is missing or failed, or the answers were changed.
    """
    about, now = read_challenge(folder), collect_versions()
    count = min(int(about['cases']), most or int(about['cases']))

    def find_key(number: int) -> str:
        # Results of other effects or another vehicle file are computed again
        return ' '.join((f'{number:04d}', *now.values()))

    study = Study(partial(_run_case, folder), find_key, STORE, 'cases')
    outcome = study.run(
        range(count), folder / RESULTS, about['answers_sha256'], options, console,
        lambda todo: _check_complete(folder, todo, about),
    )  # fmt: skip
    answers = read_answers(folder / SEALED)
    results = outcome.require_all()
    cases = [score_case(n, answers[str(n)], result) for n, result in enumerate(results)]
    # A dictionary keeps the order of the commits and removes duplicates
    commits = dict.fromkeys(result['commit'] for result in results)
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
