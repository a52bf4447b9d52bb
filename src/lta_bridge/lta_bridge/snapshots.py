"""Snapshots of what is kept in memory: asked for, or taken at a fault."""

from collections.abc import Iterable
import math
import threading
from typing import final

from lta_bridge.bag.background_writer import BackgroundWriter
from lta_bridge.bag.snapshot_buffer import Snapshot, SnapshotBuffer
from lta_bridge.bag.storage import StorageFault
from lta_bridge.fault_watch import FaultWatch, TaskStatus
from lta_graph.health import HealthLevel

ASKED = 'asked for'
STOPPED = 'stopped before the flight was over'


@final
class SnapshotJob:
    """
    A snapshot on its way to the disk.

    Attributes
    ----------
    done : threading.Event
        Set when it has come to an end.
    made : Snapshot or None
        The bag, if it could be written whole.
    fault : str
        Why it could not.

    """

    def __init__(self) -> None:
        self.done = threading.Event()
        self.made: Snapshot | None = None
        self.fault = ''

    @property
    def summary(self) -> str:
        """How it stands."""
        if self.made is not None:
            return f"{self.made.messages} messages are in '{self.made.path}'."
        return self.fault or 'The snapshot is still being written.'


@final
class SnapshotScheduler:
    """
    Writes the memory to the disk, in the writer's thread.

    Parameters
    ----------
    memory : SnapshotMemory
        What is kept.
    writer : BackgroundWriter
        Who fills it.

    """

    def __init__(self, memory: SnapshotBuffer, writer: BackgroundWriter) -> None:
        self._memory = memory
        self._writer = writer
        self._faults = FaultWatch()
        self._savings: list[SnapshotJob] = []

    def request_snapshot(self, why: str = ASKED) -> SnapshotJob:
        """Have everything written that has come so far, and return what will tell the outcome."""
        saving = SnapshotJob()

        def save() -> None:
            try:
                saving.made = self._memory.write_snapshot(why)
            except (StorageFault, ValueError) as fault:
                saving.fault = str(fault)
            finally:
                saving.done.set()

        self._savings.append(saving)
        self._writer.submit(save)
        self._writer.wake_thread()
        return saving

    def add_statuses(self, statuses: Iterable[TaskStatus], now: float) -> None:
        """Take note of a diagnostics message as `FaultWatch` does, and save at a fault. [s]"""
        self._faults.add_statuses(statuses)
        self.save_if_due(now)

    def save_if_due(self, now: float) -> None:
        """Save if a fault is due. [wall s]"""
        if found := self._faults.take_new_faults(now):
            self.request_snapshot('; '.join(found))

    def save_remaining(self, robots: Iterable[str]) -> SnapshotJob | None:
        """
        Save at the end what nobody has told yet: faults that wait, or an end that was none.

        A graph whose node dies is stopped before the others can say what they miss.

        Parameters
        ----------
        robots : iterable of str
            Namespaces of those whose flight should be over.

        """
        found = self._faults.take_new_faults(math.inf)
        if not found and not self._faults.over.issuperset(robots):
            found = [STOPPED]
        return (
            self.request_snapshot('; '.join(found))
            if found and not self._memory.is_empty
            else None
        )

    def summarize(self) -> tuple[HealthLevel, str, dict[str, object]]:
        """Return level, sentence and figures of the snapshots so far."""
        figures: dict[str, object] = {
            'written': sum(saving.made is not None for saving in self._savings),
            'failed': sum(bool(saving.fault) for saving in self._savings),
            'memory_bytes': self._memory.size,
        }
        last = self._savings[-1] if self._savings else None
        level = HealthLevel.WARN if last is not None and last.fault else HealthLevel.OK
        return level, 'none yet' if last is None else last.summary, figures
