"""One process that a launcher owns: how it is started, signalled, and seen to end."""

from collections import deque
from collections.abc import Callable, Mapping
from contextlib import suppress
import ctypes
from dataclasses import dataclass
import os
import signal
import subprocess
import threading
from typing import final

from lta_config.errors import BadInput
from lta_graph.ament import find_executable
from lta_graph.launch_node import LaunchProcess

KEPT_LINES = 20  # of each stream
PR_SET_PDEATHSIG = 1  # linux/prctl.h
THREADS = ('OPENBLAS_NUM_THREADS', 'OMP_NUM_THREADS', 'MKL_NUM_THREADS')
_LIBC = ctypes.CDLL(None)  # loaded before any fork: nothing may be imported after one


@final
@dataclass(frozen=True, slots=True)
class ProcessExit:
    """
    How one process ended.

    Attributes
    ----------
    name : str
        What the plan calls the process.
    status : int
        Exit status; minus the signal's number where a signal ended it.
    stdout, stderr : tuple of str
        Its last lines.
    success : bool
        Whether this was the planned end of the run: status 0 of an `on_exit: shutdown` process.
    stopped : bool
        Whether the launcher had asked it to end.

    """

    name: str
    status: int
    stdout: tuple[str, ...]
    stderr: tuple[str, ...]
    success: bool
    stopped: bool

    @property
    def sentence(self) -> str:
        """What happened, without a full stop: 'estimator was killed by SIGKILL'."""
        if self.status < 0:
            return f'{self.name} was killed by {signal_name(-self.status)}'
        return f'{self.name} ended' + (f' with status {self.status}' if self.status else '')

    @property
    def lines(self) -> tuple[str, ...]:
        """Its last lines on stderr, or on stdout if there were none."""
        return self.stderr or self.stdout


def signal_name(number: int) -> str:
    """Return 'SIGKILL' for 9; real-time signals have only their number."""
    try:
        return signal.Signals(number).name
    except ValueError:
        return f'signal {number}'


@final
class ChildProcess:
    """
    A running process, leader of its own session and process group.

    Parameters
    ----------
    process : Process
        What runs.
    name : str
        What the plan calls it.
    popen : subprocess.Popen
        The process itself, with pipes for stdout and stderr.

    """

    def __init__(
        self, process: LaunchProcess, name: str, popen: 'subprocess.Popen[bytes]'
    ) -> None:
        self.process = process
        self.name = name
        self.pid = popen.pid
        self.popen = popen
        self.kept = {
            'stdout': deque[str](maxlen=KEPT_LINES),
            'stderr': deque[str](maxlen=KEPT_LINES),
        }
        self._lock = threading.Lock()

    def has_exited(self) -> bool:
        """Tell whether the process has ended; it stays a zombie, so its id is not used again."""
        with self._lock:
            if self.popen.returncode is not None:
                return True
            found = os.waitid(os.P_PID, self.pid, os.WEXITED | os.WNOHANG | os.WNOWAIT)
            return found is not None

    def send_signal(self, number: int) -> None:
        """Send a signal to the process and all that it started."""
        with self._lock:
            if self.popen.returncode is None:
                with suppress(ProcessLookupError):
                    os.killpg(self.pid, number)

    def reap(self) -> None:
        """Kill what an ended process has left in its group, and take its status."""
        self.send_signal(signal.SIGKILL)
        with self._lock:
            self.popen.wait()

    def has_group_members(self) -> bool:
        """Tell whether a reaped process's group still has members: a kill takes a moment."""
        try:
            os.killpg(self.pid, 0)
        except (ProcessLookupError, PermissionError):
            return False
        return True

    def build_exit(self, stopped: bool) -> ProcessExit:
        """Return how a reaped process ended."""
        status = int(self.popen.returncode)
        return ProcessExit(
            name=self.name,
            status=status,
            stdout=tuple(self.kept['stdout']),
            stderr=tuple(self.kept['stderr']),
            success=status == 0 and self.process.on_exit_shutdown,
            stopped=stopped,
        )


def build_environment() -> dict[str, str]:
    """Return what nodes run in: prints come at once, and each is one thread of linear algebra."""
    return {**os.environ, 'PYTHONUNBUFFERED': '1', **dict.fromkeys(THREADS, '1')}


def build_command(process: LaunchProcess) -> list[str]:
    """Return a process's whole command line; the executable is found by the ament index."""
    path = find_executable(process.package, process.executable)
    return [str(path), *process.arguments]


def spawn_process(
    process: LaunchProcess, name: str, words: list[str], variables: Mapping[str, str]
) -> ChildProcess:
    """
    Start a process.

    Raises
    ------
    BadInput
        If the system cannot execute it.

    """
    try:
        popen = subprocess.Popen(
            words,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            env=variables,
            bufsize=0,
            start_new_session=True,
            preexec_fn=_bind_to_parent(os.getpid()),
        )
    except OSError as error:
        raise BadInput(
            f'{name} cannot be started: {words[0]}: {error.strerror}; build it again.'
        ) from None
    return ChildProcess(process, name, popen)


def _bind_to_parent(parent: int) -> Callable[[], None]:
    """Return what a child does before it executes: end with its parent, and heed SIGINT."""

    def bind() -> None:
        signal.signal(signal.SIGINT, signal.SIG_DFL)  # a shell's background job ignores it
        _LIBC.prctl(PR_SET_PDEATHSIG, signal.SIGINT)
        if os.getppid() != parent:
            os._exit(1)  # the parent died before prctl could watch it

    return bind
