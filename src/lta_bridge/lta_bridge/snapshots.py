"""Write snapshots of the buffered messages, on request or at a fault."""

from collections.abc import Iterable
import math
import threading
from typing import final

from lta_bridge.bag.background_writer import BackgroundWriter
from lta_bridge.bag.snapshot_buffer import Snapshot, SnapshotBuffer
from lta_bridge.bag.storage import StorageFault
from lta_bridge.fault_watch import DiagnosticsEntry, FaultWatch
from lta_graph.health import HealthLevel

ASKED = 'requested'
STOPPED = 'the recorder stopped before the flight was over'


@final
class SnapshotJob:
    """
    A requested snapshot.

    Attributes
    ----------
    done : threading.Event
        Set when the snapshot was written or has failed.
    made : Snapshot or None
        The written bag; None before that and after a failure.
    fault : str
        Why it failed; empty if it did not.

    """

    def __init__(self) -> None:
        self.done = threading.Event()
        self.made: Snapshot | None = None
        self.fault = ''

    @property
    def status_text(self) -> str:
        """The state of the snapshot as a sentence."""
        if self.made is not None:
            return f"The snapshot '{self.made.path}' has {self.made.messages} messages."
        return self.fault or 'The snapshot is still being written.'


@final
class SnapshotScheduler:
    """Write snapshots of a buffer, in the thread of the writer that fills it."""

    def __init__(self, memory: SnapshotBuffer, writer: BackgroundWriter) -> None:
        self._memory = memory
        self._writer = writer
        self._faults = FaultWatch()
        self._savings: list[SnapshotJob] = []

    def request_snapshot(self, why: str = ASKED) -> SnapshotJob:
        """Request a snapshot of all messages so far; the returned job reports the outcome."""
        saving = SnapshotJob()

        def save() -> None:
            try:
                saving.made = self._memory.write_snapshot(why)
            # The recorder goes on: only this snapshot has failed
            except (StorageFault, ValueError) as fault:
                saving.fault = str(fault)
            finally:
                # In any case, or the service that waits for it would block
                saving.done.set()

        self._savings.append(saving)
        # In the queue behind all messages so far, so that the snapshot contains them
        self._writer.submit(save)
        self._writer.wake_thread()
        return saving

    def add_statuses(self, statuses: Iterable[DiagnosticsEntry], now: float) -> None:
        """Add a diagnostics message at a wall time [s]; save at a new fault."""
        self._faults.add_statuses(statuses)
        self.save_if_due(now)

    def save_if_due(self, now: float) -> None:
        """Save if a new fault is to be reported. [wall s]"""
        if faults := self._faults.take_new_faults(now):
            self.request_snapshot('; '.join(faults))

    def save_remaining(self, robots: Iterable[str]) -> SnapshotJob | None:
        """
        Save at the end, if faults were not reported yet or a flight was not over.

        If a node dies, the graph is stopped before others can report missing inputs.

        `robots`: namespaces of the robots whose flight should be over.
        """
        # Infinite time: do not wait for further symptoms of a fault
        faults = self._faults.take_new_faults(math.inf)
        if not faults and not self._faults.over.issuperset(robots):
            faults = [STOPPED]
        return (
            self.request_snapshot('; '.join(faults))
            if faults and not self._memory.is_empty
            else None
        )

    def summarize(self) -> tuple[HealthLevel, str, dict[str, object]]:
        """Return level, message and figures of the snapshots so far."""
        figures: dict[str, object] = {
            'written': sum(saving.made is not None for saving in self._savings),
            'failed': sum(bool(saving.fault) for saving in self._savings),
            'memory_bytes': self._memory.size,
        }
        last = self._savings[-1] if self._savings else None
        level = HealthLevel.WARN if last is not None and last.fault else HealthLevel.OK
        return level, 'no snapshots yet' if last is None else last.status_text, figures
