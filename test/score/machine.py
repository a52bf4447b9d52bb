"""How late the machine wakes who sleeps: what tells its own delays from those of a program."""

import threading
import time
from typing import Final, final, Self

NAP: Final = 0.01  # s


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
