"""
Change the code in many small ways, and count which changes the tests detect.

Of each area's physics and safety code a seeded sample of mutants (`mutants.py`) is tried, one
small change each, in a copy of the tree (`mutation_trial.py`), on the tests that import the
changed module and those that `AREAS` names. A failing test kills a mutant; so does one that never
ends. `--again` tries the survivors once more, after a test was added.
"""

from argparse import Namespace
import atexit
from collections import Counter
from collections.abc import Iterator, Sequence
from functools import cache
import importlib.util
import os
from pathlib import Path
from queue import SimpleQueue
from random import Random
import shutil
import sys
import tempfile
from typing import Final, NamedTuple

from lta_flight.sweep.statistics import wilson_interval

from campaigns import ROOT
from campaigns.harness import Campaign, Case, Row, Rows
from campaigns.mutants import changed, MISSING, mutant, Place, Spot, spots
from campaigns.mutation_equal import EQUAL
from campaigns.mutation_trial import Copy, INCOMPETENT, KILLED, STOPPED, SURVIVED, Trial

sys.path.append(str(ROOT / 'tools'))

from nearest_tests import Imports, module_of, nearest, read_imports

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
         'lta_sim/lta_sim/supply.py'),
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
         'teensy/[bfhr]*.py', 'one_way_clock.py',
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


class AreaTrials:
    """
    The mutants of an area, and what the tests say of them.

    Parameters
    ----------
    name : str
        Of `AREAS`.
    count, seed : int
        Size and seed of the sample.

    """

    def __init__(self, name: str, count: int, seed: int) -> None:
        self.area, imports = AREAS[name], read_imports(ROOT)
        self.mutants = sample(self.area, count, seed)
        paths = {one.path for one in self.mutants}
        self.tests = {path: tests_of(path, self.area, imports, ROOT) for path in paths}
        every = list(dict.fromkeys(test for tests in self.tests.values() for test in tests))
        copy = COPIES.get()
        first = module_of(ROOT / self.mutants[0].path, ROOT)
        whole = copy.outcome(Trial(first, every, 3600, self.area.compiled))
        COPIES.put(copy)
        if whole.fate != SURVIVED:
            sys.exit(f'{name}: the tests fail without any mutant: {whole.why}')
        self.limit = int(3.0 * whole.took) + SPARE

    def run(self, number: int) -> Row:
        """Return the row of a mutant."""
        one, copy = self.mutants[number], COPIES.get()
        module = module_of(ROOT / one.path, ROOT)
        trial = Trial(module, self.tests[one.path], self.limit, self.area.compiled)
        try:
            outcome = copy.tried(one.path, one.text, trial)
        finally:
            COPIES.put(copy)
        row = {**outcome._asdict(), **one._replace(text='')._asdict(), 'path': str(one.path)}
        row['reason'] = EQUAL.get((row['path'], one.before, one.after), '')
        if outcome.fate == SURVIVED and not row['reason']:
            place = f'{row["path"].split("/", 2)[-1]}:{one.line}'
            row['wrong'] = f'{place}: `{one.before}` became `{one.after}`'
        return row


COPIES: SimpleQueue[Copy] = SimpleQueue()
open_trials = cache(AreaTrials)


def prepare(options: Namespace) -> None:
    """Copy the tree once for each worker, and run the tests of each area without a mutant."""
    if importlib.util.find_spec('cosmic_ray') is None:
        sys.exit(MISSING)
    folder = tempfile.mkdtemp(prefix='lta-mutation-')
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    base = os.environ.get('XDG_CACHE_HOME') or Path.home() / '.cache'
    for k in range(options.side):
        COPIES.put(Copy(ROOT, Path(folder) / str(k), Path(base) / 'lta' / 'kernels'))
    for name in options.kinds or AREAS:
        open_trials(name, options.first + options.each, options.seed)


def run(case: Case, options: Namespace) -> Row:
    """Return the row of a mutant."""
    trials = open_trials(case.kind, options.first + options.each, options.seed)
    return trials.run(case.number)


def list_table(rows: Rows, options: Namespace) -> Iterator[str]:
    """Yield the shares by area, and the survivors that behave as the original does."""
    yield (
        '| area | mutants | killed | of them never ended | survived | equivalent | did not import '
        '| killed of those that count |\n|---|---|---|---|---|---|---|---|'
    )
    for name in AREAS:
        some = [row for case, row in rows.items() if case.kind == name and 'fate' in row]
        if some:
            yield format_area(name, some)
    equal = [row for row in rows.values() if row.get('fate') == SURVIVED and row['reason']]
    yield ''
    yield from (f'- {row["path"]}:{row["line"]} is equivalent. {row["reason"]}' for row in equal)


def format_area(name: str, rows: Sequence[Row]) -> str:
    """Return an area's line of the table."""
    fates = Counter(row['fate'] for row in rows)
    equal = sum(row['fate'] == SURVIVED and bool(row['reason']) for row in rows)
    killed = fates[KILLED] + fates[STOPPED]
    share = wilson_interval(killed, killed + fates[SURVIVED] - equal)
    words = f'{100 * share.value:.0f} % ({100 * share.low:.0f} to {100 * share.high:.0f})'
    cells = (name, len(rows), killed, fates[STOPPED], fates[SURVIVED] - equal, equal,
             fates[INCOMPETENT], words)  # fmt: skip
    return f'| {" | ".join(map(str, cells))} |'


CAMPAIGN: Final = Campaign(
    lambda options: list(AREAS), run, list_table, each=40, page='testing_mutation.md', side=0,
    prepare=prepare,
)  # fmt: skip
