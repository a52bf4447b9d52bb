# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Start, signal and reap one process of a launcher."""

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
from lta_graph.ament import find_executable, OUR_PREFIX
from lta_graph.launch_plan import LaunchProcess

KEPT_LINES = 20  # last lines of each stream, for error messages
PR_SET_PDEATHSIG = 1  # linux/prctl.h
# Several nodes with one thread per core each would slow each other down
THREAD_VARIABLES = ('OPENBLAS_NUM_THREADS', 'OMP_NUM_THREADS', 'MKL_NUM_THREADS')
_LIBC = ctypes.CDLL(None)  # loaded here, because loading is unsafe between fork and exec


@final
@dataclass(frozen=True, slots=True)
class ProcessExit:
    """The exit of one process."""

    name: str  # label of the process in the plan
    status: int  # exit status; the negative signal number if a signal ended it
    # Last lines of output
    stdout: tuple[str, ...]
    stderr: tuple[str, ...]
    ends_run: bool  # whether it ends the run (`on_exit_shutdown`)
    success: bool  # whether it is a planned end of the run, with status 0
    stopped: bool  # whether the launcher stopped it

    @property
    def sentence(self) -> str:
        """Return the end without a full stop, such as 'estimator was killed by SIGKILL'."""
        if self.status < 0:
            return f'{self.name} was killed by {signal_name(-self.status)}'
        return f'{self.name} ended' + (f' with status {self.status}' if self.status else '')

    @property
    def lines(self) -> tuple[str, ...]:
        """Last lines of stderr, or of stdout if stderr was empty."""
        return self.stderr or self.stdout  # errors first


def signal_name(number: int) -> str:
    """Return the name of a signal; real-time signals only have a number."""
    try:
        return signal.Signals(number).name
    except ValueError:
        return f'signal {number}'


@final
class ChildProcess:
    """
    A running process, leader of its own session and process group.

    `name` is its label in the plan; `popen` has pipes for stdout and stderr.
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
        """Return whether the process has ended, without reaping it."""
        with self._lock:
            if self.popen.returncode is not None:
                return True
            # WNOWAIT leaves a zombie, so the process id cannot be reused before `reap`.
            info = os.waitid(os.P_PID, self.pid, os.WEXITED | os.WNOHANG | os.WNOWAIT)
            return info is not None

    def send_signal(self, number: int) -> None:
        """Send a signal to the whole process group."""
        with self._lock:
            if self.popen.returncode is None:
                with suppress(ProcessLookupError):
                    os.killpg(self.pid, number)

    def reap(self) -> None:
        """Kill the remaining group members of an ended process and collect its status."""
        # Before `wait` frees the process id, which is also that of the group
        self.send_signal(signal.SIGKILL)
        with self._lock:
            self.popen.wait()

    def has_group_members(self) -> bool:
        """Return whether the group of a reaped process still has members."""
        try:
            # Signal 0 only checks for existence
            os.killpg(self.pid, 0)
        except (ProcessLookupError, PermissionError):
            return False
        return True

    def build_exit_record(self, stopped: bool) -> ProcessExit:
        """Return the exit record of a reaped process."""
        status = int(self.popen.returncode)
        return ProcessExit(
            name=self.name,
            status=status,
            stdout=tuple(self.kept['stdout']),
            stderr=tuple(self.kept['stderr']),
            ends_run=self.process.on_exit_shutdown,
            success=status == 0 and self.process.on_exit_shutdown and self.process.planned,
            stopped=stopped,
        )


def build_node_environment() -> dict[str, str]:
    """Return the environment of nodes: unbuffered output and one linear-algebra thread each."""
    return {**os.environ, 'PYTHONUNBUFFERED': '1', **dict.fromkeys(THREAD_VARIABLES, '1')}


def build_command_line(process: LaunchProcess) -> list[str]:
    """Return a process's command line, with its executable from the ament index."""
    path = find_executable(process.package, process.executable)
    return [str(path), *process.arguments]


def spawn_process(
    process: LaunchProcess, name: str, words: list[str], variables: Mapping[str, str]
) -> ChildProcess:
    """Start a process; raise `BadInput` if the system cannot execute it."""
    try:
        popen = subprocess.Popen(
            words,
            # A node must not read from the user's terminal
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            env=variables,
            # Unbuffered, because `ProcessWatch` reads the file descriptors directly
            bufsize=0,
            # Keeps the terminal's Ctrl-C from reaching the node directly
            start_new_session=True,
            preexec_fn=_bind_to_parent(os.getpid(), process.package.startswith(OUR_PREFIX)),
        )
    except OSError as error:
        raise BadInput(
            f'The program {name} cannot be started ({words[0]}: {error.strerror}); build the '
            'workspace again with make.'
        ) from None
    return ChildProcess(process, name, popen)


def _bind_to_parent(parent: int, ours: bool) -> Callable[[], None]:
    """
    Return a `preexec_fn` that ties the child to its parent and restores SIGINT.

    SIGINT stays blocked in our executables (`ours`) until their `main` unblocks it: Python would
    answer it with a traceback during the imports. Other programs never unblock it.
    """

    def bind() -> None:
        signal.signal(signal.SIGINT, signal.SIG_DFL)  # a shell's background job ignores it
        if ours:
            signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
        _LIBC.prctl(PR_SET_PDEATHSIG, signal.SIGINT)
        if os.getppid() != parent:
            os._exit(1)  # the parent died before prctl took effect

    return bind
