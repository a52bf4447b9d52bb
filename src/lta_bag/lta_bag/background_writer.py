# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Write a bag in a background thread, so that a slow disk does not block the caller.

Messages wait in a queue. When it is full, new messages are dropped and counted, so that a slow
disk causes one gap instead of scattered losses. A storage fault ends the writing, but raises
nothing in the thread that hands in messages.
"""

from collections import Counter, deque
from collections.abc import Callable, Sequence
from contextlib import suppress
import threading
import time
from typing import final

from lta_bag.mcap_file.output import CHUNK_SIZE
from lta_bag.metadata import OfferedQos
from lta_bag.writer import BagWriter

# Wall seconds. SIGKILL loses at most FLUSH_PERIOD + NAP of messages; each flush costs the memory
# of a chunk's index, about 3 kB with the topics of a flight.
FLUSH_PERIOD = 0.8
NAP = 0.1  # wall seconds between two polls of the queue: batches are cheaper than single messages
REFRESH_PERIOD = 5.0  # wall seconds between two updates of metadata.yaml
# Queue limit in messages: many small ones cost more memory than their bytes
QUEUED_MESSAGES = 500_000

Item = tuple[str, bytes, int] | Callable[[], None]


@final
class BackgroundWriter:
    """
    Hand messages to a sink in a separate thread.

    Parameters
    ----------
    sink : BagWriter
        The caller must not use it afterwards: it belongs to the thread.
    room : int
        Memory limit of the queued messages. [bytes]

    Attributes
    ----------
    dropped : Counter of str
        Messages dropped because the queue was full, by topic.
    fault : Exception or None
        Why nothing more is written: a `StorageFault`, or any other error in case of a bug.

    """

    def __init__(self, sink: BagWriter, room: int) -> None:
        self._sink = sink
        self._room = room
        self._queue: deque[Item] = deque()
        # Two counters with one writing thread each need no lock; their difference is the queue.
        self._taken = 0  # bytes; written by the caller's thread only
        self._done = 0  # bytes; written by the background thread only
        self._unwritten = 0
        self._closing = False
        self._busy_since: float | None = None  # start of the sink's present call
        self._wake = threading.Event()
        self.dropped: Counter[str] = Counter()
        self.fault: Exception | None = None
        self._thread = threading.Thread(target=self._run_writer_loop, name='bag', daemon=True)
        self._thread.start()

    @property
    def queued_bytes(self) -> int:
        """Size of the messages that the sink has not received yet."""
        return self._taken - self._done

    @property
    def busy_time(self) -> float:
        """How long the sink's present call has lasted [wall s]."""
        since = self._busy_since
        return 0.0 if since is None else time.monotonic() - since

    @property
    def lost_count(self) -> int:
        """Return the number of accepted messages lost to a storage fault."""
        return self._unwritten + self._sink.lost_count

    def add_topic(self, name: str, type_name: str, qos: Sequence[OfferedQos]) -> None:
        """Add a topic before its first message; its type must be known."""
        self.submit(lambda: self._sink.add_topic(name, type_name, qos))

    def update_qos(self, name: str, qos: Sequence[OfferedQos]) -> None:
        """Update the QoS profiles that a topic's publishers offer."""
        self.submit(lambda: self._sink.update_qos(name, qos))

    def write(self, topic: str, data: bytes, log_time_ns: int) -> bool:
        """Queue one message; return False if there was no room for it. See `BagWriter.write`."""
        waiting = self._taken - self._done + len(data)
        if waiting > self._room or len(self._queue) >= QUEUED_MESSAGES or self.fault is not None:
            self.dropped[topic] += 1
            return False
        self._taken += len(data)
        self._queue.append((topic, data, log_time_ns))
        # A full chunk is worth writing at once; less waits for the next poll
        if waiting > CHUNK_SIZE:
            self._wake.set()
        return True

    def submit(self, step: Callable[[], None]) -> None:
        """Queue a call to the sink: the thread makes it after everything queued before."""
        # append and popleft of a deque are atomic, so the queue needs no lock
        self._queue.append(step)

    def close(self) -> None:
        """
        Write the queued messages and finish the bag.

        Raises
        ------
        Exception
            The stored `fault`, if not everything could be written.

        """
        self._closing = True
        self._wake.set()
        self._thread.join()
        if self.fault is not None:
            raise self.fault

    def _run_writer_loop(self) -> None:
        """Write until `close` is called or the sink fails, then close the sink."""
        try:
            self._write_until_closed()
        except Exception as error:
            self.fault = error
        try:
            self._sink.close()
        except Exception as error:
            self.fault = self.fault or error
        # After a fault, keep emptying the queue: callers may wait for a submitted step.
        while not self._closing:
            self._drop_queue()
            self._wake.wait(NAP)
            self._wake.clear()
        self._drop_queue()

    def _write_until_closed(self) -> None:
        """Empty the queue until `close` is called."""
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
        """Hand the queued messages to the sink."""
        write, pop = self._sink.write, self._queue.popleft
        for _ in range(len(self._queue)):  # not `while`: new messages must not delay the flush
            item = pop()
            self._busy_since = time.monotonic()
            if isinstance(item, tuple):
                # Before the call: if it fails, the message has left the queue
                self._done += len(item[1])
                write(*item)
            else:
                item()
        self._busy_since = None

    def _drop_queue(self) -> None:
        """Count the messages lost to a fault; still run the submitted steps."""
        while self._queue:
            item = self._queue.popleft()
            if isinstance(item, tuple):
                self._done += len(item[1])
                self._unwritten += 1
            else:
                with suppress(Exception):
                    item()
