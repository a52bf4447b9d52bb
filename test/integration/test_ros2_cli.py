# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
A running graph under the genuine ros2cli: what an engineer with ROS 2 types, and what it answers.

Without a folder of checkouts (ros_checkouts.py) nothing is run. `ros2 bag` is not among them:
rosbag2 is C++ and no checkout of Python; rosbags reads the bag in its place.
"""

from collections.abc import Iterator
from contextlib import contextmanager
import os
from pathlib import Path
import re
import shutil
import subprocess
from xml.etree import ElementTree

from bench_body import BenchBody
from domain import free_domain
from lta_config.topics import load_topic_table
from lta_emulation.crazyflie.firmware import Firmware
from lta_emulation.crazyflie.server import CrazyflieServer
from lta_graph.launches import FLY
import pytest
from rosbags.highlevel import AnyReader
from waiting import PATIENCE, wait_until
import yaml

from .command import ALL_NODES, Lta, ROOT, Started
from .ros_checkouts import CHECKOUTS, WITHOUT

pytestmark = [
    pytest.mark.long,
    pytest.mark.skipif(not CHECKOUTS, reason=WITHOUT),
]
TABLE = load_topic_table()


@pytest.fixture(scope='module')
def domain_id() -> Iterator[int]:
    """Return one domain for all tests of this module, which share a flight."""
    with free_domain() as domain:
        yield domain


class Ros:
    """The command ros2 in one domain, and what it started."""

    def __init__(self, environment: dict[str, str]) -> None:
        self.lta = Lta()
        self.environment = environment

    def run(self, *words: object) -> str:
        """Run a command to its end, and return what it said."""
        done = subprocess.run(
            ['ros2', *map(str, words)],
            env={**os.environ, **self.environment},
            capture_output=True,
            text=True,
            timeout=PATIENCE,
            check=False,
        )
        assert done.returncode == 0, done.stdout + done.stderr
        return done.stdout or done.stderr

    def wait(self, text: str, *words: object) -> str:
        """Run a command until its output has a text: discovery takes a moment."""
        said = ''

        def found() -> bool:
            nonlocal said
            said = self.run(*words)
            return re.search(text, said) is not None

        wait_until(found, repr(text), lambda: f'{said}\n{self.lta.text}')
        return said

    def start(self, *words: object) -> Started:
        """Start a command that goes on until Ctrl-C."""
        return self.lta.start(*words, program=('ros2',), **self.environment)

    @contextmanager
    def running(self, *words: object) -> Iterator[Started]:
        """Run a command for as long as the context lasts."""
        started = self.start(*words)
        try:
            yield started
        finally:
            started.interrupt()
            started.end()


@pytest.fixture(scope='module')
def ros(genuine_ros, domain_id) -> Iterator[Ros]:
    made = Ros(genuine_ros)
    made.run('daemon', 'start')
    yield made
    made.run('daemon', 'stop')
    made.lta.kill()


@pytest.fixture(scope='module')
def bag(tmp_path_factory) -> Path:
    return tmp_path_factory.mktemp('flight') / 'bag'


@pytest.fixture(scope='module')
def flight(ros, bag) -> Started:
    """Launch a flight in real time that goes on for as long as the tests take."""
    text = (ROOT / 'config/scenarios/lamp_room.yaml').read_text()
    room = bag.with_name('room.yaml')
    room.write_text(
        text.replace('radius: 1.0 m', 'radius: 0.01 m')
        .replace('limit: 60 s', 'limit: 3600 s')
        .replace('walls: open', 'walls: solid')
    )
    words = (f'bag:={bag}', f'scenario:={room}')
    launch = ros.start('launch', 'lta_bringup', 'fly.launch.py', *words)
    for name in ALL_NODES:
        ros.wait(f'/lta1/{name}\n', 'node', 'list')
    ros.run('topic', 'echo', '--once', '/lta1/odom', TABLE['odom'].type)
    return launch


def test_launch_shows_the_arguments(ros):
    said = ros.run('launch', 'lta_bringup', 'fly.launch.py', '--show-args')
    names = {argument.name for argument in FLY.list_arguments()}
    assert {line.strip()[1:-2] for line in said.splitlines() if line.endswith("':")} == names


def test_node(ros, flight):
    assert set(ros.run('node', 'list').split()) == {f'/lta1/{name}' for name in ALL_NODES}
    subscribed, published = ros.run('node', 'info', '/lta1/navigator').split('Publishers:')
    for name in TABLE.read_by('navigator'):
        assert f'/lta1/{name}: {TABLE[name].type}\n' in subscribed
    for name in TABLE.published_by('navigator'):
        assert f'/lta1/{name}: {TABLE[name].type}\n' in published


def test_topic_list_and_type(ros, flight):
    listed = dict(re.findall(r'^(\S+) \[(\S+)\]$', ros.run('topic', 'list', '-t'), re.MULTILINE))
    ours = {name.removeprefix('/lta1/'): kind for name, kind in listed.items()}
    for name, topic in TABLE.topics.items():
        if name in ours:
            assert ours[name] == topic.type
    for name in ('imu', 'motors', 'photodiodes', 'odom', 'light/peaks', 'energy/status'):
        assert name in ours
    assert listed['/tf'] == 'tf2_msgs/msg/TFMessage'


def test_topic_hz_echo_and_info(ros, flight):
    with ros.running('topic', 'hz', '/lta1/imu') as hz:
        hz.said('average rate')  # how fast is a question of the machine
    kind = TABLE.topics['motors'].type
    echo = ros.run('topic', 'echo', '--once', '--no-lost-messages', '/lta1/motors', kind)
    message = yaml.safe_load(echo.partition('---')[0])
    assert message['header']['stamp']['sec'] >= 0
    said = ros.run('topic', 'info', '-v', '/lta1/motors')
    assert f'Type: {kind}' in said
    assert 'Node name: controller' in said
    assert 'Reliability: RELIABLE' in said


def test_param(ros, flight):
    node = '/lta1/navigator'
    names = ros.run('param', 'list', node).split()
    assert {'altitude', 'strategy', 'use_sim_time'} <= set(names)
    assert ros.run('param', 'get', node, 'strategy') == 'String value is: homing\n'
    before = float(ros.run('param', 'get', node, 'altitude').split()[-1])
    assert 'successful' in ros.run('param', 'set', node, 'altitude', before + 0.25)
    assert ros.run('param', 'get', node, 'altitude').split()[-1] == str(before + 0.25)
    assert 'failed: Parameter altitude out' in ros.run('param', 'set', node, 'altitude', -1.0)
    assert 'Type: double' in ros.run('param', 'describe', node, 'altitude')
    dumped = yaml.safe_load(ros.run('param', 'dump', node))
    assert dumped[node]['ros__parameters']['altitude'] == before + 0.25


def test_service(ros, flight, bag):
    listed = dict(re.findall(r'^(\S+) \[(\S+)\]$', ros.run('service', 'list', '-t'), re.MULTILINE))
    assert listed['/lta1/emergency_stop'] == 'std_srvs/srv/Trigger'
    assert ros.run('service', 'type', '/lta1/arm').strip() == 'std_srvs/srv/SetBool'
    said = ros.run('service', 'call', '/lta1/arm', 'std_srvs/srv/SetBool', '{data: true}')
    assert 'success=True' in said
    assert 'armed' in said


def test_action(ros, flight):
    """Each action of the graph has a server, of the type that the list says."""
    listed = re.findall(r'^(\S+) \[(\S+)\]$', ros.run('action', 'list', '-t'), re.MULTILINE)
    for name, kind in listed:
        said = ros.run('action', 'info', '-t', name)
        assert 'Action servers: 1' in said
        assert kind in said


def test_a_remap_moves_topics_a_namespace_and_the_name_of_a_node(ros):
    words = ('-r', '__ns:=/eye', '-r', '__node:=light', '-r', 'photodiodes:=/elsewhere/adc')
    with ros.running('run', 'lta_vlc', 'demodulator', '--ros-args', *words):
        ros.wait('/eye/light\n', 'node', 'list')
        said = ros.wait('/elsewhere/adc: ', 'node', 'info', '/eye/light')
        assert '/eye/light/peaks: ' in said
        assert '/eye/photodiodes' not in said


def test_lifecycle(ros):
    name = '/real/crazyflie_bridge'
    with CrazyflieServer(Firmware(BenchBody(), drift=30e-6)) as drone:
        words = ('--ros-args', '-r', '__ns:=/real', '-p', f'uri:={drone.uri}')
        with ros.running('run', 'lta_bridge', 'crazyflie_bridge', *words):
            ros.wait(name, 'lifecycle', 'nodes')
            ros.wait(r'active \[3\]', 'lifecycle', 'get', name)
            assert '- deactivate [4]' in ros.run('lifecycle', 'list', name)
            assert 'successful' in ros.run('lifecycle', 'set', name, 'deactivate')
            ros.wait(r'inactive \[2\]', 'lifecycle', 'get', name)


def test_ctrl_c_ends_the_flight_and_its_bag_is_read_by_others(ros, flight, bag):
    flight.interrupt()
    assert flight.end() in {0, 1}, flight.text
    assert ros.lta.left() == []
    with AnyReader([bag]) as reader:
        counts = {connection.topic: connection.msgcount for connection in reader.connections}
        assert counts['/lta1/imu'] > 100
        assert sum(1 for _ in reader.messages()) == sum(counts.values())
    metadata = yaml.safe_load((bag / 'metadata.yaml').read_text())['rosbag2_bagfile_information']
    assert metadata['storage_identifier'] == 'mcap'


def test_two_drones_have_a_namespace_each(ros, tmp_path):
    with ros.running('launch', 'lta_bringup', 'fleet.launch.py', f'bag:={tmp_path / "bag"}'):
        for robot in ('lta1', 'lta2'):
            ros.wait(f'/{robot}/controller\n', 'node', 'list')


def test_the_commands_of_the_page(ros, tmp_path):
    """Each is one of these, with a bag of its own; those that go on say what they are for."""
    page = (ROOT / 'docs/workspace.md').read_text(encoding='utf-8')
    launch, hz, run = [line.split()[1:] for line in re.findall(r'^ros2 .*$', page, re.MULTILINE)]
    assert [launch[0], hz[:2], run[0]] == ['launch', ['topic', 'hz'], 'run']
    with ros.running(*launch, f'bag:={tmp_path / "bag"}'):
        with ros.running(*hz) as rate:
            rate.said('average rate')
        assert 'reached' in ros.run(*run, '--no-bag')
    assert (tmp_path / 'bag/metadata.yaml').exists()


def test_make_ros2_installs_the_command(tmp_path, domain_id):
    for name in ('.venv', 'config', 'install', 'tools'):
        (tmp_path / name).symlink_to(ROOT / name)
    command = shutil.copy(ROOT / 'ros2', tmp_path)
    place = Path(CHECKOUTS).resolve().as_uri()
    subprocess.run([tmp_path / 'tools/ros2cli.sh', place], check=True)
    environment = {**os.environ, 'ROS_DOMAIN_ID': str(domain_id)}

    def run(*words):
        return subprocess.run(
            (command, *words), capture_output=True, text=True, env=environment, check=True
        ).stdout

    assert '/rosout' in run('topic', 'list', '--no-daemon').split()
    assert "'scenario':" in run('launch', 'lta_bringup', 'fly.launch.py', '--show-args')


@pytest.mark.skipif(
    not (Path(CHECKOUTS) / 'rosdistro').is_dir(), reason='no checkout of ros/rosdistro'
)
def test_every_key_has_one_rule_of_rosdep():
    ours = yaml.safe_load((ROOT / 'tools/rosdep.yaml').read_text())
    theirs: dict[str, object] = {}
    for name in ('base', 'python'):
        text = (Path(CHECKOUTS) / f'rosdistro/rosdep/{name}.yaml').read_text()
        theirs |= yaml.load(text, Loader=getattr(yaml, 'CSafeLoader', yaml.SafeLoader))
    assert not ours.keys() & theirs.keys()
    keys = {
        element.text
        for path in [ROOT / 'config/package.xml', *ROOT.glob('src/*/package.xml')]
        for element in ElementTree.parse(path).iter()
        if element.tag in {'exec_depend', 'test_depend'} and '-' in str(element.text)
    }
    assert keys <= ours.keys() | theirs.keys()
    for key in keys - ours.keys():
        assert 'ubuntu' in theirs[key], key
