# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Change the code in many small ways, and count which changes the tests detect.

Of each area's physics and safety code a seeded sample of mutants is tried, one small change each,
in a copy of the tree, on the tests that import the changed module and those that `AREAS` names. A
failing test kills a mutant; so does one that never ends. `--again` tries the survivors once more,
after a test was added.
"""

from argparse import Namespace
import ast
import atexit
from collections import Counter
from collections.abc import Iterator, Sequence
from functools import cache
from itertools import accumulate
import os
from pathlib import Path
from queue import SimpleQueue
from random import Random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from typing import Any, Final, NamedTuple

from lta_flight.sweep.statistics import wilson_interval

from campaigns import ROOT
from campaigns.harness import Campaign, Case, Row, Rows

sys.path.append(str(ROOT / 'tools'))

from nearest_tests import Imports, nearest, read_imports

COPIED: Final = ('config', 'firmware', 'src', 'test')
SPARE: Final = 30  # s of processor time that a mutant has beyond three times that of all tests
KILLED, SURVIVED, ENDLESS = 'killed', 'survived', 'never ended'
# The neighbour and the opposite of each comparison
COMPARED: Final[dict[type, tuple[type, ...]]] = {
    ast.Eq: (ast.NotEq,), ast.NotEq: (ast.Eq,), ast.Is: (ast.IsNot,), ast.IsNot: (ast.Is,),
    ast.Lt: (ast.LtE, ast.GtE), ast.LtE: (ast.Lt, ast.Gt),
    ast.Gt: (ast.GtE, ast.LtE), ast.GtE: (ast.Gt, ast.Lt),
}  # fmt: skip
# Not `%` or `//` for `*`: a float raises TypeError there, and any test that runs the line fails
COMPUTED: Final[dict[type, tuple[type, ...]]] = {
    ast.Add: (ast.Sub, ast.Mult), ast.Sub: (ast.Add, ast.Mult), ast.Mult: (ast.Div, ast.Add),
    ast.Div: (ast.Mult, ast.Sub), ast.Pow: (ast.Mult, ast.Div), ast.FloorDiv: (ast.Mult,),
    ast.Mod: (ast.FloorDiv,), ast.LShift: (ast.RShift,), ast.RShift: (ast.LShift,),
    ast.BitAnd: (ast.BitOr,), ast.BitXor: (ast.BitAnd,),
}  # fmt: skip
LARGE: Final = 100  # a number from which on one more or less is within a tolerance
# What declares texts and limits, which the generated pages repeat; guards against mistakes in code
DECLARED: Final = ('setting', 'EffectParameter', 'Field', 'TypeVar')
GUARDS: Final = ('frozen', 'slots', 'strict')


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
         'lta_model/lta_model/mass_properties.py', 'lta_sim/lta_sim/supply.py'),
        'test/unit/sim',
        ('test/unit/sim/test_effects.py', 'test/unit/sim/test_kernel_oracle.py',
         'test/unit/sim/test_measurement_effects.py'),
        left_out=('flights', 'platforms', 'world', 'counted', 'shipped', 'sphere', 'surface',
                  'lambertian', 'extract', 'derivatives', 'physics'),
    ),
    'vlc': Area(
        'src',
        ('lta_vlc/lta_vlc/[bdlrs]*.py', 'lta_vlc/lta_vlc/spectral/[!_]*.py',
         'lta_model/lta_model/light/lamp.py'),
        'test/unit/vlc',
        ('test/unit/vlc/test_diodes.py',),
        compiled=True,
    ),
    'control': Area(
        'src/lta_control/lta_control',
        ('[!_]*.py', 'laws/*.py', 'strategies/*.py'),
        'test/unit/control',
        ('test/property/test_laws.py', 'test/property/test_control.py'),
    ),
    'energy': Area(
        'src',
        ('lta_energy/lta_energy/[chims]*.py', 'lta_energy/lta_energy/monitoring/[!_]*.py',
         'lta_model/lta_model/electrical/[!_]*.py'),
        'test/unit/energy',
    ),
    'discovery': Area(
        'src/lta_discovery/lta_discovery',
        ('state_filter/[klmnp]*.py', 'state_filter/smoothing.py', 'posterior/[efl]*.py',
         'flights/[nortsu]*.py', 'model/[pqr]*.py', 'replay/[rs]*.py'),
        'test/unit/discovery',
        compiled=True,
        left_out=('study', 'calibration', 'first_step', 'planning', 'hidden', 'trial'),
    ),
    'bridge': Area(
        'src/lta_bridge/lta_bridge',
        ('crazyflie/co*.py', 'crazyflie/[dhoprs]*.py', 'crazyflie/log_table.py',
         'teensy/[bfhr]*.py', 'one_way_clock.py', 'intake.py'),
        'test/unit/bridge',
        ('test/property/test_crazyflie_safety.py',),
    ),
}  # fmt: skip


class Mutant(NamedTuple):
    """A mutant: the file from the root, its changed text, and the first line that changed."""

    path: Path
    line: int
    text: str
    before: str
    after: str


def list_nodes(node: ast.AST) -> Iterator[ast.AST]:
    """Yield a node and all below it, but for places where no behaviour is decided."""
    match node:
        case ast.Raise() | ast.JoinedStr():
            return
        case ast.Call(func=ast.Name(id=name)) if name in DECLARED:
            return
        case ast.keyword(arg=word) if word in GUARDS:
            return
    yield node
    for field, value in ast.iter_fields(node):
        if field not in ('annotation', 'returns', 'decorator_list'):
            for child in value if isinstance(value, list) else [value]:
                if isinstance(child, ast.AST):
                    yield from list_nodes(child)


def list_changes(node: Any) -> Iterator[tuple[Any, str]]:
    """Yield what of a node can be replaced, and the new text."""
    match node:
        case ast.Compare(left=left, ops=[op], comparators=right):
            for new in COMPARED.get(type(op), ()):
                yield node, ast.unparse(ast.Compare(left, [new()], right))
        case ast.BinOp(left=left, op=op, right=right):
            for new in COMPUTED.get(type(op), ()):
                yield node, ast.unparse(ast.BinOp(left, new(), right))
        case ast.BoolOp(op=op, values=values):
            other = ast.Or() if isinstance(op, ast.And) else ast.And()
            yield node, ast.unparse(ast.BoolOp(other, values))
        case ast.UnaryOp(op=ast.USub() | ast.Not(), operand=operand):
            yield node, ast.unparse(operand)
        case ast.Constant(value=bool() as value):
            yield node, str(not value)
        case ast.Constant(value=int() | float() as value) if value < LARGE:
            yield node, repr(value + 1)
            yield node, repr(value - 1)
        case ast.If(test=test) | ast.IfExp(test=test) | ast.While(test=test):
            yield test, f'not ({ast.unparse(test)})'
        case ast.For(iter=iterated):
            yield iterated, '()'
        case ast.Break():
            yield node, 'continue'
        case ast.Continue():
            yield node, 'break'


def replace_node(source: str, node: Any, new: str) -> str:
    """Return a text with other words in the place of a node."""
    data = source.encode()
    starts = [0, *accumulate(map(len, data.splitlines(keepends=True)))]
    begin = starts[node.lineno - 1] + node.col_offset
    end = starts[node.end_lineno - 1] + node.end_col_offset
    words = f'({new})' if isinstance(node, ast.expr) else new
    return (data[:begin] + words.encode() + data[end:]).decode()


def list_sources(area: Area, root: Path = ROOT) -> list[Path]:
    """Return the files of an area that are changed."""
    found = {path for pattern in area.modules for path in (root / area.package).glob(pattern)}
    return sorted(path for path in found if path.name not in ('__init__.py', 'messages.py'))


def draw_mutants(area: Area, count: int, seed: int, root: Path = ROOT) -> list[Mutant]:
    """
    Return so many mutants, chosen by the seed alone; a larger sample begins with a smaller.

    First a place is drawn, then what becomes of it.
    """
    chance, drawn = Random(seed), list[Mutant]()
    texts = {path: path.read_text(encoding='utf-8') for path in list_sources(area, root)}
    places = [
        (path, changes)
        for path, text in texts.items()
        for node in list_nodes(ast.parse(text))
        if (changes := list(list_changes(node)))
    ]
    for path, changes in chance.sample(places, len(places))[:count]:
        node, new = chance.choice(changes)
        text = replace_node(texts[path], node, new)
        before, after = (
            each.splitlines()[node.lineno - 1].strip() for each in (texts[path], text)
        )
        drawn.append(Mutant(path.relative_to(root), node.lineno, text, before, after))
    return drawn


def select_tests(path: Path, area: Area, imports: Imports, root: Path) -> list[str]:
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


class Copy:
    """A copy of what a mutant may change; the rest of the tree is links."""

    def __init__(self, root: Path, folder: Path, kernels: Path | None = None) -> None:
        self.folder = folder
        self._stamp = 1_000_000_000  # s: no two texts of a module share one, as caches look at it
        folder.mkdir(parents=True)
        for path in root.iterdir():
            if path.name in COPIED:
                left = shutil.ignore_patterns('__pycache__')
                shutil.copytree(path, folder / path.name, ignore=left)
            elif path.name not in ('.git', 'runs'):
                (folder / path.name).symlink_to(path)
        if kernels and kernels.is_dir():
            shutil.copytree(kernels, folder / 'cache' / 'lta' / kernels.name)

    def run_tests(self, tests: Sequence[str], limit: int, compiled: bool) -> tuple[str, str]:
        """Return what becomes of the copy as it stands, and which test failed."""
        paths = [*(path.parent for path in self.folder.glob('src/*/setup.py')),
                 self.folder / 'config', os.environ.get('PYTHONPATH', '')]  # fmt: skip
        variables = {'PYTHONPATH': ':'.join(map(str, paths)),
                     'XDG_CACHE_HOME': str(self.folder / 'cache'),
                     'NUMBA_DISABLE_JIT': str(int(not compiled))}  # fmt: skip
        # What it may compute is limited, not how long it may take: other work kills no mutant
        done = subprocess.run(
            ['prlimit', f'--cpu={limit}', sys.executable, '-P', '-m', 'pytest', '-x', '-q',
             '-p', 'no:cacheprovider', '-m', 'not long', *tests],
            cwd=self.folder, env=os.environ | variables, capture_output=True, text=True,
            check=False,
        )  # fmt: skip
        failed = re.findall(r'^(?:FAILED|ERROR) (\S+)', done.stdout, re.MULTILINE)
        if done.returncode in (-signal.SIGXCPU, -signal.SIGKILL):
            return ENDLESS, ''
        return (KILLED, failed[0] if failed else '') if done.returncode else (SURVIVED, '')

    def try_text(
        self, path: Path, text: str, tests: Sequence[str], limit: int, compiled: bool
    ) -> tuple[str, str]:
        """Return what the tests say of another text in a file, which is put back."""
        file = self.folder / path
        before, times = file.read_bytes(), file.stat()
        self._stamp += 1
        try:
            file.write_text(text, encoding='utf-8')
            os.utime(file, (self._stamp, self._stamp))
            return self.run_tests(tests, limit, compiled)
        finally:
            file.write_bytes(before)
            os.utime(file, ns=(times.st_atime_ns, times.st_mtime_ns))


COPIES: SimpleQueue[Copy] = SimpleQueue()
read_tree = cache(lambda: read_imports(ROOT))


@cache
def draw_area(name: str, count: int, seed: int) -> tuple[list[Mutant], dict[Path, list[str]], int]:
    """Return the mutants of an area, the tests of each file, and the processor time of all [s]."""
    area, copy = AREAS[name], COPIES.get()
    mutants = draw_mutants(area, count, seed)
    tests = {one.path: select_tests(one.path, area, read_tree(), ROOT) for one in mutants}
    every, began = (
        list(dict.fromkeys(test for some in tests.values() for test in some)),
        time.time(),
    )
    fate, failed = copy.run_tests(every, 3600, area.compiled)
    COPIES.put(copy)
    if fate != SURVIVED:
        sys.exit(f'{name}: the tests fail without any mutant: {failed}')
    return mutants, tests, int(3.0 * (time.time() - began)) + SPARE


def prepare(options: Namespace) -> None:
    """Copy the tree once for each worker, and run the tests of each area without a mutant."""
    folder = tempfile.mkdtemp(prefix='lta-mutation-')
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    base = os.environ.get('XDG_CACHE_HOME') or Path.home() / '.cache'
    for k in range(options.side):
        COPIES.put(Copy(ROOT, Path(folder) / str(k), Path(base) / 'lta' / 'kernels'))
    for name in options.kinds or AREAS:
        draw_area(name, options.first + options.each, options.seed)


def run(case: Case, options: Namespace) -> Row:
    """Return the row of a mutant."""
    mutants, tests, limit = draw_area(case.kind, options.first + options.each, options.seed)
    one, copy = mutants[case.number], COPIES.get()
    try:
        fate, failed = copy.try_text(
            one.path, one.text, tests[one.path], limit, AREAS[case.kind].compiled
        )
    finally:
        COPIES.put(copy)
    place = f'{str(one.path).split("/", 2)[-1]}:{one.line}'
    wrong = f'{place}: `{one.before}` became `{one.after}`' if fate == SURVIVED else ''
    return {'fate': fate, 'failed': failed, 'wrong': wrong}


def list_table(rows: Rows, options: Namespace) -> Iterator[str]:
    """Yield the shares by area."""
    yield '| area | mutants | killed | of them never ended | survived | killed, 95 % |'
    yield '|---|---|---|---|---|---|'
    for name in AREAS:
        some = [row for case, row in rows.items() if case.kind == name and 'fate' in row]
        if some:
            fates = Counter(row['fate'] for row in some)
            killed = fates[KILLED] + fates[ENDLESS]
            share = wilson_interval(killed, len(some))
            words = f'{100 * share.value:.0f} % ({100 * share.low:.0f} to {100 * share.high:.0f})'
            cells = (name, len(some), killed, fates[ENDLESS], fates[SURVIVED], words)
            yield f'| {" | ".join(map(str, cells))} |'


CAMPAIGN: Final = Campaign(
    lambda options: list(AREAS), run, list_table, each=40, page='testing_mutation.md', side=0,
    prepare=prepare,
)  # fmt: skip
