# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Only the bag of a flight that never began is removed."""

from lta_bag.writer import BagWriter
from lta_flight.flight import remove_unflown_bags
import pytest

EMPTY = bytes.fromhex('00010000') + bytes(64)


def write_bag(folder, **counts):
    with BagWriter(folder, {}) as bag:
        for name, kind in (
            ('/diagnostics', 'diagnostic_msgs/msg/DiagnosticArray'),
            ('/lta1/odom', 'nav_msgs/msg/Odometry'),
        ):
            bag.add_topic(name, kind, [])
            for k in range(counts.get(name.rpartition('/')[2], 0)):
                bag.write(name, EMPTY, k)
    return folder


@pytest.mark.parametrize(
    ('counts', 'stays'),
    [({}, False), ({'diagnostics': 3}, False), ({'odom': 1}, True)],
)
def test_a_bag_stays_if_a_robot_has_sent_a_message(counts, stays, tmp_path):
    bag = write_bag(tmp_path / 'bag', **counts)
    remove_unflown_bags([bag])
    assert bag.exists() == stays


def test_what_is_no_bag_stays_unless_it_is_an_empty_folder(tmp_path):
    file, folder, empty = tmp_path / 'file', tmp_path / 'folder', tmp_path / 'empty'
    file.touch()
    folder.mkdir()
    (folder / 'notes.txt').touch()
    empty.mkdir()
    remove_unflown_bags([file, folder, empty, tmp_path / 'missing'])
    assert sorted(path.name for path in tmp_path.iterdir()) == ['file', 'folder']
