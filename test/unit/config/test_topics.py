# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The table of topics: rhythm, roles, names, units, and what is recorded."""

from hypothesis import given
from hypothesis import strategies as st
from lta_config.errors import BadInput
from lta_config.message_files import list_message_files, read_field_units
from lta_config.topics import is_name, is_selected, load_topic_table, robot_topic, select_topics
import pytest

TABLE = load_topic_table()
PERIODIC = [name for name, topic in TABLE.topics.items() if topic.period is not None]


def published(name: str, now: int, lag: int) -> int:
    """Count a topic's messages one by one: those published a lag before `now` or earlier."""
    count = 0
    while True:
        publication = TABLE.start_ns + count * TABLE[name].period_ns + TABLE[name].latency_ns
        if publication + lag * TABLE.control_ns > now:
            return count
        count += 1


@given(st.sampled_from(PERIODIC), st.integers(-300, 1500), st.integers(0, 3), st.integers(-1, 1))
def test_due_is_what_counting_gives(name, step, lag, nudge):
    now = TABLE.start_ns + step * TABLE.control_ns + nudge  # one nanosecond beside the grid, too
    assert TABLE.count_due(name, now, lag) == published(name, now, lag)


def test_due_by_hand():
    start, ms = 1_000_000_000, 1_000_000
    assert TABLE.count_due('imu', start - 1) == 0
    assert TABLE.count_due('imu', start) == 1
    assert TABLE.count_due('imu', start + 20 * ms) == 3
    assert TABLE.count_due('motors', start, lag=1) == 0
    assert TABLE.count_due('motors', start + 10 * ms, lag=1) == 1
    assert TABLE.count_due('range', start + 30 * ms) == 2  # 0 and 25 ms
    assert TABLE.count_due('photodiodes', start + 90 * ms) == 0  # out only after its last sample
    assert TABLE.count_due('photodiodes', start + 100 * ms) == 1


def test_the_table_is_consistent():
    roles = {topic.source for topic in TABLE.topics.values()}
    for name, topic in TABLE.topics.items():
        assert set(topic.subscribers) <= roles, name
        assert all(lag >= 0 for lag in topic.subscribers.values()), name
        if topic.subscribers:
            assert topic.period_ns > 0, f'{name}: nobody can wait for what has no rhythm'
    block = TABLE.light.samples / TABLE.light.sample_rate.si
    assert TABLE['photodiodes'].period_ns == round(block * 1e9)
    assert TABLE['photodiodes'].latency_ns == round(block * 1e9)


def test_no_loop_waits_for_itself():
    # Edges without a lag, where an answer at a step needs an input of the same step.
    needs: dict[str, set[str]] = {}
    for topic in TABLE.topics.values():
        for role, lag in topic.subscribers.items():
            # The vehicle publishes a state before it waits for the answers to it.
            if lag == 0 and role != 'vehicle':
                needs.setdefault(role, set()).add(topic.source)
    ready: set[str] = {'vehicle', 'every node'}
    while True:
        more = {role for role in needs if role not in ready and needs[role] <= ready}
        if not more:
            break
        ready |= more
    assert set(needs) <= ready


def test_roles_and_names():
    assert TABLE.published_by('controller') == ['motors']
    assert TABLE.read_by('estimator') == [
        'imu', 'range', 'pressure', 'motors', 'light/peaks', 'light/estimate'
    ]  # fmt: skip
    assert TABLE['imu'].type == 'sensor_msgs/msg/Imu'
    with pytest.raises(BadInput, match=r"^Unknown topic 'imo'; known: /clock, .*/tf_static, air"):
        TABLE['imo']
    assert robot_topic('lta1', 'light/peaks') == '/lta1/light/peaks'
    assert robot_topic('lta1', '/clock') == '/clock'


@pytest.mark.parametrize('text', ['a', 'lta1', 'A_b2'])
def test_names_for_ros(text):
    assert is_name(text)


@pytest.mark.parametrize('text', ['', '1a', '_a', 'a-b', 'a/b', 'a b', 'a\n', 'ä', 'a.b'])
def test_no_names_for_ros(text):
    assert not is_name(text)


def test_every_number_of_lta_msgs_has_its_unit_in_a_comment():
    units = read_field_units()
    assert len(units) == len(list_message_files()) == 5
    numbers = {
        (name, line.split()[1])
        for name, path in list_message_files().items()
        for line in path.read_text(encoding='utf-8').splitlines()
        if line.startswith(('float', 'uint16['))
    }
    assert len(numbers) > 25
    assert {(name, field) for name, of in units.items() for field in of} >= numbers
    assert units['lta_msgs/msg/EnergyStatus']['capacity'] == 'C'


HIDDEN = TABLE.model_copy(
    update={
        'topics': {
            name: row.model_copy(update={'recorded': name != 'wind'})
            for name, row in TABLE.topics.items()
        }
    }
)


def test_the_table_says_what_is_recorded_unless_told():
    found = select_topics('', ['lta1'], HIDDEN)
    assert len(found) == len(TABLE.topics) - 1
    assert '/lta1/wind' not in found
    assert found['/lta1/imu'] == 'sensor_msgs/msg/Imu'
    assert '/clock' in found


def test_everything_is_what_the_table_has_and_more_that_is_found_later():
    assert set(select_topics('all', ['a', 'b'], HIDDEN)) == {
        *(f'/{robot}/{name}' for robot in 'ab' for name in TABLE.topics if name[0] != '/'),
        '/tf',
        '/tf_static',
        '/clock',
        '/diagnostics',
    }


def test_names_are_relative_to_each_robot_or_absolute():
    found = select_topics('imu /b/wind /clock  /rosout', ['a', 'b'], TABLE)
    assert found == {
        '/a/imu': 'sensor_msgs/msg/Imu',
        '/b/imu': 'sensor_msgs/msg/Imu',
        '/b/wind': 'geometry_msgs/msg/Vector3Stamped',
        '/clock': 'rosgraph_msgs/msg/Clock',
        '/rosout': 'rcl_interfaces/msg/Log',
    }
    assert select_topics('odom', [''], TABLE) == {'/odom': 'nav_msgs/msg/Odometry'}


@pytest.mark.parametrize('words', ['odm', 'imu odm', '/lta2/odom', 'all odm', '/odom'])
def test_an_unknown_name_is_refused_with_the_known_ones(words):
    with pytest.raises(BadInput, match=r"Unknown topic '.*'; known: .*/rosout, .*odom"):
        select_topics(words, ['lta1'], TABLE)


def test_a_simulator_knows_which_of_its_topics_the_recorder_takes():
    row = HIDDEN['wind']
    assert not is_selected('', 'a', 'wind', row)
    assert is_selected('all', 'a', 'wind', row)
    assert is_selected('imu wind', 'a', 'wind', row)
    assert is_selected('/a/wind', 'a', 'wind', row)
    assert not is_selected('/b/wind imu', 'a', 'wind', row)
