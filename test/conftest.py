# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
What all tests share: markers by folder, the order, a DDS domain each, nothing left behind.

A test in `test/unit` is marked `unit`, and so on; one elsewhere that starts processes is marked
`integration` by its own file. An integration test has a ROS_DOMAIN_ID that no other test on this
machine has, in whatever process it runs.
"""

from collections.abc import Callable, Iterator
import gc
import os
from pathlib import Path
import sys
from typing import Any
from zlib import crc32

# Before numpy is imported: more threads only take the cores from the processes under test.
os.environ.update(OPENBLAS_NUM_THREADS='1', OMP_NUM_THREADS='1', MKL_NUM_THREADS='1')
sys.path.append(str(Path(__file__).parent))

from domain import free_domain
from hypothesis import HealthCheck, settings
import left_behind
import pytest
from time_report import TimeReport

ROOT = Path(__file__).resolve().parents[1]
Called = Callable[..., tuple[int, Any]]
MARKED = ('unit', 'property', 'contract', 'integration')

# Tests of cores run without a built workspace as well.
sys.path += [str(path.parent) for path in sorted(ROOT.glob('src/*/setup.py'))]
sys.path += [str(ROOT / 'config'), str(ROOT)]

# No time counts: a test must pass while other programs use all cores.
settings.register_profile(
    'lta', deadline=None, derandomize=True, suppress_health_check=[HealthCheck.too_slow]
)
settings.load_profile('lta')


def pytest_configure(config: pytest.Config) -> None:
    config.pluginmanager.register(TimeReport())
    # rclpy's message classes import a parser that imports modules Python has renamed.
    config.addinivalue_line('filterwarnings', "ignore:module 'sre_:DeprecationWarning")


def pytest_addoption(parser: pytest.Parser) -> None:
    words = 'of the long tests alone those of this quarter'
    parser.addoption('--quarter', type=int, choices=range(4), help=words)


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    if (quarter := config.getoption('quarter')) is not None:
        # By name, so that a test stays in its quarter whatever is added beside it
        mine = [item for item in items if item.get_closest_marker('long')
                and crc32(item.nodeid.encode()) % 4 == quarter]  # fmt: skip
        config.hook.pytest_deselected(items=[item for item in items if item not in mine])
        items[:] = mine
    for item in items:
        folder = item.path.relative_to(ROOT / 'test').parts[0]
        if folder in MARKED:
            item.add_marker(folder)
    items[:] = mixed(items)


def pytest_collection_finish() -> None:
    # Imported modules stay alive: exclude them from every later pass of the garbage collector.
    gc.freeze()


def mixed(items: list[pytest.Item]) -> list[pytest.Item]:
    """
    Return the files that start processes, and so mostly wait, evenly among those that compute.

    Side by side the latter then have the cores that the former leave.
    """
    place: dict[Path, float] = {}
    for waits in (True, False):
        paths = [
            item.path for item in items if waits == bool(item.get_closest_marker('integration'))
        ]
        files = list(dict.fromkeys(paths))
        place |= {path: k / len(files) for k, path in enumerate(files)}
    return sorted(items, key=lambda item: place[item.path])


@pytest.fixture(scope='module', autouse=True)
def as_found() -> Iterator[None]:
    """Hold a file of tests to leave the process as it was: the next one may be any other."""
    before = left_behind.state()
    yield
    changed = left_behind.changes(before, left_behind.state())
    assert not changed, f'patched, and not put back: {", ".join(changed)}'


@pytest.fixture
def call(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Called:
    """
    Return a function that calls `lta` in this process: its status, and what it said.

    A process of its own costs a second of imports each time.
    """
    from lta_cli import app

    def call(*words: object, columns: int = 120) -> tuple[int, Any]:
        monkeypatch.setenv('COLUMNS', str(columns))
        monkeypatch.setattr(sys, 'argv', ['lta', *map(str, words)])
        return app.run_command_line(), capsys.readouterr()

    return call


@pytest.fixture(autouse=True)
def domain_id(request: pytest.FixtureRequest) -> Iterator[int]:
    """Set a ROS_DOMAIN_ID that is this test's alone (0 where no graph is started)."""
    if not request.node.get_closest_marker('integration'):
        yield 0
        return
    with free_domain() as domain:
        yield domain
