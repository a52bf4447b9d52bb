"""
What discovery concludes of 20 short cases of the challenge, number by number.

The flights are made once and kept in runs/same; only the study runs again.
"""

from pathlib import Path
import shutil

from commands import list_numbers, ROOT
from lta_challenge.make import case_folder, ChallengeRequest, generate_challenge
from lta_challenge.trial import study_case

FOLDER = ROOT / 'runs/same'
SEED, SECONDS = 17, (30.0, 40.0)
CASES = {'base': 8, 'worse': 2, 'structured': 2, 'pose': 2, 'hover': 2, 'wrench': 2, 'other': 2}
# Not compared: times, and what comes after all decisions
TIMES = {'wall_s', 'cpu_s', 'law'}


def make_cases(jobs: int) -> list[Path]:
    """Return the folders of the cases; make those that are not there."""
    for row, count in CASES.items():
        folder = FOLDER / f'{row}-{SEED}'
        if not folder.is_dir():
            generate_challenge(ChallengeRequest(SEED, count, row, None, SECONDS), folder, jobs)
    return [
        FOLDER / f'{row}-{SEED}' / case_folder(k) for row, n in CASES.items() for k in range(n)
    ]


def study(folder: Path) -> dict[str, str]:
    """Return what discovery finds in one case: its verdict, its names and its numbers."""
    found, _ = study_case(folder)
    name = f'{folder.parent.name} {folder.name}'
    found = {key: value for key, value in found.items() if key not in TIMES}
    named = [knob for one in found['effects'] for knob in one['knobs']]
    rows = {f'{name} / verdict': ' '.join([found['verdict'], *named])}
    return rows | {f'{name} / {path}': value for path, value in list_numbers(found)}


def forget_cases() -> None:
    """Remove the flights, so that they are made anew."""
    shutil.rmtree(FOLDER, ignore_errors=True)
