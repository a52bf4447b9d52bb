"""Read the output of a launcher's processes and detect their exits, in a thread."""

from collections.abc import Callable
import os
from queue import SimpleQueue
import selectors
import threading
from typing import final

from lta_graph.child_process import ChildProcess, ProcessExit

PERIOD = 0.05  # seconds between checks of silent processes
CHUNK = 65536  # bytes read at once; a longer line is cut
LAST_WORDS = 16  # chunks read after an exit: 1 MiB, the largest pipe buffer

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
            for key, _ in self._selector.select(PERIOD):
                self._read_chunk(key)
            for child in [item for item in self._living if item.has_exited()]:
                self._finish_process(child)
        self._selector.close()

    def _read_chunk(self, key: selectors.SelectorKey) -> bool:
        """Read a chunk from a pipe; return False if there was none."""
        try:
            chunk = os.read(key.fd, CHUNK)
        except BlockingIOError:
            return False
        if not chunk:
            self._close_pipe(key)
            return False
        # The last piece has no newline yet and waits for the next chunk
        *lines, rest = (self._partial[key.fd] + chunk).split(b'\n')
        # Bounds the memory if a process never prints a newline
        if len(rest) > CHUNK:
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
            for _ in range(LAST_WORDS):
                if not self._read_chunk(key):
                    break
            if not key.fileobj.closed:  # type: ignore[union-attr]
                self._close_pipe(key)
        self._living.remove(child)
        self.events.put(child.build_exit_record(stopped))
