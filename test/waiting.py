# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Wait for an event in a test: generously, and with words for what did not come."""

from collections.abc import Callable
import time
from typing import TypeVar

from time_report import spent

Found = TypeVar('Found')
PATIENCE = 300.0  # s of wall time: what takes milliseconds, on a machine that others use as well
EVERY = 0.01  # s


def wait_until(
    condition: Callable[[], Found],
    awaited: str,
    arrived: Callable[[], object] | None = None,
    step: Callable[[], object] = lambda: time.sleep(EVERY),
    patience: float = PATIENCE,
) -> Found:
    """
    Return what a condition returns, once that is true.

    Parameters
    ----------
    condition : callable
        Asked again and again.
    awaited : str
        What is waited for, in words.
    arrived : callable, optional
        What came instead: its result is in the message of the failure.
    step : callable, optional
        What lets events come between two questions; by default, sleep for a moment.
    patience : float, optional
        Wall time to wait for at most [s].

    Raises
    ------
    AssertionError
        If it has not come in time.

    """
    deadline = time.monotonic() + patience
    with spent():
        while not (found := condition()):
            if time.monotonic() > deadline:
                instead = '' if arrived is None else f'; what had arrived: {arrived()}'
                raise AssertionError(f'waited {patience:.0f} s for {awaited}{instead}')
            step()
    return found
