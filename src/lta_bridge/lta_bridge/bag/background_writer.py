"""
A bag that is written beside whoever has the messages: a slow disk stops nobody.

Messages wait in a queue. When it is full the newest are dropped and counted: what was taken before
is whole, and what is missing is one gap as long as the disk's. A fault of the disk ends the
writing, not the thread that hands in messages.
"""

from collections import Counter, deque
from collections.abc import Callable, Sequence
from contextlib import suppress
import threading
import time
from typing import final, Protocol

from lta_bridge.bag.mcap_file import CHUNK_SIZE
from lta_bridge.bag.qos import OfferedQos

FLUSH_PERIOD = 0.4  # wall seconds between flushes: with the nap, the most that SIGKILL can cost
NAP = 0.1  # wall seconds between looks at the queue: messages are cheaper by the hundred
REFRESH_PERIOD = 5.0  # wall seconds between two metadata.yaml
MOST = 500_000  # messages that may wait, however small

Item = tuple[str, bytes, int] | Callable[[], None]


class BagSink(Protocol):
    """What takes the messages in the end; see `BagWriter`."""

    def add_topic(self, name: str, type_name: str, qos: Sequence[OfferedQos]) -> None:
        """Announce a topic."""

    def update_qos(self, name: str, qos: Sequence[OfferedQos]) -> None:
        """Tell what a topic's publishers offer by now."""

    def write(self, topic: str, data: bytes, log_time_ns: int) -> None:
        """Record one message."""

    def flush(self) -> None:
        """Hand everything to the operating system."""

    def update_metadata(self) -> None:
        """Describe the bag as it stands."""

    def check_room(self) -> None:
        """Raise a `StorageFault` while the bag can still be closed."""

    def close(self) -> None:
        """Finish."""

    @property
    def lost_count(self) -> int:
        """Messages that were accepted and are not in the bag."""
        ...


@final
class BackgroundWriter:
    """
    Hands messages to a sink in a thread of its own.

    Parameters
    ----------
    sink : Sink
        Who writes; belongs to the thread from now on.
    room : int
        Most memory of the messages that wait. [bytes]

    Attributes
    ----------
    dropped : Counter of str
        Messages that found no room, by topic.
    fault : Exception or None
        Why nothing more is written: a `StorageFault`, unless we erred.

    """

    def __init__(self, sink: BagSink, room: int) -> None:
        self._sink = sink
        self._room = room
        self._queue: deque[Item] = deque()
        self._taken = 0  # bytes; written by the caller's thread alone
        self._done = 0  # bytes; written by ours alone
        self._unwritten = 0
        self._closing = False
        self._busy_since: float | None = None  # with what the sink was given last
        self._wake = threading.Event()
        self.dropped: Counter[str] = Counter()
        self.fault: Exception | None = None
        self._thread = threading.Thread(target=self._run, name='bag', daemon=True)
        self._thread.start()

    @property
    def queued_bytes(self) -> int:
        """Messages' bytes that the sink has not taken yet."""
        return self._taken - self._done

    @property
    def busy_time(self) -> float:
        """For how long the sink has been busy with one message or one flush. [wall s]"""
        since = self._busy_since
        return 0.0 if since is None else time.monotonic() - since

    @property
    def lost_count(self) -> int:
        """Messages that were taken and that a fault of the disk cost."""
        return self._unwritten + self._sink.lost_count

    def add_topic(self, name: str, type_name: str, qos: Sequence[OfferedQos]) -> None:
        """Announce a topic, before its first message; its type must be known."""
        self.submit(lambda: self._sink.add_topic(name, type_name, qos))

    def update_qos(self, name: str, qos: Sequence[OfferedQos]) -> None:
        """Tell what a topic's publishers offer by now."""
        self.submit(lambda: self._sink.update_qos(name, qos))

    def write(self, topic: str, data: bytes, log_time_ns: int) -> bool:
        """
        Take one message and return whether there was room for it.

        Parameters
        ----------
        topic, data, log_time_ns
            As for `BagWriter.write`.

        """
        waiting = self._taken - self._done + len(data)
        if waiting > self._room or len(self._queue) >= MOST or self.fault is not None:
            self.dropped[topic] += 1
            return False
        self._taken += len(data)
        self._queue.append((topic, data, log_time_ns))
        if waiting > CHUNK_SIZE:
            self._wake.set()
        return True

    def submit(self, step: Callable[[], None]) -> None:
        """Do something with the sink, in the thread and after all that came before."""
        self._queue.append(step)

    def wake_thread(self) -> None:
        """Look at the queue now."""
        self._wake.set()

    def close(self) -> None:
        """
        Write what waits, and finish the bag.

        Raises
        ------
        Exception
            If not all of it could be written, now or before: a `StorageFault`, unless we erred.

        """
        self._closing = True
        self._wake.set()
        self._thread.join()
        if self.fault is not None:
            raise self.fault

    def _run(self) -> None:
        """Write until told to close or until the disk fails, then finish."""
        try:
            self._write_until_closed()
        except Exception as error:
            self.fault = error
        try:
            self._sink.close()
        except Exception as error:
            self.fault = self.fault or error
        while not self._closing:
            self._drop_queue()
            self._wake.wait(NAP)
            self._wake.clear()
        self._drop_queue()

    def _write_until_closed(self) -> None:
        """Empty the queue until told to close."""
        flushed = refreshed = time.monotonic()
        while not self._closing:
            self._wake.wait(NAP)
            self._wake.clear()
            self._drain_queue()
            now = self._busy_since = time.monotonic()
            if now - flushed >= FLUSH_PERIOD:
                flushed = now
                self._sink.flush()
                self._sink.check_room()
            if now - refreshed >= REFRESH_PERIOD:
                refreshed = now
                self._sink.update_metadata()
            self._busy_since = None
        self._drain_queue()

    def _drain_queue(self) -> None:
        """Hand over what waits."""
        write, pop = self._sink.write, self._queue.popleft
        for _ in range(len(self._queue)):  # what comes meanwhile must not put off the flush
            item = pop()
            self._busy_since = time.monotonic()
            if isinstance(item, tuple):
                self._done += len(item[1])
                write(*item)
            else:
                item()
        self._busy_since = None

    def _drop_queue(self) -> None:
        """Count the messages that a fault leaves behind, and answer whoever waits for a step."""
        while self._queue:
            item = self._queue.popleft()
            if isinstance(item, tuple):
                self._done += len(item[1])
                self._unwritten += 1
            else:
                with suppress(Exception):
                    item()
