# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""What the integration tests share: the command, a scene, and an ear in their domain."""

from collections.abc import Callable, Iterator
from pathlib import Path

from lta_config.errors import BadInput
from lta_graph.health import HealthFact
from lta_graph.ros.listener import DiagnosticsListener
from lta_report.browser import Browser
import pytest
from waiting import wait_until

from .command import Lta, ROOT
from .peer import put_away
from .ros_checkouts import CHECKOUTS, install, WITHOUT


@pytest.fixture(autouse=True)
def nothing_left() -> Iterator[None]:
    """Put away the nodes of a test that failed."""
    yield
    put_away()


@pytest.fixture(scope='session')
def genuine_ros(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    """Return the variables by which a process finds ros2cli and launch of a genuine ROS 2."""
    if not CHECKOUTS:
        pytest.skip(WITHOUT)
    return install(tmp_path_factory.mktemp('ros'))


@pytest.fixture(scope='session')
def chromium() -> Iterator[Browser]:
    """Return the one browser: to start it takes seconds."""
    try:
        session = Browser()
    except BadInput as reason:
        pytest.skip(str(reason))
    with session:
        yield session


@pytest.fixture(scope='module')
def browser(chromium: Browser) -> Iterator[Browser]:
    """Return the browser to look at pages with; the last one does not play on."""
    yield chromium
    chromium.call('Page.navigate', url='about:blank')


@pytest.fixture
def lta(domain_id: int) -> Iterator[Lta]:
    """Return the command; the test fails if any of its processes outlives it."""
    command = Lta()
    yield command
    try:
        assert command.left() == []
    finally:
        command.kill()


@pytest.fixture
def scenario(tmp_path: Path):
    """Return a function that writes the shipped scene with another goal and returns its path."""

    def write(radius: str = '1.0 m', time_limit: str = '60 s', walls: str = 'open') -> Path:
        text = (ROOT / 'config/scenarios/lamp_room.yaml').read_text()
        changed = text.replace('radius: 1.0 m', f'radius: {radius}')
        changed = changed.replace('time_limit: 60 s', f'time_limit: {time_limit}')
        changed = changed.replace('walls: open', f'walls: {walls}')
        path = tmp_path / f'{radius}-{time_limit}.yaml'.replace(' ', '')
        path.write_text(changed)
        return path

    return write


@pytest.fixture
def diagnostics(domain_id: int) -> Iterator[DiagnosticsListener]:
    """Return a listener in this test's domain."""
    with DiagnosticsListener() as listener:
        yield listener


@pytest.fixture
def hear(diagnostics: DiagnosticsListener, lta: Lta):
    """Return a function that listens until a condition on all facts holds."""

    def wait(condition: Callable[[dict[str, HealthFact]], object]) -> None:
        def arrived() -> str:
            heard = {name: fact.message for name, fact in diagnostics.facts.items()}
            return f'{heard}; said:\n{lta.text}'

        wait_until(
            lambda: condition(diagnostics.facts),
            'facts in /diagnostics',
            arrived,
            step=lambda: diagnostics.poll(0.02),
        )

    return wait


@pytest.fixture
def flying(hear):
    """Return a function that waits until the simulator says that it has flown for a while [s]."""

    def wait(seconds: float) -> None:
        def far(facts: dict[str, HealthFact]) -> bool:
            fact = facts.get('simulator: flight')
            return fact is not None and float(fact.values['time_s']) >= seconds

        hear(far)

    return wait
