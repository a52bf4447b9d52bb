"""
Define cases, and solve them on disk, each in a folder named by the hash of its content.

A marker file records each finished step, so that an interrupted run resumes there.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
import fcntl
from hashlib import sha256
from pathlib import Path
import re
import shutil
import time
from typing import Final, final

from lta_config.machine import find_cache_folder
from lta_windtunnel.openfoam.programs import CaseFailed, FoamPrograms

FORMAT: Final = 'lta-1'  # cache format; cases of another format are solved again
DONE_PREFIX: Final = 'done.'
FAILURE: Final = 'failure'  # file with the reason why a case failed
EXECUTION: Final = re.compile(r'ExecutionTime = ([\d.]+) s')
SHORT_STEP: Final = 20  # iterations that a step without any counts as in estimates of the time
UNKNOWN_CELLS: Final = 50_000  # cells of a mesh of unknown size in estimates of the time
Progress = Callable[['FoamCase', 'ProgramStep', float, float], None]  # share of step, residual


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


def _encode(content: str | bytes) -> bytes:
    return content if isinstance(content, bytes) else content.encode()


def cache_folder() -> Path:
    """Return the default folder of solved cases."""
    return find_cache_folder('cfd')


@final
class CaseRunner:
    """
    Solve cases in a folder.

    `folder`: cache of all cases. `tell`: called with the progress of each case. `retry_failed`:
    whether to repeat cases that diverged in an earlier run.
    """

    def __init__(
        self, folder: Path, programs: FoamPrograms, tell: Progress, retry_failed: bool = False
    ) -> None:
        self._folder, self._programs, self._tell = folder, programs, tell
        self._retry_failed = retry_failed

    def case_folder(self, case: FoamCase) -> Path:
        """Return the folder of a case."""
        return self._folder / case.key

    def is_done(self, case: FoamCase) -> bool:
        """Return whether a case has been solved."""
        place = self.case_folder(case)
        return all((place / f'{DONE_PREFIX}{step.name}').is_file() for step in case.steps)

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
        self._prepare(case, place)
        try:
            for step in case.steps:
                if not (place / f'{DONE_PREFIX}{step.name}').is_file():
                    self._run_step(case, step, place)
        except CaseFailed as error:
            if error.diverged:
                words = f'{error} It failed in an earlier run; --retry-failed repeats it.'
                failure.write_text(words, encoding='utf-8')
            raise
        return place

    def _prepare(self, case: FoamCase, place: Path) -> None:
        # A resumed case keeps its files, which a step may have replaced
        _write(place, {p: c for p, c in case.files.items() if not (place / p).exists()})
        _write(place, {'name': f'{case.name}\n'})
        # Flows share the mesh by a link, because it is the largest part of a case
        link = place / 'constant' / 'polyMesh'
        if case.mesh is not None and not link.is_symlink():
            link.parent.mkdir(parents=True, exist_ok=True)
            link.symlink_to(self.case_folder(case.mesh) / 'constant' / 'polyMesh')

    def _run_step(self, case: FoamCase, step: ProgramStep, place: Path) -> None:
        _write(place, step.files)
        for old in (place / 'postProcessing').glob(f'*/{step.begin}'):
            shutil.rmtree(old)  # output of a stopped step
        begun = time.monotonic()
        rounds = 0

        def tell(residual: float) -> None:
            # Counts iterations, not time: time steps of a transient vary
            nonlocal rounds
            rounds += 1
            self._tell(case, step, min(rounds / max(step.rounds, 1), 1.0), residual)

        self._programs.run(step.command, place, place / f'log.{step.name}', tell)
        _write(place, {f'{DONE_PREFIX}{step.name}': f'{time.monotonic() - begun:.1f}\n'})
        self._tell(case, step, 1.0, float('nan'))

    def processor_time(self, case: FoamCase) -> float:
        """Return the processor time of a solved case, as reported by its programs. [s]"""
        return sum(_read_seconds(self.case_folder(case), step.name) for step in case.steps)


def _write(place: Path, files: Mapping[str, str | bytes]) -> None:
    for path, content in files.items():
        (place / path).parent.mkdir(parents=True, exist_ok=True)
        (place / path).write_bytes(_encode(content))


def _read_seconds(place: Path, step: str) -> float:
    log = (place / f'log.{step}').read_text(encoding='utf-8', errors='replace')
    if times := EXECUTION.findall(log):
        return float(times[-1])
    # The program does not print its time: use the wall time in the marker file
    return float((place / f'{DONE_PREFIX}{step}').read_text(encoding='utf-8'))
