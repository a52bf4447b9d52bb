# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Recordings played into real nodes over DDS: the same answers, with gaps too, and by hand."""

from collections.abc import Iterator
import json
import os
from pathlib import Path
import subprocess

from lta_bag.metadata import build_offered_qos
from lta_bag.reader import read_bag
from lta_bag.writer import BagWriter
from lta_bridge.log_time_assigner import read_stamp
from lta_flight.flight_spec import load_spec
from lta_flight.progress import FlightProgress
from lta_flight.simulate import simulate_once
from lta_graph.ros.message_validation import find_message_type
from lta_graph.ros.qos import select_profile
from lta_graph.ros.stamps import from_stamp
import pytest
from rich.console import Console
from stamped_bytes import shift_stamp
from std_srvs.srv import SetBool, Trigger
from waiting import PATIENCE

from .contents import check_one_clock
from .peer import Peer, ROOT, TABLE

LAMP = ROOT / 'test/replay/lamp.mcap'
NODES = 'estimator,controller,demodulator,navigator,energy_monitor'
LATER = 1_700_000_000 * 10**9  # ns: as a clock on the wall would stamp
QOS = [build_offered_qos('reliable', 'volatile', 10)]


@pytest.fixture(scope='module')
def recorded(tmp_path_factory):
    """Return the bag of a short flight of this very machine and version."""
    out = tmp_path_factory.mktemp('recorded') / 'flight'
    spec = load_spec('gtmab', 'lamp_room', 'bag', 'gtmab')
    spec = spec.with_values({'scenario.goal.time_limit': '4 s'})
    return simulate_once(spec, 2, out, FlightProgress(Console(quiet=True)))[0].bag


def copied(bag, folder, keep, later=0, strange=0):
    """Write a bag again without some messages, with later stamps and a block that is none."""
    source = read_bag(bag)
    with BagWriter(folder, source.provenance) as writer:
        for name, topic in source.topics.items():
            writer.add_topic(name, topic.type_name, QOS)
        numbers = dict.fromkeys(source.topics, 0)
        for name, log_time, data in source.iterate_messages():
            numbers[name] += 1
            if keep(name.removeprefix('/lta1/'), numbers[name]):
                row = TABLE[name.removeprefix('/lta1/')]
                moved = shift_stamp(data, later) if row.stamped else data
                moved = moved.replace(b'16UC1', b'32FC1') if numbers[name] == strange else moved
                writer.write(name, moved, log_time + later)
    return folder


def test_every_node_answers_its_own_recording_to_the_last_bit(lta, call, recorded, tmp_path):
    done = lta.run(
        'replay', recorded, '--nodes', NODES, '--against', '--json', '--out', tmp_path / 'replay'
    )
    assert done.returncode == 0, done.stderr
    said = json.loads(done.stdout)
    assert (said['verdict'], said['whole'], said['elsewhere']) == ('identical', True, [])
    whole = read_bag(recorded)
    answered = [name for name, topic in TABLE.topics.items() if topic.answers]
    assert {name: told['compared'] for name, told in said['topics'].items()} == {
        name: whole.topics[f'/lta1/{name}'].count for name in answered
    }
    assert all(told['only_replayed'] == 0 for told in said['topics'].values())
    again = read_bag(Path(said['bag']))
    assert again.provenance['replay_of'] == str(recorded)
    check_one_clock(call, said['bag'])
    # The answers are logged when the flight's own were, those without a stamp as well.
    for name in answered:
        times = [
            [t for _, t, _ in bag.iterate_messages([f'/lta1/{name}'])] for bag in (whole, again)
        ]
        assert sorted(times[0]) == sorted(times[1]), name
    assert 'Identical to the last bit' in Path(said['page']).read_text(encoding='utf-8')


@pytest.mark.long
def test_a_changed_window_is_shown_and_fails(lta, tmp_path):
    """On the stored recording, which another machine may have made."""
    words = ['--nodes', 'demodulator', '--against', '--json', '--out', tmp_path / 'replay']
    done = lta.run('replay', LAMP, *words, '--set', 'demodulator.window=4', '--end', '3')
    assert done.returncode == 1, done.stderr
    said = json.loads(done.stdout)
    assert said['verdict'] == 'different'
    assert said['changes'] == ['demodulator.window = 4']
    peaks = said['topics']['light/peaks']
    assert peaks['differing'] == peaks['compared'] > 20
    assert {each['path'][:3] for each in peaks['channels']} == {'snr'}
    assert said['decisions']['lamp seen']['changed'] == 0


@pytest.mark.long
def test_a_graph_flies_through_gaps_of_a_recording_from_another_age(lta, recorded, tmp_path):
    """
    Every third range lost, a second of IMU and its beginning, the first light, and all panel.

    A light block of a kind that the demodulator refuses is answered too, and so is light that
    comes before any odometry: whoever waits for an answer must get one.
    """

    def keep(name, number):
        gap = name == 'imu' and (number <= 70 or 150 <= number < 250)
        dark = name == 'photodiodes' and number <= 5
        return not (gap or dark or name == 'panel' or (name == 'range' and number % 3 == 0))

    bag = copied(recorded, tmp_path / 'gaps', keep, later=LATER, strange=9)
    words = ['source:=replay', f'replay:={bag}', 'time:=lockstep', f'bag:={tmp_path / "again"}']
    done = lta.run('launch', 'fly', *words)
    assert done.returncode == 0, done.stderr + done.stdout
    line = next(x for x in done.stdout.splitlines() if x.startswith('[player] {'))
    said = json.loads(line.removeprefix('[player] '))
    assert (said['outcome'], said['unanswered']) == ('played', '0')
    played, again = read_bag(bag), read_bag(tmp_path / 'again')
    for name, topic in TABLE.topics.items():
        if topic.answers:
            triggers = f'/lta1/{topic.answers}'
            expected = again.topics[triggers].count
            assert again.topics[f'/lta1/{name}'].count == expected, name
            if topic.answers in ('imu', 'photodiodes', 'battery'):
                assert expected == played.topics[triggers].count
    sent = [{d for _, _, d in bag.iterate_messages(['/lta1/imu'])} for bag in (played, again)]
    assert sent[0] == sent[1]


class Controller(Peer):
    """A peer that hears the meters and stands in for a controller."""

    def __init__(self, domain_id: int) -> None:
        super().__init__(domain_id)
        self.stamps: list[tuple[str, int]] = []
        for name in ('battery', 'panel'):
            self.listen(name)
        row = TABLE['motors']
        self._motors = self.node.create_publisher(
            find_message_type(row), 'motors', select_profile(row, lockstep=False)
        )

    def listen(self, name):
        self.hear(name, lambda m: self.stamps.append((name, from_stamp(m.header.stamp))))


@pytest.fixture
def peer(domain_id: int) -> Iterator[Controller]:
    with Controller(domain_id) as made:
        yield made


@pytest.fixture
def player(tmp_path):
    """Return a function that starts a player alone; it ends with the test."""
    started = []

    def start(bag: Path, **parameters: object) -> 'subprocess.Popen[str]':
        rules = {'bag': bag, 'nodes': 'controller', **parameters}
        words = [word for name, value in rules.items() for word in ('-p', f'{name}:={value}')]
        process = subprocess.Popen(
            [
                ROOT / 'lta',
                'run',
                'lta_bridge',
                'player',
                '--ros-args',
                '-r',
                '__ns:=/lta1',
                *words,
            ],
            env=dict(os.environ),
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        started.append(process)
        return process

    yield start
    for process in started:
        process.kill()
        process.communicate()


@pytest.fixture
def meters(recorded, tmp_path):
    """Return a bag of five batteries every 100 ms and a panel 50 ms behind each."""
    source = read_bag(recorded)
    with BagWriter(tmp_path / 'meters', {}) as writer:
        for name, late in (('battery', 0), ('panel', 50_000_000)):
            writer.add_topic(f'/lta1/{name}', TABLE[name].type, QOS)
            found = [data for _, _, data in source.iterate_messages([f'/lta1/{name}'])][:5]
            for data in (shift_stamp(item, late) for item in found):
                writer.write(f'/lta1/{name}', data, read_stamp(data))
    return tmp_path / 'meters'


def test_a_service_is_called_with_its_value_or_refused_in_a_sentence(peer, lta):
    peer.node.create_service(Trigger, 'begin', lambda _, answer: answer)
    peer.node.create_service(SetBool, 'arm', lambda _, answer: answer)
    for words, sentence in (
        (('begin', 'true'), "'/lta1/begin' takes no value after its name"),
        (('arm',), "'/lta1/arm' needs a value after its name: true or false"),
        (('nobody/there',), 'available: /lta1/arm, /lta1/begin'),
    ):
        wrong = lta.run('call', *words)
        assert wrong.returncode == 2
        assert sentence in wrong.stderr
        assert wrong.stderr.count('\n') == 1


def test_a_player_at_a_high_rate_comes_to_its_end(meters, peer, player):
    process = player(meters, rate=100.0, start=0.1, end=0.3)
    peer.until(lambda: process.poll() is not None)
    out, errors = process.communicate(timeout=PATIENCE)
    assert process.returncode == 0, errors
    said = json.loads(out.splitlines()[-1])
    assert (said['outcome'], said['messages'], said['time_s']) == ('played', '5', '0.200')


@pytest.mark.long
def test_a_node_that_does_not_answer_ends_the_replay_and_is_named(recorded, peer, player):
    """The peer stands in for the controller, and never sends any duties."""
    for name in TABLE.read_by('controller'):
        peer.listen(name)
    rules = {'roles': 'estimator navigator', 'time': 'lockstep', 'patience': 4.0}
    process = player(recorded, **rules)
    peer.until(lambda: process.poll() is not None)
    out, errors = process.communicate(timeout=PATIENCE)
    assert process.returncode == 1, errors
    assert 'did not arrive within 4 s: motors from controller.' in errors
    said = json.loads(out.splitlines()[-1])
    assert (said['outcome'], said['answers'], said['owed']) == ('unanswered', '0', '402')
