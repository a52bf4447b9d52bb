# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""A node of a test's own in the robot's namespace, and nodes of this source tree as processes."""

from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
import ctypes
import math
import os
from pathlib import Path
import re
import signal
import subprocess
import sys
import time
from typing import Any, Self

from lta_config.topics import load_topic_table
from lta_graph.health import HealthFact, HealthLevel
from lta_graph.ros.message_validation import find_message_type
from lta_graph.ros.qos import select_profile, select_reader_profile
from rcl_interfaces.srv import SetParameters
import rclpy
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.parameter import Parameter
from signals import heed_signals
from std_srvs.srv import SetBool
from time_report import process_started
from waiting import PATIENCE, wait_until

ROOT = Path(__file__).resolve().parents[2]
TABLE = load_topic_table()
LIBC = ctypes.CDLL(None)  # before any fork
PR_SET_PDEATHSIG = 1  # linux/prctl.h
# What a bridge answers where the machine, and not the drone, was too slow: another try may do.
HELD_UP = re.compile(r'the Crazyflie has|no packets from|the newest (command|place)')
LOGGED = re.compile(r'\[(INFO|WARN|ERROR)\] \[')
AGAIN = 0.5  # s between two requests to arm
STARTED: 'list[subprocess.Popen[str]]' = []


def start(module: str, *words: object, before: str = '') -> 'subprocess.Popen[str]':
    """Start a node of this very source tree: its module, its ROS arguments, code before it."""
    code = f'{before}from {module} import main; main()'
    process = _start(code, words)
    STARTED.append(process)
    process_started()
    return process


@contextmanager
def running(module: str, *words: object) -> 'Iterator[subprocess.Popen[str]]':
    """Run a node until the context ends, which may be after a test, unless it exits before."""
    process = start(module, *words)
    STARTED.remove(process)
    try:
        yield process
    finally:
        if process.poll() is None:
            process.send_signal(signal.SIGINT)
            process.communicate(timeout=PATIENCE)
        process.stderr.close()


def _start(code: str, words: tuple[object, ...]) -> 'subprocess.Popen[str]':
    paths = [str(path.parent) for path in ROOT.glob('src/*/setup.py')]
    return subprocess.Popen(
        [sys.executable, '-c', code, '--ros-args', '-r', '__ns:=/lta1', *map(str, words)],
        env={
            **os.environ,
            'PYTHONPATH': os.pathsep.join([*paths, str(ROOT / 'config'), *sys.path]),
        },
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=_end_with_us,
    )


def _end_with_us() -> None:
    """Let the kernel kill a node whose test is killed: it would stay in its domain for ever."""
    heed_signals()
    LIBC.prctl(PR_SET_PDEATHSIG, signal.SIGKILL)


def complaints(errors: str) -> list[str]:
    """Return what a node has printed but for its log, in which the faults of a test belong."""
    return [line for line in errors.splitlines() if not LOGGED.match(line)]


def ended(process: 'subprocess.Popen[str]') -> None:
    """Press Ctrl-C on a node: it exits in order, and prints nothing but its log."""
    process.send_signal(signal.SIGINT)
    _, errors = process.communicate(timeout=PATIENCE)
    assert (process.returncode, complaints(errors)) == (0, [])


def put_away() -> None:
    """End what a failed test has left: an open pipe would fail whichever test comes next."""
    while STARTED:
        process = STARTED.pop()
        if process.poll() is None:
            process.kill()
            process.communicate()
        process.stderr.close()


def _place_of(condition: Callable[[], Any]) -> str:
    code = getattr(condition, '__code__', None)
    if code is None:
        return repr(condition)
    return f'the condition in {Path(code.co_filename).name}, line {code.co_firstlineno}'


class Peer:
    """A node beside those under test, in a DDS domain: `with Peer(domain) as peer: ...`."""

    def __init__(self, domain_id: int, *, lockstep: bool = False) -> None:
        self._context = Context()
        rclpy.init(args=[], context=self._context, domain_id=domain_id)
        self.node = rclpy.create_node('peer', namespace='/lta1', context=self._context)
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self.node)
        self._publishers: dict[str, Any] = {}
        self._clients: dict[str, Any] = {}
        self._beside: list[Any] = []
        self._lockstep = lockstep
        self.heard: Counter[str] = Counter()  # messages by topic
        self.facts: dict[str, HealthFact] = {}  # newest by 'NODE: TASK', after `hear_facts`

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._executor.shutdown()
        for node in self._beside:
            node.destroy_node()
        self.node.destroy_node()
        self._context.try_shutdown()

    def beside(self, name: str = 'beside') -> Any:
        """Return a node of this robot that nobody spins."""
        self._beside.append(rclpy.create_node(name, namespace='/lta1', context=self._context))
        return self._beside[-1]

    def until(self, condition: Callable[[], Any], patience: float = PATIENCE) -> Any:
        """Take what comes until something holds, and return that; `patience`: [s]."""
        return wait_until(
            condition,
            _place_of(condition),
            lambda: sorted(self.heard.items()),
            step=lambda: self._executor.spin_once(timeout_sec=0.02),
            patience=patience,
        )

    def hear(self, name: str, callback: Callable[[Any], object]) -> None:
        """Listen to a topic of the table."""
        row = TABLE[name]
        quality = select_reader_profile(row, self._lockstep)

        def take(message: Any) -> None:
            self.heard[name] += 1
            callback(message)

        self.node.create_subscription(find_message_type(row), name, take, quality)

    def hear_facts(self) -> None:
        """Listen to what the nodes say of their health."""
        self.hear('/diagnostics', self._take_facts)

    def _take_facts(self, array: Any) -> None:
        for status in array.status:
            name = status.name.rpartition('/')[2]
            values = {pair.key: pair.value for pair in status.values}
            level = HealthLevel(status.level[0])
            self.facts[name] = HealthFact(name, level, status.message, values)

    def told(self, task: str) -> str:
        """Return the newest words of a task; empty before the first."""
        return self.facts[task].message if task in self.facts else ''

    def publisher(self, name: str) -> Any:
        """Return the publisher of a topic of the table, once somebody has found it."""
        if name not in self._publishers:
            row = TABLE[name]
            quality = select_profile(row, self._lockstep)
            self._publishers[name] = self.offering(name, find_message_type(row), quality)
        return self._publishers[name]

    def offering(self, name: str, kind: Any, quality: Any) -> Any:
        """Return a new publisher of any type and quality, once somebody has found it."""
        made = self.node.create_publisher(kind, name, quality)
        self.until(made.get_subscription_count)
        return made

    def ask(self, kind: Any, name: str, **fields: object) -> Any:
        """Call a service and return its answer."""
        if name not in self._clients:
            self._clients[name] = self.node.create_client(kind, name)
        client = self._clients[name]
        self.until(client.service_is_ready)
        future = client.call_async(kind.Request(**fields))
        self.until(future.done)
        return future.result()

    def arm(self) -> None:
        """Arm, and ask again, as a person would, while a slow machine has not heard the drone."""

        def told() -> bool:
            answer = self.ask(SetBool, 'crazyflie_bridge/arm', data=True)
            assert answer.success or HELD_UP.search(answer.message), answer.message
            return bool(answer.success)

        self.until(told)

    def arm_until(self, done: Callable[[], bool]) -> None:
        """Arm again whenever a busy machine was too slow for the bridge, which then comes down."""
        asked = -math.inf

        def flown() -> bool:
            nonlocal asked
            if not done() and time.monotonic() - asked >= AGAIN:
                self.arm()
                asked = time.monotonic()
            return done()

        # A drone that comes down begins its flight again, which takes half a minute
        self.until(flown, 3.0 * PATIENCE)

    def set(self, node: str, name: str, value: object) -> Any:
        """Set a parameter and return what the node said to it."""
        parameter = Parameter(name, value=value).to_parameter_msg()
        return self.ask(SetParameters, f'{node}/set_parameters', parameters=[parameter]).results[0]
