# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Every node in this process, and on every topic that it hears what cannot be meant.

Good messages and spoilt ones go by turns straight into the callbacks of a node's subscriptions,
whose list is the node's own and held against the topic table. Whatever comes, nothing is raised,
what is published can be sent and holds no duty beyond 1, and /diagnostics tells that it came.
"""

from array import array
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from copy import deepcopy
from functools import partial
import gc
import math
from typing import Any

from campaigns.chaos_spoilt import over_fields, spoil, SPOILT
from lta_bridge.nodes.crazyflie_bridge import CrazyflieBridge
from lta_bridge.nodes.live import LiveViewNode
from lta_bridge.nodes.teleop import Teleop
from lta_control.nodes.controller import Controller
from lta_control.nodes.estimator import Estimator
from lta_control.nodes.navigator import Navigator
from lta_energy.nodes.energy_monitor import EnergyMonitor
from lta_graph.health import HealthFact, HealthLevel
from lta_graph.ros.message_validation import find_fault
from lta_graph.ros.node import GraphNode
from lta_sim.nodes.simulator import Simulator
from lta_vlc.nodes.demodulator import Demodulator
import numpy as np
from ports import free_port, UDP
import pytest
import rclpy
from rclpy.publisher import Publisher
from rclpy.serialization import serialize_message

from .good_messages import good
from .peer import TABLE

NODES: dict[str, type[GraphNode]] = {
    'estimator': Estimator,
    'controller': Controller,
    'navigator': Navigator,
    'demodulator': Demodulator,
    'energy_monitor': EnergyMonitor,
    'simulator': Simulator,
    'crazyflie_bridge': CrazyflieBridge,
    'teleop': Teleop,
    'live': LiveViewNode,
}
BESIDE = {  # topics that a node hears as they come, beside what the table says that it answers
    'estimator': ['tracker/odom'],
    'controller': ['teleop/held', 'teleop/pose', 'teleop/velocity'],
    'crazyflie_bridge': ['/diagnostics', 'ground_truth/odom', 'odom', 'setpoint/pose',
                         'setpoint/velocity', 'teleop/held', 'teleop/pose', 'teleop/velocity'],
    'teleop': ['/diagnostics', 'odom'],
    'live': sorted(TABLE.topics),
}  # fmt: skip
# A command or a state that cannot be meant ends their flight: each topic has a node of its own.
FLOWN = ('controller', 'simulator', 'crazyflie_bridge')
BEGUN = 250  # control periods until all fly: the estimator learns for two seconds
STRUCK = 10  # control periods with a spoilt message
CURED = 30  # without
NAMED = ('motors', 'light/peaks', 'photodiodes')  # topics whose names anybody reads
SPOILS = {  # what ends a flight comes last
    **{kind: partial(spoil, kind) for kind in sorted(SPOILT, key=lambda kind: kind == 'nan')},
    'infinite': lambda message: over_fields(deepcopy(message), of_all(math.inf)),
    'huge': lambda message: over_fields(deepcopy(message), of_all(1e30)),
}


def of_all(number: float) -> Callable[[Any], Any]:
    """Return what puts a number in the place of each real one."""

    def change(value: Any) -> Any:
        if isinstance(value, float):
            return number
        if isinstance(value, array) and value.typecode in 'fd':
            return array(value.typecode, [number] * len(value))
        if isinstance(value, np.ndarray) and value.dtype.kind == 'f':
            return np.full_like(value, number)
        return value

    return change


class Trial:
    """A node that hears one message after another, and what it says."""

    def __init__(self, node: GraphNode) -> None:
        self.node, self.now = node, TABLE.start_ns
        self.said: dict[str, list[Any]] = {}
        self.ears = {item.topic_name.removeprefix('/lta1/'): item for item in node.subscriptions}

    def says(self, publisher: Publisher, message: Any) -> None:
        """Keep what the node publishes, which must be fit to be sent."""
        assert serialize_message(message)
        name = publisher.topic_name.removeprefix('/lta1/')
        self.said.setdefault(name, []).append(message)

    def hear(self, name: str, message: Any) -> None:
        """Let the node hear a message."""
        self.ears[name].callback(serialize_message(message))
        assert self.node.fault is None, self.node.fault

    def hear_cut(self, name: str) -> None:
        """Let the node hear data that end within a message."""
        data = serialize_message(good(name, self.now))
        self.ears[name].callback(data[:-8])
        assert self.node.fault is None, self.node.fault

    def live(self, periods: int) -> None:
        """Go on for some control periods, in which all that is due comes, and comes well."""
        for _ in range(periods):
            self.now += TABLE.control_ns
            for name in self.ears:
                row = TABLE.topics.get(name)
                if row is None or not row.period_ns:
                    continue
                if TABLE.count_due(name, self.now, 0) > TABLE.count_due(name, self.now, 1):
                    self.hear(name, good(name, self.now))

    def strike(self, name: str, spoils: Callable[[Any], Any]) -> None:
        """Let spoilt messages of a topic come between the good ones."""
        for _ in range(STRUCK):
            self.live(1)
            self.hear(name, spoils(good(name, self.now)))

    @property
    def faults(self) -> dict[str, HealthFact]:
        """Return what the node tells in /diagnostics of what is not well."""
        self.node._monitor_inputs()
        self.node.publish_health()
        told = self.said['/diagnostics'][-1].status
        return {
            each.name.rpartition('/')[2]: (each.message, *(item.value for item in each.values))
            for each in told
            if each.level > bytes([HealthLevel.OK]) and not each.name.endswith(': inputs')
        }

    @property
    def duties(self) -> list[float]:
        """Return all duties that the node gave out, and those that it flies."""
        given = [duty for message in self.said.get('motors', ()) for duty in message.duty]
        flown = self.node.drones[''].duties if isinstance(self.node, Simulator) else ()
        return [*given, *flown]


@pytest.fixture
def trial(role: str, domain_id: int, monkeypatch) -> Iterator[Trial]:
    """Return a node in flight, in this process."""
    words = ['--ros-args', '-r', '__ns:=/lta1', *words_of(role)]
    made: list[Trial] = []
    # What the node before left in cycles keeps its participant open, which discovers this one's
    gc.collect()
    with ExitStack() as after:
        after.callback(rclpy.try_shutdown)
        rclpy.init(args=['node', *words], domain_id=domain_id)
        monkeypatch.setattr(
            Publisher,
            'publish',
            lambda own, message: made[0].says(own, message) if made else None,
        )
        node = NODES[role]()
        after.callback(node.destroy_node)
        after.callback(node.close)
        after.callback(made.clear)
        made.append(Trial(node))
        made[0].live(BEGUN)
        yield made[0]


def words_of(role: str) -> list[str]:
    """Return a node's parameters: nothing that others on this machine may have."""
    words = {
        'controller': 'armed:=true',
        'crazyflie_bridge': f'uri:=udp://127.0.0.1:{free_port(UDP)}',
        'live': f'port:={free_port()}',
    }
    return ['-p', words[role]] if role in words else []


def is_told(name: str, kind: str, message: Any) -> bool:
    """Tell whether a spoilt message differs from a good one in what anybody reads."""
    if name == '/diagnostics' or (kind == 'names' and name not in NAMED):
        return False  # of many nodes, each of its own make; frames
    if kind in ('stale', 'future', 'empty') and not TABLE[name].period_ns:
        return False  # a person's word, which has no rhythm: its age counts, once they steer
    if kind == 'empty' and not TABLE[name].stamped:
        return False  # False and 0 are words
    if (name, kind) == ('range', 'infinite'):
        return False  # nothing in reach
    if name == 'energy/status' and kind in ('nan', 'infinite', 'huge', 'lengths'):
        return False  # NaN is unknown, and people read the numbers; nodes read the first level
    # Their bytes may differ in the padding alone; as fields, no NaN equals another.
    return repr(SPOILS[kind](message)) != repr(message)


def heard_by(role: str) -> list[str]:
    """Return the topics of the table that a node hears."""
    plays = 'vehicle' if role in ('simulator', 'crazyflie_bridge') else role
    return sorted({*BESIDE.get(role, []), *TABLE.read_by(plays)})


@pytest.mark.parametrize(
    ('role', 'names'),
    [
        *((role, (name,)) for role in FLOWN for name in heard_by(role)),
        *((role, tuple(heard_by(role))) for role in NODES if role not in FLOWN),
    ],
)
def test_a_node_hears_all_that_cannot_be_meant_and_goes_on(role, names, trial):
    for name in names:
        trial.hear(name, good(name, trial.now))
        assert any(trial.duties) == (role in ('controller', 'simulator'))
        for kind, spoils in SPOILS.items():
            before = trial.faults
            trial.strike(name, spoils)
            if role != 'live' and is_told(name, kind, good(name, trial.now)):
                assert trial.faults != before, f'{kind} of {name} is not told'
            trial.live(CURED)
        before = trial.faults
        trial.hear_cut(name)
        assert trial.faults != before or role == 'live', f'cut data of {name} are not told'
    assert all(-1.0 <= duty <= 1.0 for duty in trial.duties)
    for topic, messages in trial.said.items():  # nothing of it stays
        assert find_fault(messages[-1]) == '', topic


@pytest.mark.parametrize('role', NODES)
def test_no_other_topic_is_heard(role, trial):
    beside = {'joy'} if role == 'teleop' else set()
    assert set(trial.ears) == {*heard_by(role), *beside}
