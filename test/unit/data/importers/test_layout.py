# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Messages laid out at once, against those that rosbags makes one by one."""

from lta_bag.schemas import load_jazzy_types
from lta_config.errors import BadInput
from lta_config.topics import load_topic_table
from lta_data.importers.entry_plan import (
    CdrTemplate,
    EXTRA,
    find_target,
    list_targets,
    MESSAGE_SHAPES,
)
import numpy as np
import pytest

TYPES = load_jazzy_types()


@pytest.mark.parametrize('type_name', sorted(MESSAGE_SHAPES))
def test_every_number_stands_where_rosbags_reads_it(type_name):
    """Give each number of a type a value of its own; a reader finds each under its path."""
    lengths = {'position': 2, 'effort': 2}
    given = {'header.frame_id': 'a frame', 'location': 'left', 'name': ['one', 'two']}
    given = given if type_name == 'sensor_msgs/msg/JointState' else {**given, 'name': []}
    layout = CdrTemplate(type_name, given, lengths)
    values = {path: np.array([index + 1, index + 2]) for index, path in enumerate(layout.places)}
    data = layout.serialize_messages(2, {path: column % 120 for path, column in values.items()})
    assert len(data) == 2 * layout.size
    for row in range(2):
        part = data[row * layout.size : (row + 1) * layout.size]
        message = TYPES.deserialize_cdr(part, type_name)
        again = bytes(TYPES.serialize_cdr(message, type_name))
        assert part.ljust(len(again), b'\0') == again.ljust(len(part), b'\0')
        assert message.header.frame_id == 'a frame'
        for path, column in values.items():
            expected = column[row] % 120
            # In place of a bool stands a byte, of which rosbags keeps whether it is zero.
            found = leaf(message, path)
            assert found == (bool(expected) if isinstance(found, bool) else expected), path


def leaf(message, path):
    """Return the number at a path."""
    value = message
    for part in path.split('.'):
        name, _, index = part.partition('[')
        value = getattr(value, name)
        value = value[int(index[:-1])] if index else value
    return value


@pytest.mark.parametrize('type_name', sorted(MESSAGE_SHAPES))
def test_every_part_has_a_place_in_its_message(type_name):
    places = CdrTemplate(type_name, {}).places
    for part in MESSAGE_SHAPES[type_name].values():
        axes = {'attitude': 'xyzw', 'number': ''}.get(part.kind, 'xyz')
        wanted = [f'{part.place}.{axis}' for axis in axes] or [part.place]
        assert {*wanted, *([part.unknown] if part.unknown else [])} <= set(places)


def test_targets_are_those_of_the_topic_table_and_the_wrench():
    found = list_targets()
    assert found['ground_truth/odom'] == ('nav_msgs/msg/Odometry', 'map')
    assert found['wrench_command'] == EXTRA['wrench_command']
    assert found['motors'] == ('sensor_msgs/msg/JointState', load_topic_table()['motors'].frame)
    with pytest.raises(BadInput, match="Unknown topic to import into 'odometry'; known: battery"):
        find_target('odometry')
