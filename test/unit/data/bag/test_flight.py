# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Flights as arrays: values against what was sent, times against the stamps."""

from lta_config.errors import BadInput
from lta_data.bag import open_flight
from lta_data.bag.table import get_column, group_points
import numpy as np
import pytest

START = 1_000_000_000


def header(types, time):
    stamp = types['builtin_interfaces/msg/Time'](time // 10**9, time % 10**9)
    return types['std_msgs/msg/Header'](stamp, 'base_link')


def test_arrays_of_any_length(record, types):
    joint = types['sensor_msgs/msg/JointState']
    none = np.empty(0)
    messages = [
        joint(header(types, START), ['up', 'left'], none, none, np.array([0.1, 0.2])),
        joint(header(types, START + 10**7), ['up'], none, none, np.array([0.3])),
    ]
    rows = [('/lta1/motors', 'sensor_msgs/msg/JointState', m, 0) for m in messages]
    motors = open_flight(record(rows))['motors']
    np.testing.assert_array_equal(motors['effort.up'], [0.1, 0.3])
    np.testing.assert_array_equal(motors['effort[1]'], [0.2, np.nan])
    assert motors['name[0]'].tolist() == ['up', 'up']
    assert motors['name[1]'].tolist() == ['left', '']
    with pytest.raises(BadInput, match="Unknown column of motors 'effort'; known: effort"):
        get_column(motors, 'effort')


def test_constants_and_bytes_are_no_columns(record, types):
    cell = types['sensor_msgs/msg/BatteryState'](
        header(types, START), 3.9, 25.0, -0.2, 0.2, 0.25, 0.25, 0.8, 2, 1, 3, True,
        np.array([3.9], np.float32), np.empty(0, np.float32), 'nose', 'cell 4',
    )  # fmt: skip
    rows = [('/lta1/battery', 'sensor_msgs/msg/BatteryState', cell, 0)]
    battery = open_flight(record(rows))['battery']
    assert set(battery) - {'stamp_ns', 'header.frame_id', 'location', 'serial_number'} == {
        'header.stamp.sec', 'header.stamp.nanosec', 'voltage', 'temperature', 'current', 'charge',
        'capacity', 'design_capacity', 'percentage', 'power_supply_status', 'power_supply_health',
        'power_supply_technology', 'present', 'cell_voltage[0]',
    }  # fmt: skip
    assert battery['voltage'][0] == np.float32(3.9)


def test_adc_blocks(record, types):
    rng = np.random.default_rng(2)
    sent = rng.integers(0, 4096, (5, 100, 8), dtype=np.uint16)
    rows = []
    for i, block in enumerate(sent):
        message = types['lta_msgs/msg/LightBlock'](
            header(types, START + i * 10**8), 1e4, 8, block.ravel()
        )
        rows.append(('/lta1/photodiodes', 'lta_msgs/msg/LightBlock', message, 0))
    flight = open_flight(record(rows))
    blocks = flight.read_blocks('photodiodes')
    np.testing.assert_array_equal(blocks.samples, sent)
    assert blocks.samples.dtype == np.uint16
    np.testing.assert_allclose(blocks.time, 0.1 * np.arange(5), rtol=0, atol=1e-12)
    assert 'counts[0]' not in flight['photodiodes']


def test_wrong_blocks(record, types):
    kind = types['lta_msgs/msg/LightBlock']
    counts = np.arange(6, dtype=np.uint16)
    good = kind(header(types, START), 1e4, 2, counts)
    odd = kind(header(types, START), 1e4, 4, counts)
    none = kind(header(types, START), 1e4, 0, counts)
    other = kind(header(types, START), 1e4, 3, counts)
    kinds = {'good': [good], 'odd': [odd], 'none': [none], 'mixed': [good, other]}
    rows = [
        (f'/r/{name}', 'lta_msgs/msg/LightBlock', message, 0)
        for name, messages in kinds.items()
        for message in messages
    ]
    flight = open_flight(record(rows))
    np.testing.assert_array_equal(flight.read_blocks('good').samples, [[[0, 1], [2, 3], [4, 5]]])
    with pytest.raises(BadInput, match='6 counts are no multiple of 4 diodes'):
        flight.read_blocks('odd')
    with pytest.raises(BadInput, match='6 counts are no multiple of 0 diodes'):
        flight.read_blocks('none')
    with pytest.raises(BadInput, match='different shape'):
        flight.read_blocks('mixed')


def test_point_lists(record, types):
    """Two beacons at two diodes, then one at one: points are beacon by beacon."""
    rows = []
    for i, (beacons, diodes) in enumerate(((2, 2), (1, 1))):
        axes = [types['geometry_msgs/msg/Vector3'](0.5 + i, float(k), 0.0) for k in range(diodes)]
        peaks = [
            types['lta_msgs/msg/BeaconPeaks'](
                *(np.arange(diodes, dtype=np.float32) + 10 * part + beacon for part in range(3))
            )
            for beacon in range(beacons)
        ]
        message = types['lta_msgs/msg/LampPeaks'](header(types, START + i * 10**8), axes, peaks)
        rows.append(('/lta1/light/peaks', 'lta_msgs/msg/LampPeaks', message, 0))
    table = open_flight(record(rows))['light/peaks']
    np.testing.assert_allclose(table.index, [0.0, 0.1], rtol=0, atol=1e-12)
    peaks = group_points(table)
    assert list(peaks) == ['x', 'y', 'z', 'amplitude', 'snr', 'frequency']
    np.testing.assert_array_equal(peaks['y'][0], [0, 1, 0, 1])
    np.testing.assert_array_equal(peaks['snr'][0], [10, 11, 11, 12])
    np.testing.assert_array_equal(peaks['x'][1], [1.5] + [np.nan] * 3)
    np.testing.assert_array_equal(peaks['frequency'][1, :1], [20])
    np.testing.assert_array_equal(table['snr[3]'], peaks['snr'][:, 3])
    assert table.attrs['units']['snr[3]'] == '1'


def test_blocks_of_another_topic_are_refused(flight_bag):
    with pytest.raises(BadInput, match="has type 'nav_msgs/msg/Odometry', not"):
        open_flight(flight_bag).read_blocks('odom')


def test_two_robots_are_told_apart(record, types):
    flag = types['std_msgs/msg/Bool'](True)
    bag = record([(f'/{name}/flag', 'std_msgs/msg/Bool', flag, 5) for name in ('lta2', 'lta1')])
    with pytest.raises(BadInput, match=r'several robots \(lta1, lta2\); choose one.*--robot lta2'):
        open_flight(bag)
    with pytest.raises(BadInput, match="Unknown robot 'lta3'"):
        open_flight(bag, 'lta3')
    assert open_flight(bag, 'lta2')['flag']['data'].tolist() == [True]


def test_each_of_two_robots_has_its_own_origin(record, types):
    flag = types['std_msgs/msg/Bool'](True)
    told = {'robots': 'lta1 lta2', 'scenario': 'room', 'lta1/seed': '1', 'lta2/seed': '2'}
    names = ('lta1', 'lta2')
    bag = record(
        [(f'/{name}/flag', 'std_msgs/msg/Bool', flag, 5) for name in names], provenance=told
    )
    assert [open_flight(bag, name).provenance for name in names] == [
        {'scenario': 'room', 'seed': '1'},
        {'scenario': 'room', 'seed': '2'},
    ]


def test_bag_without_namespace_or_messages(record, types):
    flag = types['std_msgs/msg/Bool'](True)
    flight = open_flight(record([('/flag', 'std_msgs/msg/Bool', flag, 7)], 'one'))
    assert (flight.robot, flight.start, flight.topics) == ('', 7, ['flag'])
    assert flight['flag'].index.tolist() == [0.0]
    assert open_flight(record([], 'two')).topics == []


def test_topic_without_messages_is_empty(record, tmp_path):
    from lta_bag import BagWriter

    with BagWriter(tmp_path / 'b', {}) as bag:
        bag.add_topic('/lta1/odom', 'nav_msgs/msg/Odometry', [])
        bag.add_topic('/lta1/photodiodes', 'lta_msgs/msg/LightBlock', [])
    flight = open_flight(tmp_path / 'b')
    assert len(flight['odom']) == 0
    assert flight.read_blocks('photodiodes').samples.shape == (0, 0, 0)


def test_a_topic_that_cannot_be_read_leaves_the_others_as_they_are(tmp_path, types):
    from lta_bag import BagWriter
    from lta_bag.schemas import load_jazzy_types

    with BagWriter(tmp_path / 'b', {}) as bag:
        bag.add_topic('/lta1/broken', 'sensor_msgs/msg/Imu', [])
        bag.add_topic('/lta1/wind', 'geometry_msgs/msg/Vector3Stamped', [])
        bag.write('/lta1/broken', b'\0\1\0\0nothing', 1)
        wind = types['geometry_msgs/msg/Vector3Stamped'](
            header(types, START), types['geometry_msgs/msg/Vector3'](1.0, 2.0, 3.0)
        )
        data = bytes(load_jazzy_types().serialize_cdr(wind, 'geometry_msgs/msg/Vector3Stamped'))
        bag.write('/lta1/wind', data, 2)
    flight = open_flight(tmp_path / 'b')
    assert flight.start == START
    assert flight['wind']['vector.y'].tolist() == [2.0]
    with pytest.raises(BadInput, match='does not match the definition of its type'):
        flight['broken']


def test_several_topics_come_from_one_pass_and_are_the_same(flight_bag, monkeypatch):
    flight = open_flight(flight_bag)
    passes = []
    messages = flight.bag.iterate_messages

    def counted(names):
        passes.append(names)
        return messages(names)

    monkeypatch.setattr(flight.bag, 'iterate_messages', counted)
    found = flight.read_tables(['odom', 'energy/reserve', '/lta1/odom'])
    assert len(passes) == 1
    monkeypatch.undo()
    for name in ('odom', '/lta1/odom'):
        assert found[name].equals(flight['odom'])
