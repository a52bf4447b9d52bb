# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""What is recorded: by the table, by name, and everything."""

from lta_config.errors import BadInput
from lta_config.topics import is_selected, load_topic_table, select_topics
import pytest

TABLE = load_topic_table()
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
