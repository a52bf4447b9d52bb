# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""A running graph as a viewer without ROS sees it, and a flight that loses its viewer."""

from contextlib import closing
import json
import os
from pathlib import Path
import re
import signal

import foxglove
from lta_bag.reader import read_bag
from lta_bag.schemas import load_jazzy_types
from lta_bridge.live.server import LiveServer
from lta_config.files import share_folder
from lta_config.topics import load_topic_table, robot_topic
from ports import free_port
import pytest
from rosbags.typesys import get_types_from_msg
from waiting import wait_until

from .contents import contents
from .viewer import Viewer

TABLE = load_topic_table()
TOPICS = {robot_topic('lta1', name) for name in TABLE.topics}
ABSENT = ('teleop', 'tracker')
SILENT = {f'/lta1/{name}' for name, row in TABLE.topics.items() if row.source in ABSENT}
ONCE = ('/lta1/robot_description', '/lta1/scene', '/tf_static')  # a late viewer gets them, too
GAPS = '/lta1/energy/status'  # whose gaps between numbers the recorder writes as zeros
# Without a stamp each dates a message by what else it has heard; /diagnostics are any node's.
UNDATED = {'/diagnostics'} | {
    name if name.startswith('/') else f'/lta1/{name}'
    for name, row in TABLE.topics.items()
    if not row.stamped
}
JAZZY = load_jazzy_types()


@pytest.fixture
def port():
    """Return a port that nobody listens on."""
    return free_port()


def listening(port):
    """Return the addresses that a port is listened on, as the kernel writes them."""
    found = set()
    for table in ('tcp', 'tcp6'):
        path = Path('/proc/net') / table
        for line in path.read_text().splitlines()[1:] if path.exists() else []:
            address, state = line.split()[1], line.split()[3]
            host, _, number = address.partition(':')
            if state == '0A' and int(number, 16) == port:
                found.add(host)
    return found


def seen(viewer, name):
    """Return log times and decoded messages of one topic, by rosbags."""
    row = TABLE[name]
    topic = name if name.startswith('/') else f'/lta1/{name}'
    return [
        (when, JAZZY.deserialize_cdr(data, row.type))
        for when, data in viewer.messages.get(topic, [])
    ]


@pytest.mark.long
def test_a_viewer_sees_the_flight_that_is_recorded(lta, scenario, tmp_path, port, hear):
    out, scene = tmp_path / 'out', scenario(time_limit='5 s')
    words = ('--live', '--live-port', port, '--scenario', scene, '--no-page', '--json')
    flight = lta.start('fly', *words, '--out', out)
    with closing(Viewer(port)) as viewer:
        look(viewer, port, hear)
    assert flight.end() == 3  # five seconds are too few to reach the lamp
    assert '"outcome": "timeout"' in flight.text
    assert f'ds.url=ws://localhost:{port} ' in flight.text
    (layout,) = [line.split()[1] for line in flight.text.splitlines() if line[:6] == 'Layout']
    assert 'configById' in json.loads(Path(layout).read_text())
    compare(viewer, read_bag(out / 'bag'))


def look(viewer, port, hear):
    """Look on to the end of a flight: at all that is shown, and for what is refused."""
    viewer.until(lambda: viewer.channels.keys() >= TOPICS)
    assert viewer.protocol == 'foxglove.sdk.v1'
    assert (viewer.info['name'], viewer.info['capabilities']) == ('LTA lta1', ['time'])
    assert viewer.channels.keys() == TOPICS
    for name, row in TABLE.topics.items():
        told = viewer.channels[robot_topic('lta1', name)]
        assert (told['encoding'], told['schemaEncoding']) == ('cdr', 'ros2msg')
        assert told['schemaName'] == row.type
        read = get_types_from_msg(told['schema'], row.type)
        assert read[row.type] == JAZZY.fielddefs[row.type]
    assert listening(port) == {'0100007F'}  # 127.0.0.1 and nothing else

    viewer.subscribe()
    channel = {'id': 1, 'topic': '/lta1/motors', 'encoding': 'cdr', 'schemaName': 'x'}
    viewer.send({'op': 'advertise', 'channels': [channel]})
    viewer.send({'op': 'setParameters', 'parameters': [{'name': 'armed', 'value': False}]})
    viewer.until(lambda: len(viewer.statuses) >= 2)
    refusals = sorted(str(status['message']) for status in viewer.statuses)
    assert 'clientPublish' in refusals[0]
    assert 'parameters' in refusals[1]
    viewer.until(lambda: len(viewer.messages.get('/lta1/odom', [])) > 20)
    hear(lambda facts: 'live: view' in facts and facts['live: view'].message == '1 viewer')
    viewer.to_the_end()


def compare(viewer, bag):
    """Hold what a viewer was sent against what was recorded."""
    recorded = {}
    for topic, when, data in bag.iterate_messages():
        recorded.setdefault(topic, set()).add((when, data))
    for topic in TOPICS - {GAPS} - UNDATED - SILENT:
        assert viewer.messages[topic], topic
        strange = set(viewer.messages[topic]) - recorded[topic]
        # Of a short queue a slow recorder may miss some
        short = TABLE[topic.removeprefix('/lta1/')].qos == 'sensor'
        assert len(strange) <= (0.1 * len(viewer.messages[topic]) if short else 0), topic
    truth = dict(recorded['/lta1/odom'])
    odom = seen(viewer, 'odom')
    assert len(odom) > 20
    for when, message in odom:
        kept = bag.decode('/lta1/odom', truth[when])
        for field in ('position', 'orientation'):
            for axis in 'xyz':
                got = getattr(getattr(message.pose.pose, field), axis)
                assert got == getattr(getattr(kept.pose.pose, field), axis)
        assert message.twist.twist.linear.x == kept.twist.twist.linear.x
    for messages in viewer.messages.values():
        times = [when for when, _ in messages]
        assert times == sorted(times)
    assert viewer.times == sorted(viewer.times)
    ticks = {data for _, data in viewer.messages['/clock']}
    assert len(ticks - {data for _, data in recorded['/clock']}) <= 0.1 * len(ticks)
    for topic in ONCE:
        was, got = ({data for _, data in by[topic]} for by in (recorded, viewer.messages))
        assert got == was
    figures_are_told(viewer)


def figures_are_told(viewer):
    """Every figure of a diagnostic array that the layouts plot is one that a flight tells."""
    told = set()
    kind = 'diagnostic_msgs/msg/DiagnosticArray'
    arrays = [name for name, row in TABLE.topics.items() if row.type == kind]
    for name in arrays:
        for _, message in seen(viewer, name):
            for status in message.status:
                told |= {(name, status.name, item.key) for item in status.values}
    layout = (share_folder() / 'foxglove/lta.json').read_text().replace('\\"', '"')
    path = re.compile(r'"(/diagnostics)\.status.*{name=="(.*)"}\.values\[:]{key=="(.*)"}')
    wanted = set(path.findall(layout))
    assert wanted
    assert wanted <= told


def test_a_viewer_that_takes_nothing_keeps_no_other_from_seeing(port):
    schema = foxglove.Schema(name='std_msgs/msg/String', encoding='ros2msg', data=b'string data')
    server = LiveServer('test', '127.0.0.1', port, {'/block': ('cdr', schema)})
    with closing(Viewer(port)) as sleeper, closing(Viewer(port)) as viewer:
        for each in (sleeper, viewer):
            each.until(lambda each=each: each.channels)
            each.subscribe()

        def tell() -> None:
            server.broadcast_time(1)
            viewer.until(lambda: viewer.times)
            viewer.times.clear()

        wait_until(lambda: server.audience.viewer_count == 2, 'both viewers', step=tell)
        assert server.audience.has_new_viewer('/block')
        assert not server.audience.has_new_viewer('/block')
        for k in range(2000):  # 32 MB: more than any socket holds
            server.send_message('/block', bytes(16_000), k)
        server.send_message('/block', b'the end', 2000)
        viewer.until(lambda: viewer.messages.get('/block', [(0, b'')])[-1] == (2000, b'the end'))
    server.close()


def repeatable(path):
    """Return what every topic of a whole bag holds that repeats itself."""
    assert read_bag(path).is_complete
    return {
        topic: messages for topic, messages in contents(path).items() if topic.startswith('/lta1/')
    }


@pytest.mark.long
def test_a_view_that_hangs_and_dies_changes_no_value_of_a_flight(
    lta, scenario, flying, tmp_path, port
):
    out, alone, scene = tmp_path / 'out', tmp_path / 'alone', scenario(time_limit='14 s')
    words = ('--live', '--live-port', port, '--time', 'lockstep', '--scenario', scene)
    flight = lta.start('fly', *words, '--no-page', '--out', out)
    with closing(Viewer(port)) as viewer:
        viewer.until(lambda: '/lta1/motors' in viewer.channels)
        viewer.subscribe('/lta1/motors')
        viewer.until(lambda: viewer.messages)  # it hears the flight
        pid = flight.node('live')
        os.kill(pid, signal.SIGSTOP)
        flying(10.0)  # past a reader that takes nothing
        os.kill(pid, signal.SIGKILL)
    flight.said('live was killed by SIGKILL; the flight continues.')
    assert flight.end() == 3  # not there yet
    # On a busy machine somebody else may be late.
    named = [
        line for line in flight.text.splitlines() if line.startswith('No messages arrive from')
    ]
    assert not any('live' in line for line in named)
    assert lta.run('simulate', '--bag', '--scenario', scene, '--out', alone).returncode == 3
    assert repeatable(out / 'bag') == repeatable(alone / 'bag')
