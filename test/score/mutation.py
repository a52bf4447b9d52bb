"""
Mutation scores: `make mutation ARGS='--each 60 --areas control bridge --seed 1'`.

A test suite is only worth what it catches. Of each area's physics and safety code a seeded sample
of mutants (`mutants.py`) is tried, one small change each, in a copy of the tree
(`mutation_trial.py`), on the tests that import the changed module and those that `AREAS` names.
A failing test kills a mutant; so does one that never ends. What was stopped goes on where it was
while the sample stays the same; `--again` tries the survivors once more, after a test was added.
Writes docs/testing_mutation.md when every area was asked for.
"""

import argparse
from collections import Counter
from collections.abc import Sequence
import importlib.util
import json
import math
import os
from pathlib import Path
from queue import SimpleQueue
from random import Random
import sys
import tempfile
from typing import Final, NamedTuple

from campaign import campaign, Case, kept, Row
from campaign import version as hashed
from mutants import changed, MISSING, mutant, Place, Spot, spots
from mutation_equal import EQUAL
from mutation_trial import Copy, INCOMPETENT, KILLED, STOPPED, SURVIVED, Trial

HERE: Final = Path(__file__).resolve().parent
ROOT: Final = HERE.parents[1]
sys.path.append(str(ROOT / 'tools'))

from nearest_tests import Imports, module_of, nearest, read_imports  # noqa: E402

PAGE: Final = ROOT / 'docs/testing_mutation.md'
EACH: Final = 40
SPARE: Final = 30  # s of processor time that a mutant has beyond three times that of all tests


class Area(NamedTuple):
    """What is changed, and what ought to see it."""

    package: str  # folder of the modules, which may be in several packages
    modules: tuple[str, ...]  # patterns within it
    folder: str  # where the tests are that count when they import the module
    tests: tuple[str, ...] = ()  # tests that see a module without naming it
    # Whether numba compiles the kernels; as Python they do not wait for the compiler
    compiled: bool = False
    # Parts of the names of tests that take too long: they fly, draw or discover a whole flight
    left_out: tuple[str, ...] = ()


AREAS: Final = {
    'effects': Area(
        'src',
        ('lta_model/lta_model/effects/[!_]*.py', 'lta_model/lta_model/rigid_body.py',
         'lta_model/lta_model/mass_properties.py',
         'lta_model/lta_model/rotor_forces.py',
         'lta_sim/lta_sim/supply_step.py'),
        'test/unit/sim',
        ('test/unit/sim/test_effects.py', 'test/unit/sim/test_kernel_oracle.py',
         'test/unit/sim/test_measurement_effects.py', 'test/unit/sim/test_lift_effects.py'),
        left_out=('flights', 'platforms', 'world', 'counted', 'shipped', 'sphere', 'surface',
                  'lambertian', 'extract', 'derivatives', 'physics'),
    ),
    'vlc': Area(
        'src',
        ('lta_vlc/lta_vlc/bearing.py', 'lta_vlc/lta_vlc/d*.py', 'lta_vlc/lta_vlc/lamp.py',
         'lta_vlc/lta_vlc/receiver.py', 'lta_vlc/lta_vlc/settings.py',
         'lta_vlc/lta_vlc/spectral/[!_]*.py',
         'lta_model/lta_model/light/lamp.py'),
        'test/unit/vlc',
        ('test/unit/vlc/test_lamp.py',),
        compiled=True,
    ),
    'control': Area(
        'src/lta_control/lta_control',
        ('[!g]*.py', 'laws/*.py', 'strategies/*.py'),
        'test/unit/control',
        ('test/property/test_laws.py', 'test/property/test_control.py'),
    ),
    'energy': Area(
        'src',
        ('lta_energy/lta_energy/[chi]*.py', 'lta_energy/lta_energy/mission.py',
         'lta_energy/lta_energy/schedule.py', 'lta_energy/lta_energy/monitoring/[!_]*.py',
         'lta_model/lta_model/electrical/[!_]*.py'),
        'test/unit/energy',
    ),
    'discovery': Area(
        'src/lta_discovery/lta_discovery',
        ('discrepancies/*.py', 'fit/evidence.py', 'fit/[dfir]*.py', 'flights/noise.py',
         'flights/[osz]*.py', 'flights/ro*.py', 'flights/ti*.py', 'forecast/forecast_warnings.py',
         'forecast/levenberg_marquardt.py', 'model/quaternions.py', 'replay/[lsv]*.py',
         'selection/[iv]*.py', 'unmodeled/re*.py', 'unmodeled/sp*.py'),
        'test/unit/discovery',
        compiled=True,
        left_out=('page', 'study', 'carr', 'route', 'json', 'wrench', 'naming', 'displacing',
                  'planning', 'foresight', 'rivals'),
    ),
    'bridge': Area(
        'src/lta_bridge/lta_bridge',
        ('crazyflie/co*.py', 'crazyflie/[dhoprs]*.py', 'crazyflie/log_table.py',
         'teensy/[bfhr]*.py', 'teensy/sender_filter.py', 'one_way_clock.py',
         'intake.py'),
        'test/unit/bridge',
        ('test/property/test_crazyflie_safety.py',),
    ),
}  # fmt: skip


class Drawn(NamedTuple):
    """A mutant of the sample: the file from the root, its changed text, and what changed."""

    path: Path
    line: int
    text: str
    before: str
    after: str


def sources(area: Area, root: Path = ROOT) -> list[Path]:
    """Return the files of an area that are changed."""
    folder = root / area.package
    found = {path for pattern in area.modules for path in folder.glob(pattern)}
    return sorted(path for path in found if path.name not in ('__init__.py', 'messages.py'))


def sample(area: Area, each: int, seed: int, root: Path = ROOT) -> list[Drawn]:
    """
    Return so many mutants, chosen by the seed alone; a larger sample begins with a smaller.

    First a place is drawn, then what becomes of it.
    """
    chance = Random(seed)
    places: dict[tuple[Path, Place], list[Spot]] = {}
    texts = {path: path.read_text(encoding='utf-8') for path in sources(area, root)}
    for path, text in texts.items():
        for spot in spots(text):
            places.setdefault((path, spot.place), []).append(spot)
    found: list[Drawn] = []
    for path, place in chance.sample(list(places), len(places)):
        if len(found) == each:
            break
        text = mutant(texts[path], chance.choice(places[path, place]))
        if text:
            line = changed(texts[path], text)
            found.append(Drawn(path.relative_to(root), place[0][0], text, *line))
    return found


def tests_of(path: Path, area: Area, imports: Imports, root: Path) -> list[str]:
    """Return the files of tests that ought to see a change, the likeliest first."""
    near = [
        test
        for test in nearest(root / path, imports, root)
        if test.is_relative_to(root / area.folder)
        and not any(word in test.stem for word in area.left_out)
    ]
    near.sort(key=lambda test: (path.stem not in test.stem, len(imports[test])))
    names = [str(test.relative_to(root)) for test in near]
    return list(dict.fromkeys([*names, *area.tests])) or [area.folder]


def run(name: str, told: argparse.Namespace, copies: Sequence[Copy]) -> dict[Case, Row]:
    """Return what became of each mutant of an area."""
    area, imports = AREAS[name], read_imports(ROOT)
    version = hashed([*sources(area), HERE / 'mutants.py'])
    path = told.out / f'{name}-{told.seed}-{version}.jsonl'
    if told.again:
        forget(path)
    cases = {Case(name, k): one for k, one in enumerate(sample(area, told.each, told.seed))}
    chosen = {one.path: tests_of(one.path, area, imports, ROOT) for one in cases.values()}
    done = kept(path)
    if all(case in done for case in cases):
        return {case: done[case] for case in cases}
    every = list(dict.fromkeys(test for tests in chosen.values() for test in tests))
    first = module_of(next(ROOT / path for path in chosen), ROOT)
    whole = copies[0].outcome(Trial(first, every, 3600, area.compiled))
    if whole.fate != SURVIVED:
        sys.exit(f'{name}: the tests fail without any mutant: {whole.why}')
    limit = int(3.0 * whole.took) + SPARE
    sys.stderr.write(f'{name}: {len(every)} files of tests take {whole.took:.0f} s unchanged\n')
    free: SimpleQueue[Copy] = SimpleQueue()
    for copy in copies:
        free.put(copy)

    def tried(case: Case) -> Row:
        one, copy = cases[case], free.get()
        module = module_of(ROOT / one.path, ROOT)
        try:
            outcome = copy.tried(
                one.path, one.text, Trial(module, chosen[one.path], limit, area.compiled)
            )
        finally:
            free.put(copy)
        where = one._replace(text='')._asdict() | {'path': str(one.path)}
        return {**outcome._asdict(), **where}

    return campaign(list(cases), path, len(copies), tried)


def forget(path: Path) -> None:
    """Take the survivors out of what was tried."""
    left = {case: row for case, row in kept(path).items() if row['fate'] != SURVIVED}
    if path.exists():
        lines = (json.dumps({'case': case, **row}) + '\n' for case, row in left.items())
        path.write_text(''.join(lines), encoding='utf-8')


def wilson(hits: int, of: int) -> tuple[float, float]:
    """Return the 95 % interval of a share (Wilson 1927)."""
    if not of:
        return 0.0, 1.0
    z, share = 1.96, hits / of
    middle = share + z * z / (2 * of)
    half = z * math.sqrt(share * (1.0 - share) / of + z * z / (4 * of * of))
    return (middle - half) / (1 + z * z / of), (middle + half) / (1 + z * z / of)


def reason(row: Row) -> str:
    """Return why no test can see a mutant; empty where one could."""
    return EQUAL.get((row['path'], row['before'], row['after']), '')


def table_row(name: str, rows: Sequence[Row]) -> str:
    """Return an area's line of the table."""
    fates = Counter(row['fate'] for row in rows)
    equal = sum(row['fate'] == SURVIVED and bool(reason(row)) for row in rows)
    killed = fates[KILLED] + fates[STOPPED]
    counted = killed + fates[SURVIVED] - equal
    low, high = wilson(killed, counted)
    share = f'{killed / max(counted, 1):.0%} ({low:.0%} to {high:.0%})'.replace('%', ' %')
    cells = (name, len(rows), killed, fates[STOPPED], fates[SURVIVED] - equal, equal,
             fates[INCOMPETENT], share)  # fmt: skip
    return '| ' + ' | '.join(map(str, cells)) + ' |'


TABLE: Final = (
    '| area | mutants | killed | of them never ended | survived | equivalent | did not import | '
    'killed of those that count |\n|---|---|---|---|---|---|---|---|'
)


def told_of(row: Row) -> str:
    """Return a survivor in one line."""
    place = f'{row["path"].split("/", 2)[-1]}:{row["line"]}'
    return f'{place}: `{row["before"]}` became `{row["after"]}`'


def page(found: dict[str, list[Row]], each: int, seed: int) -> str:
    """Return the page: the table, and every survivor."""
    alive = [row for rows in found.values() for row in rows if row['fate'] == SURVIVED]
    open_ones = [f'- {told_of(row)}' for row in alive if not reason(row)]
    equal = [f'- {told_of(row)}. {reason(row)}' for row in alive if reason(row)]
    parts = [
        '# What the tests catch',
        'A mutant is the code with one small change: another sign, a neighbouring comparison, a '
        'number that is one larger or smaller, a loop that never runs. A mutant is killed if a '
        'test fails on it.\n'
        f"`make mutation ARGS='--each {each} --seed {seed}'` repeats the table. It draws a random "
        'sample of mutants of the physics and safety code and runs on each the tests that should '
        'fail.\ncosmic-ray makes the mutants; `test/score/mutants.py` lists the operators and '
        'places that are left out, and why.',
        'The interval is the 95 % Wilson interval of a share. Once survivors have got tests, only '
        'a new seed gives an unbiased share.',
        '\n'.join([TABLE, *(table_row(name, rows) for name, rows in found.items())]),
    ]
    if open_ones:
        parts += ['## Survivors', 'No test fails on these.', '\n'.join(open_ones)]
    if equal:
        parts += [
            '## Equivalent',
            'These behave as the original does, and do not count.',
            '\n'.join(equal),
        ]
    return '\n\n'.join(parts) + '\n'


def asked() -> argparse.Namespace:
    """Return what the command line asks for."""
    parser = argparse.ArgumentParser(description='Mutation scores.')
    parser.add_argument('--each', type=int, default=EACH, help='mutants of each area')
    parser.add_argument('--areas', nargs='*', default=list(AREAS), choices=list(AREAS))
    parser.add_argument('--seed', type=int, default=0)
    parser.add_argument('--side', type=int, default=os.cpu_count() or 1, help='side by side')
    parser.add_argument('--again', action='store_true', help='try the survivors once more')
    parser.add_argument('--out', type=Path, default=Path('runs') / 'mutation')
    told = parser.parse_args()
    told.out.mkdir(parents=True, exist_ok=True)
    return told


def main() -> int:
    """Print the table and the survivors, and write the page."""
    told = asked()
    if importlib.util.find_spec('cosmic_ray') is None:
        sys.stderr.write(f'{MISSING}\n')
        return 2
    base = os.environ.get('XDG_CACHE_HOME') or Path.home() / '.cache'
    found: dict[str, list[Row]] = {}
    with tempfile.TemporaryDirectory(prefix='lta-mutation-') as folder:
        copies = [
            Copy(ROOT, Path(folder) / str(k), Path(base) / 'lta' / 'kernels')
            for k in range(told.side)
        ]
        for name in told.areas:
            found[name] = list(run(name, told, copies).values())
            sys.stdout.write(f'{table_row(name, found[name])}\n')
            sys.stdout.flush()
    if set(told.areas) == set(AREAS):
        PAGE.write_text(page(found, told.each, told.seed), encoding='utf-8')
    sys.stdout.write(page(found, told.each, told.seed))
    return 0


if __name__ == '__main__':
    sys.exit(main())
