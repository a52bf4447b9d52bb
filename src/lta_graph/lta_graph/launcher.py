"""
Start the processes of a launch plan, monitor them and stop them all.

Threads read their output and wait for their ends; exits are queued for the caller. Every process
leads its own session, so Ctrl-C reaches only the launcher, which then stops the others.

If the launcher is killed, the kernel sends SIGINT to its processes; one that hangs remains.
"""

from collections import deque
from contextlib import suppress
from queue import Empty, SimpleQueue
import signal
import threading
import time
from typing import final, Self

from lta_graph.child_process import (
    build_command_line,
    build_node_environment,
    ChildProcess,
    OnLine,
    ProcessExit,
    spawn_process,
)
from lta_graph.interrupts import hold_interrupts
from lta_graph.launch_plan import LaunchPlan, LaunchProcess

STOP_GRACE = 8.0  # seconds from SIGINT to SIGTERM: the recorder must close its bag
TERM_GRACE = 2.0  # seconds from SIGTERM to SIGKILL
GROUP_PATIENCE = 1.0  # seconds; without an init that reaps orphans (containers) groups never empty
STOP_POLL = 0.02  # seconds between checks while stopping
EXIT_PATIENCE = 2.0  # seconds for the exit of an ended process: `on_line` may block for ever


@final
class Launcher:
    """
    Run the processes of a launch plan: `with Launcher(plan, on_line) as launcher: ...`.

    Start it from the main thread: the kernel sends the parent-death signal when the starting
    thread ends.

    Parameters
    ----------
    on_line : callable
        Called from other threads, one at a time, with the label of a process and each line of its
        output.
    grace : float
        Time from SIGINT to SIGTERM of a process without `sigterm_timeout`. [s]

    Attributes
    ----------
    ended : list of ProcessExit
        All exits that `poll` or `wait` has returned, in order.

    """

    def __init__(
        self,
        plan: LaunchPlan,
        on_line: OnLine,
        *,
        grace: float = STOP_GRACE,
    ) -> None:
        self.ended: list[ProcessExit] = []
        self._plan = plan
        self._on_line = on_line
        self._grace = grace
        self._children: list[ChildProcess] = []
        self._stopping = threading.Event()
        self._exits: SimpleQueue[ProcessExit] = SimpleQueue()
        self._line_lock = threading.Lock()
        self._fault: Exception | None = None  # of `on_line`

    def __enter__(self) -> Self:
        """Start all processes."""
        self.start()
        return self

    def __exit__(self, *_: object) -> None:
        """Stop all processes."""
        self.stop()

    @property
    def running(self) -> list[str]:
        """Labels of the processes that have not ended."""
        return [child.name for child in self._children if not child.has_exited()]

    @property
    def running_nodes(self) -> list[str]:
        """Labels of the nodes of these processes."""
        alive = [child.process for child in self._children if not child.has_exited()]
        return [label for process in alive for label in self._plan.list_nodes(process)]

    @property
    def outcome(self) -> ProcessExit | None:
        """
        The exit that ended the run; None while it continues.

        This is the exit of a process with `on_exit_shutdown`, or of the last
        process of all. `success` is whether it was planned.
        """
        unasked = [item for item in self.ended if not item.stopped]
        ending = [item for item in unasked if item.ends_run]
        if not ending and len(unasked) == len(self._children):
            ending = unasked[-1:]
        return next(iter(ending), None)

    def start(self) -> None:
        """
        Start all processes, or none.

        Raises
        ------
        BadInput
            If one cannot be found or executed.
        KeyboardInterrupt
            After Ctrl-C during the start; nothing is left running.

        """
        # Before the first start, so that a missing executable starts nothing
        started = self._plan.started
        commands = [build_command_line(process) for process in started]
        variables = build_node_environment()
        try:
            with hold_interrupts() as presses:
                try:
                    for process, words in zip(started, commands, strict=True):
                        # Ctrl-C during the start: start no more, `stop` ends the others
                        if presses:
                            break
                        label = self._plan.label(process)
                        self._children.append(spawn_process(process, label, words, variables))
                finally:
                    # After the forks: forking a process with threads is unsafe
                    for child in self._children:
                        child.watch(self._forward_line, self._stopping, self._exits)
        # Includes KeyboardInterrupt, which must not leave processes behind
        except BaseException:
            self.stop()
            raise

    def _forward_line(self, name: str, line: str) -> None:
        with self._line_lock:
            # After a fault keep draining the pipes, so that processes do not block on a full one
            if self._fault is None:
                try:
                    self._on_line(name, line)
                except Exception as error:
                    self._fault = error  # reraised in `wait`

    def poll(self) -> list[ProcessExit]:
        """Return the exits since the last call; reraise an exception of `on_line`."""
        return self.wait(0.0)

    def wait(self, timeout: float) -> list[ProcessExit]:
        """
        Wait up to `timeout` [s] for an exit, and return all exits since the last call.

        Ctrl-C is delivered when the wait is over.

        """
        exits: list[ProcessExit] = []
        # An exception raised by a signal inside the queue may leave it locked.
        with hold_interrupts():
            with suppress(Empty):
                exits.append(self._exits.get(timeout=timeout))
                while True:
                    exits.append(self._exits.get_nowait())
            self.ended += exits
        # While stopping, a fault of `on_line` must not prevent the rest of the stop
        if self._fault is not None and not self._stopping.is_set():
            raise self._fault
        return exits

    def stop(self) -> None:
        """
        Stop all processes: SIGINT, then SIGTERM, then SIGKILL.

        Returns when all are gone. Ctrl-C moves on to the next signal immediately and is raised as
        KeyboardInterrupt at the end.
        """
        with hold_interrupts() as presses:
            self._stopping.set()
            # For each process, the signals to come and the seconds before each
            left = {child: deque(self._list_stop_signals(child)) for child in self._children}
            since = dict.fromkeys(left, time.monotonic())
            seen = len(presses)
            while self.running:
                now, pressed, seen = time.monotonic(), len(presses) > seen, len(presses)
                for child, signals in left.items():
                    if signals and (pressed or now - since[child] >= signals[0][0]):
                        _, number = signals.popleft()
                        child.send_signal(number)
                        since[child] = now
                time.sleep(STOP_POLL)
            self._collect_exits()

    def _list_stop_signals(self, child: ChildProcess) -> list[tuple[float, signal.Signals]]:
        return [
            (0.0, signal.SIGINT),
            (self._stop_grace(child.process), signal.SIGTERM),
            (TERM_GRACE, signal.SIGKILL),
        ]

    def _stop_grace(self, process: LaunchProcess) -> float:
        """Return the time from SIGINT to SIGTERM. [s]"""
        return self._grace if process.sigterm_timeout is None else process.sigterm_timeout

    def _collect_exits(self) -> None:
        for child in self._children:
            child.join(EXIT_PATIENCE)
        deadline = time.monotonic() + GROUP_PATIENCE
        while (
            any(child.has_group_members() for child in self._children)
            and time.monotonic() < deadline
        ):
            time.sleep(STOP_POLL)
        self.poll()
