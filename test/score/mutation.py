"""
Break the code in many small ways and see whether the tests notice: `make mutation`.

cosmic-ray makes the mutants: another operator, number, comparison or condition within a function.
Each is put into a copy of the project, never into the checkout, and the area's tests run there
until one fails. What no test fails on has survived, and is printed as a line of code before and
after. Outcomes are kept in `runs/mutation`: what was killed is not tried again while its module is
the same, what survived is.

Left out is what would raise the score for nothing: operators on bits in place of those on numbers,
which no float survives, and decorators. So is what stands outside functions: declarations, which
contract tests hold against the pages.
"""

import argparse
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
import difflib
import json
import math
import os
from pathlib import Path
from random import Random
import shutil
import subprocess
import sys
import tempfile
from typing import Final, NamedTuple

from campaign import version as version_of

ROOT: Final = Path(__file__).resolve().parents[2]
OUT: Final = ROOT / 'runs' / 'mutation'
LEFT_OUT: Final = ('RemoveDecorator', 'Bit', 'Shift')
PATIENCE: Final = 300.0  # s for the tests of one mutant; an endless loop is noticed as well
KILLED, TIMED_OUT, SURVIVED = 'killed', 'timed out', 'survived'
MISSING: Final = (
    'cosmic-ray is not installed; run .venv/bin/pip install -r requirements-mutation.txt first.'
)


class Area(NamedTuple):
    """Modules of one kind, and the tests that ought to notice a change in them."""

    modules: tuple[str, ...]  # patterns below src
    tests: tuple[str, ...]  # below test, the quickest first
    compiled: bool = True  # or as plain Python, where a mutant would compile the whole model anew


AREAS: Final = {
    'effects': Area(
        ('lta_sim/lta_sim/effects/*.py', 'lta_sim/lta_sim/mass.py',
         'lta_sim/lta_sim/rotor_sum.py'),
        ('unit/sim/test_effects.py', 'unit/sim/test_mass.py',
         'unit/sim/test_[!w]*_effects.py', 'unit/sim/test_wind_effects.py',
         'unit/sim/test_kernel_oracle.py', 'unit/sim/test_rotor_*.py',
         'unit/sim/test_battery_compensation.py', 'unit/sim/test_turbulence.py'),
        compiled=False,
    ),
    'vlc': Area(
        tuple(f'lta_vlc/lta_vlc/{name}.py' for name in (
            'tone', 'fit', 'listener', 'demodulation', 'direction', 'array', 'modulation', 'lamp',
            'spectrum', 'separation', 'snr', 'sequence')),
        ('unit/vlc/test_*.py', 'property/test_demodulation.py'),
        compiled=False,
    ),
    'control': Area(
        tuple(f'lta_control/lta_control/{name}.py' for name in (
            'pid', 'cascade', 'allocation', 'altitude', 'attitude', 'airspeed', 'estimator',
            'reserve', 'obedience', 'control', 'onboard')),
        ('unit/control/test_*.py', 'property/test_control.py'),
        compiled=False,
    ),
    'energy': Area(
        tuple(f'lta_energy/lta_energy/{name}.py' for name in (
            'battery', 'belief', 'panel', 'power_path', 'circuit', 'rotor', 'reserve', 'outlook',
            'way_home', 'monitor', 'diode_fit', 'faults/*')),
        ('unit/energy/test_battery.py', 'unit/energy/test_panel.py', 'unit/energy/test_*.py'),
        compiled=False,
    ),
    'discovery': Area(
        ('lta_analysis/lta_analysis/discovery/fit/*.py',
         'lta_analysis/lta_analysis/discovery/naming/*.py',
         'lta_analysis/lta_analysis/discovery/outside/spectral_line.py'),
        ('unit/analysis/discovery/fit', 'unit/analysis/discovery/naming',
         'unit/analysis/discovery/outside'),
    ),
    'bridge': Area(
        (*(f'lta_bridge/lta_bridge/crazyflie/{name}.py' for name in (
            'safety', 'keeper', 'duties_packet', 'packet_check', 'readings', 'override',
            'supervisor', 'clock', 'condition')), 'lta_bridge/lta_bridge/fault_watch.py'),
        ('unit/bridge/crazyflie/test_crazyflie_cores.py', 'unit/bridge/crazyflie/test_bridge.py',
         'unit/bridge/crazyflie/test_override.py', 'unit/bridge/crazyflie/test_crazyflie_link.py',
         'unit/bridge/crazyflie/test_hostile_packets.py', 'property/test_crazyflie_safety.py',
         'unit/bridge/crazyflie/test_emulated.py'),
    ),
}  # fmt: skip


class Mutant(NamedTuple):
    """One change of one module: which operator of cosmic-ray, and at which of its places."""

    area: str
    module: str  # below the root
    version: str  # of the module's text
    operator: str
    occurrence: int


class Outcome(NamedTuple):
    """What became of a mutant."""

    mutant: Mutant
    became: str
    change: str  # the lines that differ, before and after


def main() -> int:
    """Try the mutants that are not tried yet, and print scores and survivors."""
    chosen = _arguments()
    try:
        import cosmic_ray.mutating  # noqa: F401 - cosmic_ray.plugins needs it first
    except ImportError:
        sys.stderr.write(f'{MISSING}\n')
        return 2
    OUT.mkdir(parents=True, exist_ok=True)
    mutants = [one for name in chosen.areas for one in sample(name, chosen.each, chosen.seed)]
    log = OUT / 'outcomes.jsonl'
    known = read(log)
    killed = {one for one, outcome in known.items() if outcome.became != SURVIVED}
    waiting = [one for one in mutants if one not in killed]
    with Copies(chosen.side) as copies, ThreadPoolExecutor(chosen.side) as pool:
        for name in sorted({one.area for one in waiting}):
            copies.check(name)
        for k, outcome in enumerate(pool.map(copies.outcome, waiting)):
            known[outcome.mutant] = outcome
            with log.open('a', encoding='utf-8') as file:
                file.write(json.dumps(outcome) + '\n')
            told = f'{k + 1} of {len(waiting)}: {outcome.mutant.area}, {outcome.became}'
            sys.stdout.write(f'{told}\n')
            sys.stdout.flush()
    sys.stdout.write(report([known[one] for one in mutants]) + '\n')
    return 0


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=(__doc__ or '').strip().splitlines()[0])
    parser.add_argument('--areas', nargs='*', default=list(AREAS), choices=list(AREAS))
    parser.add_argument('--each', type=int, default=40, help='mutants of each area')
    parser.add_argument('--seed', type=int, default=1, help='which mutants are drawn')
    parser.add_argument('--side', type=int, default=os.cpu_count() or 1, help='side by side')
    return parser.parse_args()


def sample(area: str, each: int, seed: int) -> list[Mutant]:
    """Return mutants of an area: first a place is drawn, then one of the operators that fit it."""
    chance = Random(f'{area} {seed}')
    places: dict[tuple[str, object], list[Mutant]] = {}
    for pattern in AREAS[area].modules:
        for path in sorted((ROOT / 'src').glob(pattern)):
            for place, mutant in mutants_of(area, path):
                places.setdefault((mutant.module, place), []).append(mutant)
    drawn = chance.sample(sorted(places, key=str), min(each, len(places)))
    return [chance.choice(places[place]) for place in drawn]


def mutants_of(area: str, path: Path) -> Iterator[tuple[object, Mutant]]:
    """Yield every mutant of a module, with its place in the text."""
    from cosmic_ray.ast import ast_nodes, get_ast_from_path
    from cosmic_ray.ast.ast_query import ASTQuery
    from cosmic_ray.plugins import get_operator, operator_names

    nodes = list(ast_nodes(get_ast_from_path(path)))
    module, version = str(path.relative_to(ROOT)), version_of([path])
    for name in sorted(operator_names()):
        kind = get_operator(name)
        if kind.arguments() or any(word in name for word in LEFT_OUT):
            continue
        spots = ((node, spot) for node in nodes for spot in kind().mutation_positions(node))
        for occurrence, (node, spot) in enumerate(spots):
            if ASTQuery(node).get_definition_name():
                yield spot, Mutant(area, module, version, name, occurrence)


def mutated(mutant: Mutant, text: str) -> str:
    """Return the text of a module with the change of a mutant."""
    from cosmic_ray.mutating import mutate_code
    from cosmic_ray.plugins import get_operator

    found = mutate_code(text, get_operator(mutant.operator)(), mutant.occurrence)
    assert isinstance(found, str), mutant
    return found


class Copies:
    """Copies of the project, one for each that works: `with Copies(2) as copies: ...`."""

    def __init__(self, count: int) -> None:
        self._home = Path(tempfile.mkdtemp(prefix='lta-mutation-'))
        self._free = [self._home / str(k) for k in range(count)]
        for folder in self._free:
            _copy(folder)

    def __enter__(self) -> 'Copies':
        return self

    def __exit__(self, *_: object) -> None:
        shutil.rmtree(self._home, ignore_errors=True)

    def check(self, area: str) -> None:
        """Refuse an area whose tests fail without any mutant."""
        became, said = run(self._free[0], area)
        if became != SURVIVED:
            sys.exit(f'The tests of {area} fail without a mutant; mend them first.\n{said}')

    def outcome(self, mutant: Mutant) -> Outcome:
        """Try one mutant."""
        folder = self._free.pop()
        path = folder / mutant.module
        text = path.read_text(encoding='utf-8')
        changed = mutated(mutant, text)
        path.write_text(changed, encoding='utf-8')
        try:
            return Outcome(mutant, run(folder, mutant.area)[0], difference(text, changed))
        finally:
            path.write_text(text, encoding='utf-8')
            self._free.append(folder)


def _copy(folder: Path) -> None:
    """Copy what git knows of and what is new, and lead to the environment."""
    words = ['git', 'ls-files', '-z', '--cached', '--others', '--exclude-standard']
    names = subprocess.run(words, cwd=ROOT, capture_output=True, check=True).stdout.decode()
    for name in filter(None, names.split('\0')):
        if (ROOT / name).is_file():
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(ROOT / name, folder / name)


def run(folder: Path, area: str) -> tuple[str, str]:
    """Run the tests of an area in a copy; return what became of the mutant, and what was said."""
    tests = [
        str(path.relative_to(folder))
        for pattern in AREAS[area].tests
        for path in sorted((folder / 'test').glob(pattern))
    ]
    packages = [folder / 'config', *(path.parent for path in folder.glob('src/*/package.xml'))]
    environment = os.environ | {
        'PYTHONPATH': os.pathsep.join(map(str, [*packages, os.environ.get('PYTHONPATH', '')])),
        'NUMBA_DISABLE_JIT': str(int(not AREAS[area].compiled)),
        'PYTHONDONTWRITEBYTECODE': '1',
    }
    words = [
        sys.executable,
        *['-m', 'pytest', '-x', '-q', '-p', 'no:cacheprovider', '-m'],
        'not long',
    ]
    try:
        done = subprocess.run(
            [*words, *dict.fromkeys(tests)],
            cwd=folder, env=environment, timeout=PATIENCE,
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False,
        )  # fmt: skip
    except subprocess.TimeoutExpired:
        return TIMED_OUT, ''
    return (SURVIVED if done.returncode == 0 else KILLED), done.stdout


def difference(before: str, after: str) -> str:
    """Return the lines that differ, each with its number before."""
    lines = before.splitlines(), after.splitlines()
    found = []
    for kind, a, b, c, d in difflib.SequenceMatcher(None, *lines).get_opcodes():
        if kind != 'equal':
            old, new = (' '.join(map(str.strip, part)) for part in (lines[0][a:b], lines[1][c:d]))
            found.append(f'{a + 1}: {old}  ->  {new}')
    return '; '.join(found)


def read(log: Path) -> dict[Mutant, Outcome]:
    """Return the outcomes that are kept; of one that was tried twice, the last."""
    if not log.exists():
        return {}
    rows = map(json.loads, log.read_text(encoding='utf-8').splitlines())
    outcomes = (Outcome(Mutant(*mutant), became, change) for mutant, became, change in rows)
    return {outcome.mutant: outcome for outcome in outcomes}


def report(outcomes: Sequence[Outcome]) -> str:
    """Return the scores by area, with 95 % intervals (Wilson), and the survivors."""
    lines = [f'{"area":10} mutants  killed  timed out  survived  score']
    for area in dict.fromkeys(one.mutant.area for one in outcomes):
        count = counter(one.became for one in outcomes if one.mutant.area == area)
        total = sum(map(count, (KILLED, TIMED_OUT, SURVIVED)))
        low, high = wilson(total - count(SURVIVED), total)
        lines.append(
            f'{area:10} {total:7} {count(KILLED):7} {count(TIMED_OUT):10} {count(SURVIVED):9}'
            f'  {1 - count(SURVIVED) / total:.0%} ({low:.0%} to {high:.0%})'
        )
    lines += [f'{one.mutant.module}:{one.change}' for one in outcomes if one.became == SURVIVED]
    return '\n'.join(lines)


def counter(words: Iterable[str]) -> Callable[[str], int]:
    """Return how often each word stands among some."""
    return list(words).count


def wilson(hits: int, total: int, z: float = 1.96) -> tuple[float, float]:
    """Return Wilson's interval of a share (Wilson 1927, doi:10.1080/01621459.1927.10502953)."""
    share = hits / total
    middle = (share + z * z / (2 * total)) / (1 + z * z / total)
    half = math.sqrt(share * (1 - share) / total + z * z / (4 * total * total))
    half *= z / (1 + z * z / total)
    return middle - half, middle + half


if __name__ == '__main__':
    sys.exit(main())
