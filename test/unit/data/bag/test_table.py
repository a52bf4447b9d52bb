"""Tables of a recording: columns, units, rows, and the frames of other libraries."""

import os
from pathlib import Path
import shutil
import subprocess
import sys

import lta_analysis
from lta_config.errors import BadInput
import numpy as np
import polars
import pytest

START = 1_000_000_000


def header(types, time):
    stamp = types['builtin_interfaces/msg/Time'](time // 10**9, time % 10**9)
    return types['std_msgs/msg/Header'](stamp, 'base_link')


def test_importing_the_package_imports_nothing_else():
    code = (
        f'import sys; sys.path[:0] = {sys.path!r}; import lta_analysis; '
        "heavy = {'numpy', 'pyarrow', 'rosbags', 'pandas'} & set(sys.modules); "
        'assert not heavy, heavy; assert callable(lta_analysis.open); '
        "assert 'numpy' in sys.modules"
    )
    subprocess.run([sys.executable, '-S', '-c', code], check=True)
    with pytest.raises(AttributeError, match="no attribute 'shut'"):
        lta_analysis.shut  # noqa: B018


def test_a_topic_is_a_table_that_is_read_once(flight_bag):
    flight = lta_analysis.open(flight_bag)
    assert list(flight) == flight.topics == ['odom', 'energy/reserve']
    assert ('odom' in flight, 'imu' in flight, len(flight), flight.robot) == (
        True,
        False,
        2,
        'lta1',
    )
    odom = flight['odom']
    assert flight['odom'] is odom
    flight.clear_cache()
    assert flight['odom'] is not odom
    i = np.arange(40)
    np.testing.assert_array_equal(odom.stamp_ns, START + i * 10**7)
    np.testing.assert_allclose(odom.time, 0.01 * i, rtol=0, atol=1e-12)
    np.testing.assert_array_equal(odom['pose.pose.position.x'], 0.1 * i)
    expected = np.angle(np.exp(0.1j * i))
    np.testing.assert_allclose(odom['pose.pose.orientation.yaw'], expected, atol=1e-12)
    names = odom.columns
    place = names.index('pose.pose.orientation.w')
    assert names[place + 1 : place + 4] == [
        f'pose.pose.orientation.{p}' for p in ('yaw', 'pitch', 'roll')
    ]
    assert {name: odom.units[name] for name in names if name.startswith('pose.pose.')} == {
        **{f'pose.pose.position.{axis}': 'm' for axis in 'xyz'},
        **{f'pose.pose.orientation.{axis}': '1' for axis in 'xyzw'},
        **{f'pose.pose.orientation.{part}': 'rad' for part in ('yaw', 'pitch', 'roll')},
    }
    assert odom.units['twist.twist.angular.z'] == 'rad/s'
    assert 'child_frame_id' not in odom.units
    np.testing.assert_array_equal(odom.array('pose.covariance'), i[:, None] + np.arange(36.0))
    assert flight['/clock'].stamp_ns[-1] == START + 39 * 10**7
    # A message without a stamp stands where its log time is on the clock of the stamps.
    np.testing.assert_array_equal(flight['energy/reserve'].stamp_ns, START + np.arange(4) * 10**8)


def test_what_is_not_there_is_told_with_what_is(flight_bag):
    flight = lta_analysis.open(flight_bag)
    with pytest.raises(BadInput, match=r"Unknown topic 'imu'; known: energy/reserve, odom\."):
        flight['imu']
    with pytest.raises(BadInput, match=r"Unknown column 'yaw'; known: child_frame_id, pose.pose"):
        flight['odom']['yaw']
    with pytest.raises(BadInput, match=r"Unknown array 'pose'; known: none\."):
        flight['odom'].array('pose')
    with pytest.raises(BadInput, match="'odom' has no image samples; choose an image topic"):
        flight['odom'].samples  # noqa: B018
    with pytest.raises(BadInput, match="Unknown column 'speed\\*'"):
        flight['odom'].select('speed*')
    with pytest.raises(BadInput, match='does not exist; give a rosbag2 folder'):
        lta_analysis.open(flight_bag / 'nothing')


def test_rows_and_columns_are_chosen(flight_bag):
    odom = lta_analysis.open(flight_bag)['odom']
    part = odom.between(0.1, 0.15)
    np.testing.assert_array_equal(part['pose.pose.position.x'], 0.1 * np.arange(10, 16))
    np.testing.assert_array_equal(part.time, odom.time[10:16])
    assert np.shares_memory(part['pose.pose.position.x'], odom['pose.pose.position.x'])
    assert len(odom.between(3.0, 4.0)) == 0
    few = odom.select('pose.pose.orientation.*', 'twist.twist.linear.x')
    assert few.stored_columns == [
        *(f'pose.pose.orientation.{axis}' for axis in 'xyzw'),
        'twist.twist.linear.x',
    ]
    assert len(few.columns) == 8
    assert few.units == {name: odom.units[name] for name in few.columns}


def test_the_look_of_a_recording_and_of_a_table(flight_bag):
    flight = lta_analysis.open(flight_bag)
    lines = repr(flight).splitlines()
    assert lines[0] == f'{flight_bag}: 2 topics of lta1, 0.4 s'
    assert lines[1].split() == ['odom', '40', 'nav_msgs/msg/Odometry']
    lines = repr(flight['odom']).splitlines()
    assert lines[0] == 'odom: 40 rows from 0.00 to 0.39 s, 100 Hz, nav_msgs/msg/Odometry'
    assert lines[1].split() == ['pose.pose.position.x', 'm', '0', 'to', '3.9']
    assert lines[-2].split() == ['child_frame_id', 'base_link']
    assert lines[-1] == '  and 75 more columns (see .columns)'
    assert repr(flight['energy/reserve']).splitlines()[1].split() == ['data', 'False,', 'True']
    assert repr(flight['odom'].between(5, 6)).startswith('odom: no rows')


def test_frames_of_other_libraries_have_the_values_and_the_units(flight_bag):
    odom = lta_analysis.open(flight_bag)['odom']
    frame, lazy, arrow = odom.to_pandas(), odom.to_polars(), odom.to_arrow()
    assert frame.attrs['units']['pose.pose.position.x'] == 'm'
    assert frame.attrs['units']['time'] == 's'
    assert list(frame.columns) == odom.columns
    assert lazy.columns == ['time', *odom.columns]
    assert arrow.column_names == ['stamp_ns', 'time', *odom.columns]
    assert arrow.field('twist.twist.linear.x').metadata == {b'unit': b'm/s'}
    assert arrow.field('child_frame_id').metadata is None
    assert arrow.schema.metadata == {b'topic': b'odom', b'type': b'nav_msgs/msg/Odometry'}
    np.testing.assert_array_equal(frame.index, odom.time)
    for column in odom:
        np.testing.assert_array_equal(frame[column], odom[column])
        np.testing.assert_array_equal(lazy[column].to_numpy(), odom[column])
        np.testing.assert_array_equal(arrow[column].to_numpy(), odom[column])
    assert isinstance(lazy, polars.DataFrame)


def test_polars_that_is_missing_is_told_with_the_remedy(flight_bag, monkeypatch):
    monkeypatch.setitem(sys.modules, 'polars', None)
    odom = lta_analysis.open(flight_bag)['odom']
    with pytest.raises(BadInput, match=r'needs polars, which is not installed; .*install polars'):
        odom.to_polars()


def test_the_newest_recording_is_opened_if_none_is_named(flight_bag, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(BadInput, match=r"no recording in '.*/runs'; fly first"):
        lta_analysis.open()
    # A results folder, an imported bag, and folders without a recording, which are the newest
    for folder, seconds in (('runs/b/bag', 3), ('runs/a', 2), ('runs/c/bag', 1)):
        shutil.copytree(flight_bag, folder)
        os.utime(f'{folder}/metadata.yaml', (seconds, seconds))
    Path('runs/d').mkdir()
    Path('runs/d/animation.mcap').touch()
    assert lta_analysis.open().flight.bag.path == Path('runs/b/bag')
    shutil.rmtree('runs/b')
    assert lta_analysis.open(robot='lta1').flight.bag.path == Path('runs/a')


def test_joints_are_called_by_their_names(record, types):
    def joints(k, names):
        none, effort = np.empty(0), np.array([0.1, 0.2]) + k
        return types['sensor_msgs/msg/JointState'](
            header(types, START + k), names, none, none, effort
        )

    one, other = ['up', 'left'], ['left', 'up']
    rows = [
        (topic, 'sensor_msgs/msg/JointState', joints(k, names), 0)
        for topic, orders in (('/lta1/motors', [one, one]), ('/lta1/mixed', [one, other]))
        for k, names in enumerate(orders)
    ]
    flight = lta_analysis.open(record(rows))
    motors = flight['motors']
    assert {'effort.up', 'effort.left'} <= set(motors.columns)
    assert 'effort[0]' not in motors.columns
    assert motors.units['effort.left'] == '1'
    np.testing.assert_array_equal(motors['effort.left'], [0.2, 1.2])
    np.testing.assert_array_equal(motors['effort[1]'], motors['effort.left'])
    np.testing.assert_array_equal(motors.array('effort'), [[0.1, 0.2], [1.1, 1.2]])
    np.testing.assert_array_equal(motors.select_rows(np.array([1]))['effort[0]'], [1.1])
    assert 'effort[0]' in flight['mixed'].columns


def test_samples_and_points_come_as_arrays(record, types):
    rng = np.random.default_rng(5)
    sent = rng.integers(0, 4096, (4, 10, 3), dtype=np.uint16)
    rows = []
    for i, block in enumerate(sent):
        head = header(types, START + i * 10**8)
        message = types['lta_msgs/msg/LightBlock'](head, 1e4, 3, block.ravel())
        rows.append(('/lta1/photodiodes', 'lta_msgs/msg/LightBlock', message, 0))
        axes = [types['geometry_msgs/msg/Vector3'](float(x), 0.0, 0.0) for x in (i, 3)]
        ones = np.ones(2, np.float32)
        beacon = types['lta_msgs/msg/BeaconPeaks'](
            ones, np.array([2, 4 * i], np.float32), 150 * ones
        )
        peaks = types['lta_msgs/msg/LampPeaks'](head, axes, [beacon])
        rows.append(('/lta1/light/peaks', 'lta_msgs/msg/LampPeaks', peaks, 0))
    flight = lta_analysis.open(record(rows))
    np.testing.assert_array_equal(flight['photodiodes'].samples, sent)
    np.testing.assert_array_equal(flight['photodiodes'].between(0.1, 0.25).samples, sent[1:3])
    assert flight['photodiodes']['diodes'].tolist() == [3] * 4
    peaks = flight['light/peaks']
    assert peaks.columns == [
        f'{name}[{k}]' for name in ('x', 'y', 'z', 'amplitude', 'snr', 'frequency') for k in (0, 1)
    ]
    np.testing.assert_array_equal(peaks.array('x'), [[0, 3], [1, 3], [2, 3], [3, 3]])
    np.testing.assert_array_equal(peaks.array('snr'), [[2, 0], [2, 4], [2, 8], [2, 12]])
    np.testing.assert_array_equal(peaks.stamp_ns, START + np.arange(4) * 10**8)
    assert peaks.units['snr[1]'] == '1'


def test_rows_are_chosen_as_of_an_array(flight_bag):
    odom = lta_analysis.open(flight_bag, robot='/lta1/')['odom']
    z = odom['pose.pose.position.z']
    assert len(odom) > 3
    assert odom[1:3]['pose.pose.position.z'].tolist() == z[1:3].tolist()
    assert odom[::-1].stamp_ns.tolist() == odom.stamp_ns[::-1].tolist()
    assert len(odom[z > z.min()]) == (z > z.min()).sum()
    assert odom[np.array([2, 0])].time.tolist() == [odom.time[2], odom.time[0]]
    mixed = np.array([0, 2, 1, 2])  # as long as from the first to the last of 0, 1, 2, 3
    assert (
        odom.select_rows(np.array([0, 3, 1, 3])).time.tolist() == odom.time[[0, 3, 1, 3]].tolist()
    )
    assert odom[mixed].time.tolist() == odom.time[mixed].tolist()
    assert len(odom[5:2]) == 0
    for wrong in (np.array([10**6]), np.array([True]), np.array([0.5])):
        with pytest.raises(BadInput, match='does not select rows of this table'):
            odom[wrong]
