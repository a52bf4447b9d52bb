"""How late the machine wakes who sleeps, how fast it works: its own delays, not a program's."""

import statistics
import threading
import time
from typing import Final, final, Self

NAP: Final = 0.01  # s
TIMES: Final = 100  # that the piece of work is done
ROUNDS: Final = 100_000  # of the piece of work, some 10 ms


@final
class Lateness:
    """
    Sleep again and again, for as long as the context lasts.

    Attributes
    ----------
    most : float
        By how much a sleep was too long at most. [s]

    """

    def __init__(self) -> None:
        self.most = 0.0
        self._over = threading.Event()
        self._thread = threading.Thread(target=self._work, daemon=True)

    def __enter__(self) -> Self:
        """Begin to sleep."""
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        """Wake up for good."""
        self._over.set()
        self._thread.join()

    def _work(self) -> None:
        while not self._over.is_set():
            began = time.monotonic()
            time.sleep(NAP)
            self.most = max(self.most, time.monotonic() - began - NAP)


def work_time() -> float:
    """Return how long the machine takes for a piece of work, by the clock: the median. [s]"""
    return statistics.median(_timed() for _ in range(TIMES))


def _timed() -> float:
    began = time.perf_counter()
    total = 0
    for k in range(ROUNDS):
        total += k * k
    return time.perf_counter() - began
