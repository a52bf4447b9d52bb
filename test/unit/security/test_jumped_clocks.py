# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Recordings whose clock was set: no command takes memory or time for what lies between."""

from lta_bag import BagWriter
from lta_bag.reader import read_bag
from lta_flight.flight_spec import load_spec
from lta_flight.progress import FlightProgress
from lta_flight.simulate import simulate_once
import pytest
from rich.console import Console
from stamped_bytes import shift_stamp

from .sandbox import MEMORY

DAY = 86_400 * 10**9  # ns
POSES = ('/lta1/ground_truth/odom', '/lta1/odom')
# Which topics jump after their message 300, and by how much [ns]
JUMPS = {
    'an hour': (POSES, DAY // 24),
    'a year': (POSES, 365 * DAY),
    'back by a day': (POSES, -DAY),
    'all by a month': (('/lta1/',), 30 * DAY),
    'the IMU by a year': (('/lta1/imu',), 365 * DAY),
    'the commands by a year': (('/lta1/motors',), 365 * DAY),
}
# Commands that need the time between, and those that work without it
REFUSING = (
    ('report', '--out', 'done'),
    ('compare', '--out', 'done', '--no-page', 'sound'),
    ('bag', 'export', '--out', 'done', '--rate', '100'),
    ('vehicle', 'trim'),
)
COMMANDS = ('simulate', '--scenario', 'lamp_room', '--out', 'done', '--commands')
READING = (
    ('bag', 'check'),
    ('bag', 'info'),
    ('bag', 'plot'),
    ('bag', 'export', '--out', 'done'),
    ('compare', '--out', 'done', '--no-page', '--align', 'none', 'sound'),
)


@pytest.fixture(scope='module')
def sound(tmp_path_factory):
    """Return the bag of a flight of 6 s."""
    out = tmp_path_factory.mktemp('sound') / 'flight'
    spec = load_spec('gtmab', 'lamp_room', 'bag', 'gtmab')
    spec = spec.with_values({'scenario.goal.time_limit': '6 s'})
    return simulate_once(spec, 2, out, FlightProgress(Console(quiet=True)))[0].bag


@pytest.fixture
def attempt(sandbox, sound, tmp_path):
    """Return a function that runs a command on a bag with a jump, within the sandbox's bounds."""

    def run(words, jump):
        (tmp_path / 'sound').symlink_to(sound)
        copy_with_jump(sound, tmp_path / 'jumped', *JUMPS[jump])
        told = sandbox.run([*words, 'jumped'], tmp_path)
        assert 'Traceback' not in told.err, told.err[-2000:]
        assert told.grown < MEMORY
        return told

    return run


def copy_with_jump(bag, folder, topics, jump_ns):
    """Write a bag again, with later stamps in some topics; log times stay."""
    source = read_bag(bag)
    with BagWriter(folder, source.provenance) as writer:
        for name, topic in source.topics.items():
            writer.add_topic(name, topic.type_name, [])
        numbers = dict.fromkeys(source.topics, 0)
        for name, log_time, data in source.iterate_messages():
            numbers[name] += 1
            moves = name.startswith(topics) and numbers[name] > 300
            writer.write(name, shift_stamp(data, jump_ns) if moves else data, log_time)


@pytest.mark.parametrize('words', REFUSING, ids=lambda words: ' '.join(words[:2]))
@pytest.mark.parametrize('jump', ['an hour', 'a year'])
def test_a_pose_that_jumps_is_one_sentence(attempt, words, jump):
    told = attempt(words, jump)
    assert (told.status, told.err.count('\n')) == (2, 1), told
    assert 'lta bag check' in told.err


@pytest.mark.parametrize(
    ('words', 'jump', 'status'),
    [
        *((words, 'back by a day', 2) for words in (REFUSING[0], *REFUSING[2:])),
        (REFUSING[1], 'back by a day', 0),  # what is before the clock has caught up is left out
        (REFUSING[1], 'all by a month', 2),
        (REFUSING[1], 'the IMU by a year', 2),
        (REFUSING[1], 'the commands by a year', 2),
        (COMMANDS, 'all by a month', 2),
        (COMMANDS, 'a year', 0),  # its commands end before
        (READING[0], 'the IMU by a year', 1),
        (READING[0], 'all by a month', 1),
    ],
)
def test_no_other_jump_takes_more_than_its_messages(attempt, words, jump, status):
    assert attempt(words, jump).status == status


def test_commands_are_not_flown_through_hours_between_all_messages(sandbox, sound, tmp_path):
    source = read_bag(sound)
    numbers = dict.fromkeys(source.topics, 0)
    with BagWriter(tmp_path / 'slow', source.provenance) as writer:
        for name, topic in source.topics.items():
            writer.add_topic(name, topic.type_name, [])
        for name, log_time, data in source.iterate_messages():
            numbers[name] += 1
            moves = name in (*POSES, '/lta1/motors')
            hours = numbers[name] * DAY // 24
            writer.write(name, shift_stamp(data, hours) if moves else data, log_time)
    told = sandbox.run([*COMMANDS, 'slow'], tmp_path)
    assert (told.status, told.err.count('\n')) == (2, 1), told
    assert 'lta bag check' in told.err


@pytest.mark.parametrize('words', READING, ids=lambda words: ' '.join(words[:4]))
def test_what_needs_no_even_time_reads_a_jump_of_the_pose(attempt, words):
    assert attempt(words, 'a year').status in (0, 1)
