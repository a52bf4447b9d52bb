"""
Run OpenFOAM programs and explain their failures.

Only `WM_PROJECT_DIR` is set, because the bashrc of the Debian package calls programs that it does
not ship.
"""

from collections.abc import Callable, Mapping, Sequence
from functools import cache
import os
from pathlib import Path
import re
import shutil
import subprocess
from typing import Final, final

from lta_config.errors import BadInput

PROJECT_VARIABLE: Final = 'WM_PROJECT_DIR'
DEBIAN_FOLDER: Final = '/usr/share/openfoam'
OPENFOAM_PROGRAMS: Final = (
    'blockMesh', 'snappyHexMesh', 'topoSet', 'checkMesh', 'simpleFoam', 'pimpleFoam',
)  # fmt: skip
NO_OPENFOAM: Final = (
    'OpenFOAM is not installed; install it with "sudo apt-get install --no-install-recommends '
    'openfoam" (450 MB), or use --fidelity analytic, which does not need it.'
)
TIME_LINE: Final = re.compile(r'^Time = [-+.\deE]+s?$')
RESIDUAL: Final = re.compile(r'Solving for p, Initial residual = ([-+.\deE]+|nan|-nan)')
FATAL: Final = 'FOAM FATAL'
LOG_TAIL: Final = 40  # lines of a log that are searched for the reason


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
        raise BadInput(NO_OPENFOAM)


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


@final
class FoamPrograms:
    """Run programs, and keep track of them so that all can be stopped."""

    def __init__(self) -> None:
        self._running: set[subprocess.Popen[str]] = set()
        self._stopped = False

    def stop(self) -> None:
        """Stop the running programs and start no more."""
        self._stopped = True
        # A copy, because other threads remove finished processes
        for process in list(self._running):
            process.terminate()

    def run(
        self, command: Sequence[str], folder: Path, log: Path, tell: Callable[[float], None]
    ) -> None:
        """
        Run a program in the folder of a case and wait for it.

        `tell` is called with the residual of the pressure at each iteration or time step.

        Raises
        ------
        CaseFailed
            If it fails or was stopped.

        """
        if self._stopped:
            raise CaseFailed(
                'The computation was stopped before it began; start it again to resume.'
            )
        residual = float('nan')
        # Popen does not update PWD, which OpenFOAM may use as the working directory
        where = {**program_environment(), 'PWD': str(folder)}
        with log.open('w', encoding='utf-8') as out:
            process = subprocess.Popen(
                list(command), cwd=folder, env=where, stdout=subprocess.PIPE,
                # Own session: Ctrl-C reaches Python only, which stops the programs
                stderr=subprocess.STDOUT, text=True, errors='replace', start_new_session=True,
            )  # fmt: skip
            self._running.add(process)
            with process:  # leaves no pipe open and waits, whatever happens
                assert process.stdout is not None
                for line in process.stdout:
                    out.write(line)
                    if (match := RESIDUAL.search(line)) is not None:
                        residual = float(match[1])
                    elif TIME_LINE.match(line.strip()):
                        tell(residual)
            self._running.discard(process)
        if process.returncode != 0:
            raise self._build_failure(command[0], process.returncode, log)

    def _build_failure(self, program: str, code: int, log: Path) -> CaseFailed:
        if self._stopped:
            return CaseFailed('The computation was stopped; start it again to resume.')
        lines = log.read_text(encoding='utf-8').splitlines()
        # The first fatal error is the cause; the end of the log shows signals
        fatal = next((k for k, line in enumerate(lines) if FATAL in line), len(lines))
        tail = lines[fatal : fatal + LOG_TAIL] + lines[-LOG_TAIL:]
        return CaseFailed(explain_failure(program, code, tail), is_float_error(code, tail))


def is_float_error(code: int, tail: Sequence[str]) -> bool:
    """Return whether a program ended with a floating point error; parameters as below."""
    # 8 is SIGFPE; a shell reports it as 128 + 8.
    return code in (-8, 136) or any('sigFpe::' in line for line in tail)


def explain_failure(program: str, code: int, tail: Sequence[str]) -> str:
    """
    Return in one sentence why a program failed.

    `code` is its exit status, negative for a signal; `tail` holds the log lines from a fatal error
    on, and the last ones.
    """
    text = '\n'.join(tail)
    if 'No space left' in text:
        return (
            f'{program} failed because the disk is full; free disk space or choose another '
            'folder with --cache, then start again.'
        )
    if is_float_error(code, tail):
        return f'{program} diverged (floating point error); check that the shape is valid.'
    # 9 is SIGKILL, which the kernel sends when memory runs out.
    if 'bad_alloc' in text or code in (-9, 137):
        return (
            f'{program} was killed or ran out of memory; use --workers 1 or a coarser '
            'fidelity, and start again to resume.'
        )
    if code < 0 and FATAL not in text:
        return f'{program} was killed by signal {-code}; start again to resume.'
    fallback = next((line.strip() for line in tail if FATAL in line), tail[-1] if tail else '')
    after = text.partition(FATAL)[2].splitlines()[1:]
    reason = next((line.strip() for line in after if line.strip()), fallback)
    return f'{program} failed with exit status {code}: {reason[:200]}'
