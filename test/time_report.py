# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Print after the tests which were slowest, and what share of the time went into what.

Compiling kernels is measured by a numba event listener, waiting for events by the context manager
`spent`. The first wait after `process_started` counts as the start of that process: it covers its
imports and DDS discovery. Each pytest-xdist worker sends its sums to the process that prints.
"""

from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
import time
from typing import Any

from numba.core import event
import pytest

SLOWEST = 20
COMPILING, STARTING, WAITING = 'compiling kernels', 'starting processes', 'waiting for events'
SPENT: Counter[str] = Counter()  # s, in this process
_ACTIVE: list[str] = []
_STARTED: list[bool] = []  # one entry per process started since the last wait


def process_started() -> None:
    """Count the next wait as the start of a process."""
    _STARTED.append(True)


@contextmanager
def spent() -> Iterator[None]:
    """Measure a wait; a nested one is part of the outer one."""
    if _ACTIVE:
        yield
        return
    kind = STARTING if _STARTED else WAITING
    _STARTED.clear()
    _ACTIVE.append(kind)
    begin = time.perf_counter()
    try:
        yield
    finally:
        _ACTIVE.pop()
        SPENT[kind] += time.perf_counter() - begin


class _Compiling(event.Listener):
    """Count what numba compiles; one function compiles those that it calls."""

    def __init__(self) -> None:
        self._begun: list[float] = []

    def on_start(self, event: event.Event) -> None:
        self._begun.append(time.perf_counter())

    def on_end(self, event: event.Event) -> None:
        begun = self._begun.pop()
        if not self._begun:
            SPENT[COMPILING] += time.perf_counter() - begun


class TimeReport:
    """The plugin: `config.pluginmanager.register(TimeReport())`."""

    def __init__(self) -> None:
        self._tests: Counter[str] = Counter()  # s by test: set-up, call and tear-down together
        self._spent: Counter[str] = Counter()
        event.register('numba:compile', _Compiling())

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        self._tests[report.nodeid] += report.duration

    def pytest_sessionfinish(self, session: pytest.Session) -> None:
        output = getattr(session.config, 'workeroutput', None)
        if output is not None:
            output['spent'] = dict(SPENT)

    @pytest.hookimpl(optionalhook=True)
    def pytest_testnodedown(self, node: Any) -> None:
        self._spent.update(getattr(node, 'workeroutput', {}).get('spent', {}))

    def pytest_terminal_summary(self, terminalreporter: 'pytest.TerminalReporter') -> None:
        total = self._tests.total()
        if len(self._tests) <= SLOWEST:
            return
        terminalreporter.section(f'where {total:.0f} s of tests went')
        for kind, seconds in (self._spent + SPENT).most_common():
            terminalreporter.write_line(f'{seconds / total:5.0%} {kind}')
        terminalreporter.write_line(f'The {SLOWEST} slowest, with what they set up first:')
        for name, seconds in self._tests.most_common(SLOWEST):
            terminalreporter.write_line(f'{seconds:5.1f} s {name}')
