# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""All nodes in one process: the same values, one node each for ROS, and every way to its end."""

from contextlib import ExitStack
import os
from pathlib import Path
import signal
import time

from lta_bag.reader import read_bag
from lta_config.files import share_folder
from lta_config.topics import load_topic_table, robot_topic
from lta_data.bag.recorded_flight import open_flight
from lta_graph.reach import PROFILE_VARIABLE
from lta_graph.ros.one_process import deliver_in_memory
import numpy as np
import pytest
from std_srvs.srv import SetBool

from .command import ALL_NODES, processes
from .contents import check_one_clock, contents
from .peer import Peer

TABLE = load_topic_table()
REPEATABLE = [
    robot_topic('lta1', name) for name, topic in TABLE.topics.items() if topic.repeatable
]
# A strategy that fails on its way: at the first light after a while
BROKEN = """
from lta_control.strategies.protocol import NavigationStrategy, SteeringCommand

def start(heading):
    return (0.0,)

def steer(settings, memory, sight):
    assert memory[0] < 20.0, 'enough of it'
    return SteeringCommand(0.0, 0.0, False), (memory[0] + 1.0,)

STRATEGY = NavigationStrategy('broken', start, steer)
"""


def test_a_flight_in_one_process_is_that_of_the_loop(lta, call, scenario, tmp_path):
    """In every value, as the graph of many processes is (test_flight.py)."""
    room = scenario(time_limit='3 s')
    words = ('--seed', '7', '--scenario', room, '--out')
    done = lta.run('fly', '--no-page', '--processes', 'one', *words, tmp_path / 'fly')
    assert done.returncode == 3, done.stderr  # out of time
    assert 'Traceback' not in done.stderr
    status, said = call('simulate', *words, tmp_path / 'simulate')
    assert status == 3, said.err
    graph, loop = (contents(tmp_path / name / 'bag') for name in ('fly', 'simulate'))
    for each in (graph, loop):  # by the description and by the simulator, in either order
        each['/tf_static'].sort()
    for topic in REPEATABLE:
        assert graph[topic] == loop[topic] != [], topic
    for name in ('fly', 'simulate'):
        check_one_clock(call, tmp_path / name / 'bag')


def test_a_shared_process_is_a_graph_for_others_and_ends_by_ctrl_c(
    lta, domain_id, flying, scenario, tmp_path
):
    """Nodes, topics, parameters and services from outside; then the bag is closed."""
    room = scenario(radius='0.01 m', time_limit='600 s')
    words = (f'scenario:={room}', f'bag:={tmp_path / "bag"}', 'processes:=one')
    launch = lta.start('launch', 'fly', *words)
    flying(0.5)
    running = [line for line in processes(lta.mark).values() if 'one_process' in line]
    assert len(running) == 1
    with Peer(domain_id) as peer:
        stamps = []
        peer.hear(
            'odom', lambda odom: stamps.append((odom.header.stamp.sec, odom.header.stamp.nanosec))
        )
        peer.until(lambda: len(stamps) > 20)
        # Once each, in their order
        assert stamps == sorted(set(stamps))
        assert set(peer.node.get_node_names()) >= ALL_NODES
        assert peer.set('controller', 'hold_after', 0.7).successful
        assert peer.ask(SetBool, 'arm', data=False).message == 'disarmed'
        assert not peer.set('estimator', 'vehicle', 'skye').successful
    launch.interrupt()
    assert launch.end() == 130
    assert 'Traceback' not in launch.text
    assert read_bag(tmp_path / 'bag').is_complete


def test_what_is_caught_up_after_a_pause_reaches_every_node(lta, flying, scenario, tmp_path):
    """In real time: of more readings at once than a queue of sensors holds, none is lost."""
    room = scenario(radius='0.01 m', time_limit='600 s')
    words = (f'scenario:={room}', f'bag:={tmp_path / "bag"}', 'processes:=one')
    launch = lta.start('launch', 'fly', *words, 'time:=realtime')
    flying(2.0)
    (number,) = [n for n, line in processes(lta.mark).items() if 'one_process' in line]
    os.kill(number, signal.SIGSTOP)
    time.sleep(0.3)  # the pause itself: 30 readings of the inertial unit
    os.kill(number, signal.SIGCONT)
    flying(3.0)
    launch.interrupt()
    assert launch.end() == 130
    flight = open_flight(tmp_path / 'bag', 'lta1')
    read, answered = (flight[name]['stamp_ns'].to_numpy() for name in ('imu', 'odom'))
    within = (read >= answered[0]) & (read <= answered[-1])
    assert np.array_equal(read[within], answered)


@pytest.mark.parametrize('processes', ['many', 'one'])
def test_the_clock_of_every_node_changes_in_flight(
    lta, domain_id, flying, scenario, tmp_path, processes
):
    """Which adds and destroys subscriptions, and ends neither a node nor the flight."""
    room = scenario(radius='0.01 m', time_limit='600 s')
    words = (f'scenario:={room}', f'bag:={tmp_path / "bag"}', f'processes:={processes}')
    launch = lta.start('launch', 'fly', *words)
    flying(0.5)
    with Peer(domain_id) as peer:
        odoms, ticks = [], []
        peer.hear('odom', odoms.append)
        peer.hear('/clock', ticks.append)
        for value in (False, True):
            for node in sorted(ALL_NODES):
                assert peer.set(node, 'use_sim_time', value).successful, node
                assert not peer.set(node, 'use_sim_time', 1.0).successful, node
            odoms.clear()
            ticks.clear()
            peer.until(lambda: len(odoms) > 20 and len(ticks) > 2)
        assert set(peer.node.get_node_names()) >= ALL_NODES
    launch.interrupt()
    assert launch.end() == 130
    assert 'Traceback' not in launch.text
    assert read_bag(tmp_path / 'bag').is_complete


def test_a_node_that_breaks_ends_the_shared_process_and_is_named(lta, tmp_path):
    strategy = tmp_path / 'broken.py'
    strategy.write_text(BROKEN)
    words = (f'strategy:={strategy}', 'time:=lockstep', f'bag:={tmp_path / "bag"}')
    done = lta.run('launch', 'fly', *words, 'processes:=one')
    assert done.returncode == 2  # a strategy is an input
    assert 'enough of it' in done.stdout + done.stderr
    health = open_flight(tmp_path / 'bag')['/diagnostics']
    assert any('enough of it' in str(text) for text in health.to_numpy().ravel())


def test_our_profile_of_fast_dds_delivers_in_memory_and_that_of_a_user_stays(tmp_path):
    ours = share_folder() / 'fastdds' / 'this_machine.xml'
    own = tmp_path / 'own.xml'
    own.write_text(ours.read_text())
    with ExitStack() as teardown:
        changed = {PROFILE_VARIABLE: str(ours)}
        deliver_in_memory(changed, teardown)
        copy = Path(changed[PROFILE_VARIABLE])
        assert copy.read_text() == ours.read_text().replace('>OFF<', '>FULL<')
        assert copy.name == ours.name  # by which a node knows that nobody else reaches it
        for environment in ({PROFILE_VARIABLE: str(own)}, {PROFILE_VARIABLE: 'nowhere.xml'}, {}):
            before = dict(environment)
            deliver_in_memory(environment, teardown)
            assert environment == before
    assert not copy.exists()
