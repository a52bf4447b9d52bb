"""
Measure what each threshold of discovery does: `make sensitivity`, hours on two cores.

Each constant of docs/discovery_thresholds.md is doubled and halved, one at a time in a copy of the
package, and the same cases are studied with it. What came out differently, case by case, goes to
docs/discovery_sensitivity.json, whence `make reference` takes it. A variant that was measured is
not measured again while the package stays the same: `make sensitivity` goes on where it was.

ARGS='--cases 12 --only selection.acceptance --jobs 2': how many cases, of which thresholds, how
many at once. What moves nothing does not decide in these cases; it may in others.
"""

import argparse
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
import hashlib
import json
import os
from pathlib import Path
import shutil
import subprocess
import sys
from tempfile import TemporaryDirectory

from lta_challenge.answer_key import NAME as SEALED
from lta_challenge.answer_key import read_answers
from lta_challenge.case_score import score_case, ScoredCase
from lta_challenge.make import case_folder, ChallengeRequest, generate_challenge
from lta_challenge.trial import study_case
from lta_cli.reference.thresholds import DECLARED, KEPT, list_thresholds, Threshold
from lta_config.machine import count_cores
from rich.progress import track

ROOT = Path(__file__).resolve().parents[2]
SOURCE = ROOT / 'src/lta_discovery/lta_discovery'
RUNS = ROOT / 'runs/sensitivity'
FACTORS = ('2', '0.5')
SEED, SECONDS = 91, (60.0, 60.0)
LATER = {'transfer', 'conclusion'}  # asked of real flights only, or when all has been decided


def describe_outcome(one: ScoredCase) -> str:
    """Return in a few words how a case came out."""
    words = [one.outcome, *one.named, 'unexplained' if one.flagged else '']
    return ' '.join(filter(None, words))


def study_cases(challenge: Path, numbers: range) -> dict[str, str]:
    """Return how cases come out, by number."""
    answers = read_answers(challenge / SEALED)
    out = {}
    for number in numbers:
        found, _ = study_case(challenge / case_folder(number))
        out[str(number)] = describe_outcome(score_case(number, answers[str(number)], found))
    return out


def scale_value(value: str, factor: str) -> str:
    """Return a number of the source, doubled or halved; whole numbers stay whole and above 0."""
    if value.isdigit():
        return str(max(1, round(float(factor) * int(value))))
    return f'{factor} * {value}'


def write_constant(source: Path, one: Threshold, factor: str) -> None:
    """Write one constant of a copy of the package."""
    path = source / f'{one.module.replace(".", "/")}.py'
    lines = path.read_text(encoding='utf-8').splitlines()
    for k, line in enumerate(lines):
        found = DECLARED.match(line)
        if found is not None and found['name'] == one.name:
            lines[k] = f'{one.name} = {scale_value(one.value, factor)}'
    path.write_text('\n'.join(lines) + '\n', encoding='utf-8')


def study_variant(
    challenge: Path, count: int, one: Threshold | None, factor: str
) -> dict[str, str]:
    """Study the cases with a constant changed, in a process of its own; None changes nothing."""
    with TemporaryDirectory() as folder:
        copy = Path(folder) / 'lta_discovery'
        shutil.copytree(SOURCE, copy, ignore=shutil.ignore_patterns('__pycache__'))
        if one is not None:
            write_constant(copy, one, factor)
        paths = [folder, os.environ.get('PYTHONPATH', '')]
        done = subprocess.run(
            [sys.executable, __file__, '--child', str(challenge), '--cases', str(count)],
            env={**os.environ, 'PYTHONPATH': os.pathsep.join(paths)},
            capture_output=True, text=True, check=False,
        )  # fmt: skip
    if done.returncode:
        return {'all': f'refused: {done.stderr.strip().splitlines()[-1]}'}
    found: dict[str, str] = json.loads(done.stdout.splitlines()[-1])
    return found


def load_result(path: Path, stamp: str) -> dict[str, str] | None:
    """Return what was measured before, of the same package and cases."""
    if not path.exists():
        return None
    found = json.loads(path.read_text(encoding='utf-8'))
    return found['came_out'] if found['stamp'] == stamp else None


def describe_change(before: dict[str, str], after: dict[str, str]) -> str:
    """Return what changed, in words: 'silent: 1 more, exact: 1 fewer', or 'nothing'."""
    if set(after) != set(before):
        return '; '.join(after.values())
    first, second = (Counter(one.split()[0] for one in each.values()) for each in (before, after))
    more = {name: second[name] - first[name] for name in sorted({*first, *second})}
    words = [
        f'{name}: {abs(by)} {"more" if by > 0 else "fewer"}' for name, by in more.items() if by
    ]
    other = sum(before[k] != after[k] for k in before)
    return ', '.join(words) or (f'{other} told differently' if other else 'nothing')


def main() -> None:
    """Measure all that was asked for."""
    asked = argparse.ArgumentParser(description=__doc__)
    asked.add_argument('--cases', type=int, default=12)
    asked.add_argument('--only', default='', help='the beginning of what is measured')
    asked.add_argument('--jobs', type=int, default=count_cores())
    asked.add_argument('--child', type=Path, help=argparse.SUPPRESS)
    given = asked.parse_args()
    if given.child:
        sys.stdout.write(json.dumps(study_cases(given.child, range(given.cases))) + '\n')
        return
    challenge = RUNS / f'cases_{given.cases}'
    if not challenge.exists():
        generate_challenge(
            ChallengeRequest(SEED, given.cases, seconds=SECONDS), challenge, given.jobs
        )
    texts = sorted(SOURCE.rglob('*.py'))
    whole = b''.join(path.read_bytes() for path in texts) + (challenge / SEALED).read_bytes()
    stamp = hashlib.sha256(whole).hexdigest()[:16]
    every = [one for one in list_thresholds() if one.module.partition('.')[0] not in LATER]
    todo = [(one, f) for one in every if one.key.startswith(given.only) for f in FACTORS]

    def measure(one: Threshold | None, factor: str) -> dict[str, str]:
        path = RUNS / (f'{one.key}_{factor}.json' if one else 'unchanged.json')
        found = load_result(path, stamp)
        if found is None:
            found = study_variant(challenge, given.cases, one, factor)
            text = json.dumps({'stamp': stamp, 'came_out': found}, indent=1)
            path.write_text(text, encoding='utf-8')
        return found

    before = measure(None, '1')
    with ThreadPoolExecutor(given.jobs) as pool:
        work = pool.map(lambda each: measure(*each), todo)
        done = list(track(work, 'measuring', total=len(todo)))
    page = ROOT / 'docs' / KEPT
    page_content = json.loads(page.read_text(encoding='utf-8')) if page.exists() else {}
    for (one, factor), after in zip(todo, done, strict=True):
        page_content.setdefault(one.key, {})[factor] = describe_change(before, after)
    page.write_text(json.dumps(page_content, indent=1, sort_keys=True) + '\n', encoding='utf-8')
    said = f'{len(todo)} variants of {len(every)} thresholds, {given.cases} cases each: {page}'
    sys.stdout.write(f'{said}\n')


if __name__ == '__main__':
    main()
