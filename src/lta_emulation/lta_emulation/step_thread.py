# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The thread of a device that is emulated: it repeats a step until the device is switched off."""

from collections.abc import Callable
import threading
from typing import final


@final
class StepThread:
    """
    A daemon thread that repeats a step.

    `step`: returns within milliseconds, so that `stop` does not take longer.
    """

    def __init__(self, step: Callable[[], object], name: str) -> None:
        self._step, self._over = step, threading.Event()
        self._thread = threading.Thread(target=self._run, name=name, daemon=True)

    def start(self) -> None:
        """Begin."""
        self._thread.start()

    def stop(self) -> None:
        """End after the present step, if it has begun; a second call does nothing."""
        self._over.set()
        if self._thread.is_alive():
            self._thread.join()

    def _run(self) -> None:
        while not self._over.is_set():
            self._step()
