# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The recorder in a graph of strangers: nonsense, other qualities of service, wishes."""

from collections.abc import Iterator
from pathlib import Path
import signal
import subprocess

from lta_bag.reader import read_bag
from lta_graph.ros.message_validation import find_message_type
from lta_graph.ros.stamps import to_stamp
import pytest
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.serialization import serialize_message
from std_msgs.msg import Bool, String
from std_srvs.srv import SetBool
from waiting import PATIENCE
import yaml

from .peer import complaints, Peer, start, TABLE

ROW = TABLE['odom']
START = TABLE.start_ns
NO_VERSIONS = 'from lta_bag import provenance; provenance.version = lambda name: "0"; '
LATCHED = QoSProfile(depth=3, durability=DurabilityPolicy.TRANSIENT_LOCAL)
BEST_EFFORT = QoSProfile(depth=5, reliability=ReliabilityPolicy.BEST_EFFORT)


class Recording(Peer):
    """A recorder of its own process, and a node beside it."""

    def __init__(self, folder: Path, domain_id: int) -> None:
        super().__init__(domain_id)
        self.bag = folder / 'bag'
        self._process = None

    def start(self, **parameters: object) -> None:
        given = {'bag': self.bag, **parameters}
        words = [word for name, value in given.items() for word in ('-p', f'{name}:={value}')]
        self._process = start('lta_bridge.nodes.recorder', *words, before=NO_VERSIONS)

    def end(self):
        """Press Ctrl-C; return the exit status and what was said."""
        self.interrupt()
        return self.wait()

    def interrupt(self):
        """Press Ctrl-C."""
        self._process.send_signal(signal.SIGINT)

    def wait(self, patience=PATIENCE):
        """Wait for the end."""
        _, errors = self._process.communicate(timeout=patience)
        return self._process.returncode, '\n'.join(complaints(errors))

    def __exit__(self, *error: object) -> None:
        if self._process is not None and self._process.poll() is None:
            self._process.kill()
            self._process.communicate()
        super().__exit__(*error)


@pytest.fixture
def recording(domain_id: int, tmp_path: Path) -> Iterator[Recording]:
    with Recording(tmp_path, domain_id) as found:
        yield found


def odom(stamp_ns):
    message = find_message_type(ROW)()
    message.header.stamp = to_stamp(stamp_ns)
    return message


def heard(folder, topic):
    """Return log times of a topic in a bag that may still be growing."""
    return [when for _, when, _ in read_bag(folder).iterate_messages([topic])]


def arrived(folder, topic, count):
    """Tell whether so many messages of a topic are on the disk."""
    try:
        return len(heard(folder, topic)) >= count
    except ValueError:  # no such bag or topic yet
        return False


def described(bag):
    """Return what metadata.yaml tells of each topic."""
    told = yaml.safe_load((bag / 'metadata.yaml').read_text())['rosbag2_bagfile_information']
    rows = told['topics_with_message_count']
    return {row['topic_metadata']['name']: row['topic_metadata'] for row in rows}


def facts(folder, task):
    """Return the recorder's own words in its bag: message and figures, one for each time."""
    bag = read_bag(folder)
    return [
        (status.message, {item.key: item.value for item in status.values})
        for topic, _, data in bag.iterate_messages(['/diagnostics'])
        for status in bag.decode(topic, data).status
        if status.name.rpartition('/')[2] == f'recorder: {task}'
    ]


@pytest.mark.parametrize('twice', [False, True])
def test_it_stays_while_a_real_drone_comes_down_unless_told_twice(recording, twice):
    """The bridge leaves last; what it says on the way down belongs into the bag."""
    recording.start(source='crazyflie')
    bridge = recording.publisher('imu')

    def feel(count):
        def told():  # again: the first ones may find no reader yet
            message = find_message_type(TABLE['imu'])()
            message.header.stamp = recording.node.get_clock().now().to_msg()
            bridge.publish(message)
            return arrived(recording.bag, '/lta1/imu', count)

        recording.until(told)

    feel(1)
    recording.interrupt()
    with pytest.raises(subprocess.TimeoutExpired):
        recording.wait(1.0)  # three times as long as nobody may say anything
    before = len(heard(recording.bag, '/lta1/imu'))
    feel(before + 1)
    if twice:
        recording.interrupt()
    else:
        recording.node.destroy_publisher(bridge)
    assert recording.wait() == (0, '')
    assert len(heard(recording.bag, '/lta1/imu')) > before
    assert read_bag(recording.bag).is_complete


def test_nonsense_is_recorded_counted_and_dates_nothing(recording):
    recording.start()
    publisher = recording.publisher('odom')
    first, second = START, START + ROW.period_ns
    publisher.publish(odom(first))
    publisher.publish(odom(2_000_000_000 * 10**9))
    publisher.publish(serialize_message(odom(first))[:8])
    publisher.publish(odom(second))
    kind = find_message_type(TABLE['energy/status'])
    status = recording.offering('energy/status', kind, 10)
    torn = serialize_message(kind())[:20]
    status.publish(torn)
    recording.until(lambda: arrived(recording.bag, '/lta1/odom', 4))
    recording.until(lambda: arrived(recording.bag, '/lta1/energy/status', 1))
    assert recording.end() == (0, '')
    kept = [data for *_, data in read_bag(recording.bag).iterate_messages(['/lta1/energy/status'])]
    assert kept == [torn]
    assert heard(recording.bag, '/lta1/odom') == [first, first, first, second]
    _, figures = facts(recording.bag, 'recording')[-1]
    assert figures['odom with a wild stamp'] == figures['odom cut short'] == '1'


def test_everything_is_found_as_its_publishers_offer_it(recording):
    make = recording.node.create_publisher
    early = make(String, 'map', LATCHED)
    early.publish(String(data='before the recorder was there'))
    make(SetBool.Event, 'strange', 10)
    recording.start(topics='all')
    weak = recording.offering(
        'odom', find_message_type(ROW), BEST_EFFORT
    )  # the table says reliable
    late = recording.offering('late', Bool, BEST_EFFORT)
    recording.offering('late', Bool, LATCHED)
    other = make(Bool, '/lta2/late', 10)
    for step in range(3):
        weak.publish(odom(START + step * ROW.period_ns))
        late.publish(Bool(data=True))
        other.publish(Bool(data=True))
    for name, count in (('odom', 3), ('late', 3), ('map', 1)):
        recording.until(lambda name=name, n=count: arrived(recording.bag, f'/lta1/{name}', n))
    recording.node.destroy_publisher(weak)  # what it offered is told all the same
    heard_of = len(heard(recording.bag, '/diagnostics'))
    recording.until(lambda: arrived(recording.bag, '/diagnostics', heard_of + 4))
    assert recording.end() == (0, '')

    told = described(recording.bag)
    assert {'/rosout', '/parameter_events', '/lta1/imu', '/lta1/map'} <= set(told)
    assert not {'/lta1/strange', '/lta2/late'} & set(told)
    offered = {
        name: (profiles[0]['reliability'], profiles[0]['durability'])
        for name, row in told.items()
        for profiles in [row['offered_qos_profiles']]
    }
    assert offered['/lta1/map'] == ('reliable', 'transient_local')
    assert offered['/lta1/odom'] == ('best_effort', 'volatile')
    late_profiles = told['/lta1/late']['offered_qos_profiles']
    assert {each['durability'] for each in late_profiles} == {'volatile', 'transient_local'}
    assert 'messages of /lta1/late from before the start' in facts(recording.bag, 'latched')[-1][0]
    assert offered['/lta1/motors'] == ('reliable', 'volatile')  # nobody is there: the table's
    bag = read_bag(recording.bag)
    (latched,) = [
        bag.decode(topic, data) for topic, _, data in bag.iterate_messages(['/lta1/map'])
    ]
    assert latched.data == 'before the recorder was there'
    words, named = facts(recording.bag, 'left out')[-1]
    assert 'common interfaces' in words
    assert named == {'/lta1/strange': 'std_srvs/srv/SetBool_Event'}
