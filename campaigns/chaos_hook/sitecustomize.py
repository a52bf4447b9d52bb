# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
What no signal of the kernel can do to a node, done by one of ours: Python loads this by itself.

Nothing in the product knows of it: a trial puts this folder on the PYTHONPATH of what it starts.
"""

import signal
import time

EXCEPTION = signal.SIGUSR2
MEMORY = signal.SIGRTMIN + 2
SLOW_DISK = signal.SIGRTMIN + 1
MOUTHFUL = 1 << 18  # bytes
EATEN: list[bytes] = []
STALL = 3.0  # s that one write to a slow disk takes


def _raise(*_: object) -> None:
    raise RuntimeError('injected by a trial')


def _eat(*_: object) -> None:
    while True:
        EATEN.append(bytes(MOUTHFUL))


def _slow(*_: object) -> None:
    from lta_bag.writer import BagWriter

    write, stalls = BagWriter.write, [STALL]

    def slowly(*words: object) -> object:
        if stalls:
            time.sleep(stalls.pop())
        return write(*words)

    BagWriter.write = slowly


signal.signal(EXCEPTION, _raise)
signal.signal(MEMORY, _eat)
signal.signal(SLOW_DISK, _slow)
