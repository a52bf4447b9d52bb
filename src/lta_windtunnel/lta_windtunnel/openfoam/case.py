# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Define cases, and solve them on disk by OpenFOAM, each in a folder named by its content's hash.

A marker file records each finished step, so that an interrupted run resumes there. Of OpenFOAM's
environment only `WM_PROJECT_DIR` is set, because the bashrc of the Debian package calls programs
that it does not ship.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
import fcntl
from functools import cache
from hashlib import sha256
import os
from pathlib import Path
import re
import shutil
import subprocess
import time
from typing import Final, final

from lta_config.errors import BadInput
from lta_config.machine import find_cache_folder

PROJECT_VARIABLE: Final = 'WM_PROJECT_DIR'
DEBIAN_FOLDER: Final = '/usr/share/openfoam'
OPENFOAM_PROGRAMS: Final = (
    'blockMesh', 'snappyHexMesh', 'topoSet', 'checkMesh', 'simpleFoam', 'pimpleFoam',
)  # fmt: skip
TIME_LINE: Final = re.compile(r'^Time = [-+.\deE]+s?$')
RESIDUAL: Final = re.compile(r'Solving for p, Initial residual = ([-+.\deE]+|nan|-nan)')
EXECUTION: Final = re.compile(r'ExecutionTime = ([\d.]+) s')
FATAL: Final = 'FOAM FATAL'
LOG_TAIL: Final = 40  # lines of a log that are searched for the reason
FORMAT: Final = 'lta-1'  # cache format; cases of another format are solved again
DONE_PREFIX: Final = 'done.'
FAILURE: Final = 'failure'  # file with the reason why a case failed
SHORT_STEP: Final = 20  # iterations that a step without any counts as in estimates of the time
UNKNOWN_CELLS: Final = 50_000  # cells of a mesh of unknown size in estimates of the time
Progress = Callable[['FoamCase', 'ProgramStep', float, float], None]  # share of step, residual


@final
class CaseFailed(Exception):
    """
    A case that failed; the text gives reason and remedy. Other cases continue.

    `diverged`: whether the same numbers would fail again, unlike a full disk or Ctrl-C.
    """

    def __init__(self, reason: str, diverged: bool = False) -> None:
        super().__init__(reason)
        self.diverged = diverged


def has_openfoam() -> bool:
    """Return whether all OpenFOAM programs are installed."""
    return all(shutil.which(name) for name in OPENFOAM_PROGRAMS)


def require_openfoam() -> None:
    """Raise `BadInput` if OpenFOAM is not installed."""
    if not has_openfoam():
        raise BadInput(
            'OpenFOAM is not installed; install it with "sudo apt-get install '
            '--no-install-recommends openfoam" (450 MB), or use --fidelity analytic, which does '
            'not need it.'
        )


def program_environment() -> Mapping[str, str]:
    """Return the environment of the programs, each limited to one core."""
    place = os.environ.get(PROJECT_VARIABLE) or DEBIAN_FOLDER
    # FOAM_SIGFPE aborts on NaN and overflow instead of iterating on
    return {**os.environ, PROJECT_VARIABLE: place, 'OMP_NUM_THREADS': '1', 'FOAM_SIGFPE': 'true'}


@cache
def find_openfoam_version() -> str:
    """Return the installed OpenFOAM version."""
    output = subprocess.run(
        ['simpleFoam', '-help'], env=program_environment(),
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    match = re.search(r'(?:OpenFOAM|Using:?)[^\n]*?(\d{4})', output.stdout + output.stderr)
    return f'OpenFOAM {match[1]}' if match else 'OpenFOAM'


def explain_failure(program: str, code: int, tail: Sequence[str]) -> CaseFailed:
    """
    Return why a program failed.

    `code` is its exit status, negative for a signal; `tail` holds the log lines from a fatal error
    on, and the last ones.
    """
    text = '\n'.join(tail)
    if 'No space left' in text:
        return CaseFailed(
            f'{program} failed because the disk is full; free disk space or choose another '
            'folder with --cache, then start again.'
        )
    # 8 is SIGFPE, 9 SIGKILL, which the kernel sends when memory runs out; a shell adds 128
    if code in (-8, 136) or any('sigFpe::' in line for line in tail):
        return CaseFailed(
            f'{program} diverged (floating point error); check that the shape is valid.',
            diverged=True,
        )
    if 'bad_alloc' in text or code in (-9, 137):
        return CaseFailed(
            f'{program} was killed or ran out of memory; use --workers 1 or a coarser '
            'fidelity, and start again to resume.'
        )
    if code < 0 and FATAL not in text:
        return CaseFailed(f'{program} was killed by signal {-code}; start again to resume.')
    fatal = text.partition(FATAL)[2].splitlines()[1:] or list(tail[-1:])
    reason = next((line.strip() for line in fatal if line.strip()), 'it says no reason')
    return CaseFailed(f'{program} failed with exit status {code}: {reason[:200]}')


@final
@dataclass(frozen=True, slots=True)
class ProgramStep:
    """One program run in the folder of a case."""

    name: str  # unique within the case
    command: Sequence[str]
    # Files to write before the run, by path; they replace existing ones
    files: Mapping[str, str] = field(default_factory=dict)
    rounds: int = 0  # approximate number of iterations or time steps; 0 if it reports none
    begin: str = '0'  # name of the time folder that it starts from


@final
@dataclass(frozen=True, slots=True)
class FoamCase:
    """A mesh, or a flow on a mesh."""

    name: str  # label for users
    files: Mapping[str, str | bytes]  # content by path
    steps: Sequence[ProgramStep]
    mesh: 'FoamCase | None' = None  # case of the mesh that the flow is solved on
    cells: int = 0  # expected number of cells
    bodies: Sequence[str] = ()  # patches that a mesh must have

    @property
    def key(self) -> str:
        """Hash of everything that determines the result, including the mesh."""
        # Step files are hashed too: they change the result as much as the case's files.
        digest = sha256(FORMAT.encode())
        digest.update(self.mesh.key.encode() if self.mesh else b'')
        for path, content in sorted(self.files.items()):
            digest.update(path.encode() + _encode(content))
        for step in self.steps:
            digest.update(repr((step.name, tuple(step.command), step.begin)).encode())
            digest.update(repr(sorted(step.files.items())).encode())
        # 80 bits: collisions are out of the question, and paths stay short
        return digest.hexdigest()[:20]

    @property
    def work(self) -> float:
        """Cells times iterations, for the time estimate."""
        rounds = sum(max(step.rounds, SHORT_STEP) for step in self.steps)
        return rounds * float(self.cells or UNKNOWN_CELLS)


@final
class CaseRunner:
    """
    Solve cases in a folder.

    `folder`: cache of all cases. `tell`: called with the progress of each case. `retry_failed`:
    whether to repeat cases that diverged in an earlier run.
    """

    def __init__(self, folder: Path, tell: Progress, retry_failed: bool = False) -> None:
        self._folder, self._tell, self._retry_failed = folder, tell, retry_failed
        self._running: set[subprocess.Popen[str]] = set()
        self._stopped = False

    def stop(self) -> None:
        """Stop the running programs and start no more."""
        self._stopped = True
        # A copy, because other threads remove finished processes
        for process in list(self._running):
            process.terminate()

    def case_folder(self, case: FoamCase) -> Path:
        """Return the folder of a case."""
        return self._folder / case.key

    def is_done(self, case: FoamCase) -> bool:
        """Return whether a case has been solved."""
        return all(self._find_marker(case, step).is_file() for step in case.steps)

    def _find_marker(self, case: FoamCase, step: ProgramStep) -> Path:
        return self.case_folder(case) / f'{DONE_PREFIX}{step.name}'

    def solve(self, case: FoamCase) -> Path:
        """
        Run the missing steps of a case whose mesh is solved, and return its folder.

        Raises
        ------
        CaseFailed
            If a program fails or the disk is full, or failed in an earlier run.

        """
        try:
            with self._lock_case(case):
                return self._solve_unless_failed(case)
        except OSError as error:
            raise CaseFailed(
                f'Cannot use the case folder {self.case_folder(case)} '
                f'({error.strerror or error}); free disk space or choose another folder '
                'with --cache, then start again to resume.'
            ) from error

    @contextmanager
    def _lock_case(self, case: FoamCase) -> Iterator[None]:
        """Lock a case against other runs, also on other machines that share the folder."""
        self._folder.mkdir(parents=True, exist_ok=True)
        with (self._folder / f'.{case.key}.lock').open('w') as lock:
            # Released when the file is closed, even after a crash.
            fcntl.flock(lock, fcntl.LOCK_EX)
            yield

    def _solve_unless_failed(self, case: FoamCase) -> Path:
        place = self.case_folder(case)
        failure = place / FAILURE
        if self._retry_failed:
            failure.unlink(missing_ok=True)
        if failure.is_file():
            raise CaseFailed(failure.read_text(encoding='utf-8'))
        if case.mesh is None and place.exists() and not self.is_done(case):
            shutil.rmtree(place)  # a mesh is changed in place: restart a half-finished one
        # A resumed case keeps its files, which a step may have replaced
        _write(place, {p: c for p, c in case.files.items() if not (place / p).exists()})
        _write(place, {'name': f'{case.name}\n'})
        # Flows share the mesh by a link, because it is the largest part of a case
        link = place / 'constant' / 'polyMesh'
        if case.mesh is not None and not link.is_symlink():
            link.parent.mkdir(parents=True, exist_ok=True)
            link.symlink_to(self.case_folder(case.mesh) / 'constant' / 'polyMesh')
        try:
            for step in case.steps:
                if not self._find_marker(case, step).is_file():
                    self._run_step(case, step, place)
        except CaseFailed as error:
            if error.diverged:
                words = f'{error} It failed in an earlier run; --retry-failed repeats it.'
                failure.write_text(words, encoding='utf-8')
            raise
        return place

    def _run_step(self, case: FoamCase, step: ProgramStep, place: Path) -> None:
        """Run the program of a step and wait for it, telling the residual of the pressure."""
        if self._stopped:
            raise CaseFailed('The computation was stopped; start it again to resume.')
        _write(place, step.files)
        for old in (place / 'postProcessing').glob(f'*/{step.begin}'):
            shutil.rmtree(old)  # output of a stopped step
        begun, rounds, residual = time.monotonic(), 0, float('nan')
        log = place / f'log.{step.name}'
        with log.open('w', encoding='utf-8') as out:
            process = subprocess.Popen(
                list(step.command), cwd=place, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                # Popen does not update PWD, which OpenFOAM may use as the working directory
                env={**program_environment(), 'PWD': str(place)},
                # Own session: Ctrl-C reaches Python only, which stops the programs
                text=True, errors='replace', start_new_session=True,
            )  # fmt: skip
            self._running.add(process)
            with process:  # leaves no pipe open and waits, whatever happens
                assert process.stdout is not None
                for line in process.stdout:
                    out.write(line)
                    if (match := RESIDUAL.search(line)) is not None:
                        residual = float(match[1])
                    elif TIME_LINE.match(line.strip()):
                        # Counts iterations, not time: time steps of a transient vary
                        rounds += 1
                        share = min(rounds / max(step.rounds, 1), 1.0)
                        self._tell(case, step, share, residual)
            self._running.discard(process)
        if process.returncode != 0:
            if self._stopped:
                raise CaseFailed('The computation was stopped; start it again to resume.')
            lines = log.read_text(encoding='utf-8').splitlines()
            # The first fatal error is the cause; the end of the log shows signals
            fatal = next((k for k, line in enumerate(lines) if FATAL in line), len(lines))
            tail = lines[fatal : fatal + LOG_TAIL] + lines[-LOG_TAIL:]
            raise explain_failure(step.command[0], process.returncode, tail)
        _write(place, {f'{DONE_PREFIX}{step.name}': f'{time.monotonic() - begun:.1f}\n'})
        self._tell(case, step, 1.0, float('nan'))

    def processor_time(self, case: FoamCase) -> float:
        """Return the processor time of a solved case, as reported by its programs [s]."""
        return sum(self._read_seconds(case, step) for step in case.steps)

    def _read_seconds(self, case: FoamCase, step: ProgramStep) -> float:
        log = self.case_folder(case) / f'log.{step.name}'
        if times := EXECUTION.findall(log.read_text(encoding='utf-8', errors='replace')):
            return float(times[-1])
        # The program does not print its time: use the wall time in the marker file
        return float(self._find_marker(case, step).read_text(encoding='utf-8'))


def _encode(content: str | bytes) -> bytes:
    return content if isinstance(content, bytes) else content.encode()


def _write(place: Path, files: Mapping[str, str | bytes]) -> None:
    for path, content in files.items():
        (place / path).parent.mkdir(parents=True, exist_ok=True)
        (place / path).write_bytes(_encode(content))


def cache_folder() -> Path:
    """Return the default folder of solved cases."""
    return find_cache_folder('cfd')
