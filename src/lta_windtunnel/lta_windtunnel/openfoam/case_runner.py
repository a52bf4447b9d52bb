"""
Solve cases on disk, each in a folder named by the hash of its content.

A marker file records each finished step, so that an interrupted run resumes there.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
import fcntl
from pathlib import Path
import re
import shutil
import time
from typing import Final, final

from lta_config.machine import find_cache_folder
from lta_windtunnel.openfoam.case import FoamCase, ProgramStep
from lta_windtunnel.openfoam.engine import CaseFailed, FoamPrograms

DONE: Final = 'done.'
FAILURE: Final = 'failure'  # file with the reason why a case failed
EXECUTION: Final = re.compile(r'ExecutionTime = ([\d.]+) s')
Progress = Callable[[FoamCase, ProgramStep, float, float], None]  # share of the step, residual


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
        return all(
            (self.case_folder(case) / f'{DONE}{step.name}').is_file() for step in case.steps
        )

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
        failure = self.case_folder(case) / FAILURE
        if self._retry_failed:
            failure.unlink(missing_ok=True)
        if failure.is_file():
            raise CaseFailed(failure.read_text(encoding='utf-8'))
        try:
            return self._solve(case)
        except CaseFailed as error:
            if error.diverged:
                words = f'{error} It failed in an earlier run; --retry-failed repeats it.'
                failure.write_text(words, encoding='utf-8')
            raise

    def _solve(self, case: FoamCase) -> Path:
        place = self.case_folder(case)
        if case.mesh is None and place.exists() and not self.is_done(case):
            shutil.rmtree(place)  # a mesh is changed in place: restart a half-finished one
        self._prepare(case, place)
        for step in case.steps:
            if not (place / f'{DONE}{step.name}').is_file():
                self._run_step(case, step, place)
        return place

    def _prepare(self, case: FoamCase, place: Path) -> None:
        place.mkdir(parents=True, exist_ok=True)
        for path, content in case.files.items():
            target = place / path
            # A resumed case keeps its files, which a step may have replaced
            if target.exists():
                continue
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_bytes(content if isinstance(content, bytes) else content.encode())
        (place / 'name').write_text(f'{case.name}\n', encoding='utf-8')
        # Flows share the mesh by a link, because it is the largest part of a case
        link = place / 'constant' / 'polyMesh'
        if case.mesh is not None and not link.is_symlink():
            link.parent.mkdir(parents=True, exist_ok=True)
            link.symlink_to(self.case_folder(case.mesh) / 'constant' / 'polyMesh')

    def _run_step(self, case: FoamCase, step: ProgramStep, place: Path) -> None:
        for path, text in step.files.items():
            (place / path).parent.mkdir(parents=True, exist_ok=True)
            (place / path).write_text(text, encoding='utf-8')
        for old in (place / 'postProcessing').glob(f'*/{step.begin}'):
            shutil.rmtree(old)  # output of a stopped step
        begun = time.monotonic()
        rounds = [0]

        def tell(_: float, residual: float) -> None:
            # Counts iterations, not time: time steps of a transient vary
            rounds[0] += 1
            self._tell(case, step, min(rounds[0] / max(step.rounds, 1), 1.0), residual)

        self._programs.run(step.command, place, place / f'log.{step.name}', tell)
        spent = time.monotonic() - begun
        (place / f'{DONE}{step.name}').write_text(f'{spent:.1f}\n', encoding='utf-8')
        self._tell(case, step, 1.0, float('nan'))

    def processor_time(self, case: FoamCase) -> float:
        """Return the processor time of a solved case, as reported by its programs. [s]"""
        return sum(_read_seconds(self.case_folder(case), step.name) for step in case.steps)


def _read_seconds(place: Path, step: str) -> float:
    times = EXECUTION.findall(
        (place / f'log.{step}').read_text(encoding='utf-8', errors='replace')
    )
    if times:
        return float(times[-1])
    # The program does not print its time: use the wall time in the marker file
    return float((place / f'{DONE}{step}').read_text(encoding='utf-8'))
