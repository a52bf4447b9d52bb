# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Start the processes of a launch plan, monitor them and stop them all.

A thread reads their output and detects exits; events are queued for the caller. Every process
leads its own session, so Ctrl-C reaches only the launcher, which then stops the others.

If the launcher is killed, the kernel sends SIGINT to its processes; one that hangs remains.
"""

from collections import deque
from collections.abc import Callable
from contextlib import suppress
import os
from queue import Empty, SimpleQueue
import selectors
import signal
import threading
import time
from typing import final, Self

from lta_graph.child_process import (
    build_command_line,
    build_node_environment,
    ChildProcess,
    ProcessExit,
    spawn_process,
)
from lta_graph.interrupts import hold_interrupts
from lta_graph.launch_plan import LaunchPlan, LaunchProcess

CHECK_PERIOD = 0.05  # seconds between checks of silent processes
PIPE_CHUNK = 65536  # bytes read at once; a longer line is cut
LAST_CHUNKS = 16  # chunks read after an exit: 1 MiB, the largest pipe buffer
OnLine = Callable[[str, str], None]


@final
class ProcessWatch(threading.Thread):
    """
    Watch processes until all have ended.

    `children`: the processes; this thread owns their pipes. `on_line`: called in this thread with
    the label of a process and each line of its output. `stopping`: set when the launcher stops its
    processes.
    """

    def __init__(
        self, children: list[ChildProcess], on_line: OnLine, stopping: threading.Event
    ) -> None:
        super().__init__(name='watch', daemon=True)
        self.events: SimpleQueue[ProcessExit] = SimpleQueue()
        self.fault: Exception | None = None
        self._living = list(children)
        self._on_line = on_line
        self._stopping = stopping
        self._selector = selectors.DefaultSelector()
        self._partial: dict[int, bytes] = {}
        for child in children:
            for stream in ('stdout', 'stderr'):
                pipe = getattr(child.popen, stream)
                # A grandchild may hold the pipe open, so a read must never block the thread
                os.set_blocking(pipe.fileno(), False)
                self._partial[pipe.fileno()] = b''
                self._selector.register(pipe, selectors.EVENT_READ, (child, stream))

    def run(self) -> None:
        """Read output until the last process has ended."""
        while self._living:
            for key, _ in self._selector.select(CHECK_PERIOD):
                self._read_chunk(key)
            for child in [item for item in self._living if item.has_exited()]:
                self._finish_process(child)
        self._selector.close()

    def _read_chunk(self, key: selectors.SelectorKey) -> bool:
        """Read a chunk from a pipe; return False if there was none."""
        try:
            chunk = os.read(key.fd, PIPE_CHUNK)
        except BlockingIOError:
            return False
        if not chunk:
            self._close_pipe(key)
            return False
        # The last piece has no newline yet and waits for the next chunk
        *lines, rest = (self._partial[key.fd] + chunk).split(b'\n')
        # Bounds the memory if a process never prints a newline
        if len(rest) > PIPE_CHUNK:
            lines, rest = [*lines, rest], b''
        self._partial[key.fd] = rest
        for line in lines:
            self._forward_line(key, line)
        return True

    def _forward_line(self, key: selectors.SelectorKey, line: bytes) -> None:
        child, stream = key.data
        text = line.decode(errors='replace').rstrip('\r')
        child.kept[stream].append(text)
        # After a fault keep draining the pipes, so that processes do not block on a full one
        if self.fault is None:
            try:
                self._on_line(child.name, text)
            except Exception as error:
                self.fault = error  # reraised in `Launcher.poll`

    def _close_pipe(self, key: selectors.SelectorKey) -> None:
        if self._partial[key.fd]:
            self._forward_line(key, self._partial[key.fd])
        self._selector.unregister(key.fileobj)
        key.fileobj.close()  # type: ignore[union-attr]

    def _finish_process(self, child: ChildProcess) -> None:
        """Reap an ended process, read its remaining output and queue its exit."""
        # Read before reaping: a stop that begins meanwhile is not the cause of this exit
        stopped = self._stopping.is_set()
        child.reap()
        keys = [key for key in self._selector.get_map().values() if key.data[0] is child]
        for key in keys:
            # Bounded, because a surviving grandchild could print without end
            for _ in range(LAST_CHUNKS):
                if not self._read_chunk(key):
                    break
            if not key.fileobj.closed:  # type: ignore[union-attr]
                self._close_pipe(key)
        self._living.remove(child)
        self.events.put(child.build_exit_record(stopped))


STOP_GRACE = 8.0  # seconds from SIGINT to SIGTERM: the recorder must close its bag
TERM_GRACE = 2.0  # seconds from SIGTERM to SIGKILL
GROUP_PATIENCE = 1.0  # seconds; without an init that reaps orphans (containers) groups never empty
STOP_POLL = 0.02  # seconds between checks while stopping


@final
class Launcher:
    """
    Run the processes of a launch plan: `with Launcher(plan, on_line) as launcher: ...`.

    Start it from the main thread: the kernel sends the parent-death signal when the starting
    thread ends.

    Parameters
    ----------
    on_line : callable
        Called from another thread with the label of a process and each line of its output.
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
        self._watch: ProcessWatch | None = None

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
        Return the exit that ended the run; None while it continues.

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
                for process, words in zip(started, commands, strict=True):
                    # Ctrl-C during the start: start no more, `stop` ends the others
                    if presses:
                        break
                    child = spawn_process(process, self._plan.label(process), words, variables)
                    self._children.append(child)
                # Start the thread after the forks: forking a process with threads is unsafe.
                self._start_process_watch()
        # Includes KeyboardInterrupt, which must not leave processes behind
        except BaseException:
            self.stop()
            raise

    def _start_process_watch(self) -> None:
        self._watch = ProcessWatch(self._children, self._on_line, self._stopping)
        self._watch.start()

    def poll(self) -> list[ProcessExit]:
        """Return the exits since the last call; reraise an exception of `on_line`."""
        return self.wait(0.0)

    def wait(self, timeout: float) -> list[ProcessExit]:
        """
        Wait up to `timeout` [s] for an exit, and return all exits since the last call.

        Ctrl-C is delivered when the wait is over.

        """
        exits: list[ProcessExit] = []
        if self._watch is not None:
            # An exception raised by a signal inside the queue may leave it locked.
            with hold_interrupts():
                with suppress(Empty):
                    exits.append(self._watch.events.get(timeout=timeout))
                    while True:
                        exits.append(self._watch.events.get_nowait())
                self.ended += exits
            # While stopping, a fault of `on_line` must not prevent the rest of the stop
            if self._watch.fault is not None and not self._stopping.is_set():
                raise self._watch.fault
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
            self._reap_processes()

    def _list_stop_signals(self, child: ChildProcess) -> list[tuple[float, signal.Signals]]:
        return [
            (0.0, signal.SIGINT),
            (self._stop_grace(child.process), signal.SIGTERM),
            (TERM_GRACE, signal.SIGKILL),
        ]

    def _stop_grace(self, process: LaunchProcess) -> float:
        """Return the time from SIGINT to SIGTERM [s]."""
        return self._grace if process.sigterm_timeout is None else process.sigterm_timeout

    def _reap_processes(self) -> None:
        # The start was interrupted before the thread existed, but its processes have pipes to
        # drain
        if self._watch is None and self._children:
            self._start_process_watch()
        if self._watch is not None:
            self._watch.join(1.0)  # bounded: `on_line` may block on a full terminal
        for child in self._children:
            child.reap()
        deadline = time.monotonic() + GROUP_PATIENCE
        while (
            any(child.has_group_members() for child in self._children)
            and time.monotonic() < deadline
        ):
            time.sleep(STOP_POLL)
        self.poll()
