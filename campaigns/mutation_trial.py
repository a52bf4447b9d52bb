"""
One mutant: whether the tests see it, in a process of its own and in a copy of the tree.

The process is forked from one that has imported the libraries, which would otherwise take longer
than most tests do. What it may compute is limited, not how long it may take: other work on the
machine kills no mutant.
"""

from collections.abc import Sequence
from contextlib import suppress
import importlib
import multiprocessing
import os
from pathlib import Path
import re
import resource
import shutil
import signal
import sys
import time
import traceback
from typing import Any, Final, NamedTuple

TREE: Final = ('config', 'src', 'test')
LIBRARIES: Final = (
    'numpy',
    'numba',
    'scipy.optimize',
    'scipy.signal',
    'pydantic',
    'yaml',
    'pytest',
)
HUNG: Final = 1800.0  # s after which a mutant hangs that computes nothing
UNFIT: Final = 77  # the exit status of one that cannot be imported
CRASHES: Final = (signal.SIGABRT, signal.SIGBUS, signal.SIGFPE, signal.SIGILL, signal.SIGSEGV)
KILLED, SURVIVED, STOPPED, INCOMPETENT = 'killed', 'survived', 'stopped', 'incompetent'


class Trial(NamedTuple):
    """What is to be tried."""

    module: str  # the changed module, which must import
    # Files of tests from the root of the tree, those first that are likely to fail
    tests: Sequence[str]
    limit: int  # processor time [s]
    compiled: bool  # whether numba compiles; without, kernels run as Python


class Outcome(NamedTuple):
    """What became of it: one of the four words, why, and the processor time [s] if it ended."""

    fate: str
    why: str
    took: float


class Copy:
    """A copy of what a mutant may change; the rest of the tree is links."""

    def __init__(self, root: Path, folder: Path, cache: Path | None = None) -> None:
        self.folder = folder
        self._stamp = 1_000_000_000  # s: no two texts of a module share one, as caches look at it
        folder.mkdir(parents=True)
        for path in root.iterdir():
            if path.name in TREE:
                left = shutil.ignore_patterns('__pycache__')
                shutil.copytree(path, folder / path.name, ignore=left)
            elif path.name not in ('.git', 'runs'):
                (folder / path.name).symlink_to(path)
        if cache and cache.is_dir():
            shutil.copytree(cache, folder / 'cache' / 'lta' / cache.name)

    def tried(self, path: Path, text: str, trial: Trial) -> Outcome:
        """Return what the tests say of another text in a file, which is put back."""
        file = self.folder / path
        kept, times = file.read_bytes(), file.stat()
        self._stamp += 1
        try:
            file.write_text(text, encoding='utf-8')
            os.utime(file, (self._stamp, self._stamp))
            return self.outcome(trial)
        finally:
            file.write_bytes(kept)
            os.utime(file, ns=(times.st_atime_ns, times.st_mtime_ns))

    def outcome(self, trial: Trial) -> Outcome:
        """Return what the tests say of the copy as it stands."""
        forks: Any = multiprocessing.get_context('forkserver')
        forks.set_forkserver_preload(list(LIBRARIES))
        told = self.folder / 'told.txt'
        told.write_text('')
        process = forks.Process(target=tell, args=(self.folder, trial, told))
        process.start()
        process.join(HUNG)
        hung = process.is_alive()
        with suppress(ProcessLookupError):  # and what it started
            os.killpg(process.pid, signal.SIGKILL)
        process.join()
        if hung:
            return Outcome(STOPPED, f'it hung for {HUNG:.0f} s', HUNG)
        text, status = told.read_text(encoding='utf-8', errors='replace'), process.exitcode
        if status == -signal.SIGXCPU:
            return Outcome(STOPPED, f'it computed for {trial.limit} s', float(trial.limit))
        if -status in CRASHES:  # for instance compiled code that writes beyond its arrays
            return Outcome(KILLED, f'it crashed: {signal.Signals(-status).name}', 0.0)
        if status == UNFIT:
            return Outcome(INCOMPETENT, last_line(text), 0.0)
        ended = re.findall(r'^took (\S+)$', text, re.MULTILINE)
        if not ended or status not in (0, 1, 2, 3):
            raise RuntimeError(f'The tests did not run (status {status}):\n{text[-1500:]}')
        if status == 0:
            return Outcome(SURVIVED, '', float(ended[-1]))
        failed = re.findall(r'^(?:FAILED|ERROR) (\S+)', text, re.MULTILINE)
        return Outcome(KILLED, failed[0] if failed else last_line(text), float(ended[-1]))


def last_line(text: str) -> str:
    """Return the last line that says something."""
    return ([line for line in text.splitlines() if line.strip()] or [''])[-1]


def tell(folder: Path, trial: Trial, told: Path) -> None:
    """Run the tests in this process; its exit status and a file tell what came of it."""
    os.setsid()
    resource.setrlimit(resource.RLIMIT_CPU, (trial.limit, trial.limit + 60))
    output = os.open(told, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
    os.dup2(output, 1)
    os.dup2(output, 2)
    os.chdir(folder)
    paths = [str(path.parent) for path in sorted(folder.glob('src/*/setup.py'))]
    paths.append(str(folder / 'config'))
    sys.path[:0] = paths
    os.environ['PYTHONPATH'] = ':'.join([*paths, os.environ.get('PYTHONPATH', '')])
    os.environ['XDG_CACHE_HOME'] = str(folder / 'cache')
    import numba
    import pytest

    numba.config.DISABLE_JIT = not trial.compiled
    try:
        importlib.import_module(trial.module)
    except Exception:
        traceback.print_exc()
        sys.stderr.flush()
        os._exit(UNFIT)
    options = ['-x', '-q', '-p', 'no:cacheprovider', '-m', 'not long']
    status = pytest.main([*options, *trial.tests])
    sys.stdout.write(f'took {time.process_time():.1f}\n')
    sys.stdout.flush()
    os._exit(int(status))
