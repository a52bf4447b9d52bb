# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Topics of a recording as tables of pandas, alone and on one clock."""

import os
from pathlib import Path
import shutil
import subprocess
import sys

from hypothesis import given, settings
from hypothesis import strategies as st
import lta_analysis
from lta_config.errors import BadInput
from lta_data.bag.table import align_tables, build_even_clock, build_table
import numpy as np
import pandas
import pytest
from scipy.spatial.transform import Rotation, Slerp

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
    assert ('odom' in flight, 'imu' in flight, flight.robot) == (True, False, 'lta1')
    odom = flight['odom']
    assert flight['odom'] is odom
    i = np.arange(40)
    np.testing.assert_array_equal(odom['stamp_ns'], START + i * 10**7)
    np.testing.assert_allclose(odom.index, 0.01 * i, rtol=0, atol=1e-12)
    np.testing.assert_array_equal(odom['pose.pose.position.x'], 0.1 * i)
    np.testing.assert_array_equal(odom['pose.covariance[35]'], 35.0 + i)
    # Of the message, three angles, the stamp and two texts
    assert odom.shape[1] == 2 + 3 + 4 + 36 + 6 + 36 + 3 + 1 + 2
    assert odom['child_frame_id'].tolist() == ['base_link'] * 40
    expected = np.angle(np.exp(0.1j * i))
    np.testing.assert_allclose(odom['pose.pose.orientation.yaw'], expected, atol=1e-12)
    names = [*odom.columns]
    place = names.index('pose.pose.orientation.w')
    assert names[place + 1 : place + 4] == [
        f'pose.pose.orientation.{p}' for p in ('yaw', 'pitch', 'roll')
    ]
    units = odom.attrs['units']
    assert {name: units[name] for name in names if name.startswith('pose.pose.')} == {
        **{f'pose.pose.position.{axis}': 'm' for axis in 'xyz'},
        **{f'pose.pose.orientation.{axis}': '1' for axis in 'xyzw'},
        **{f'pose.pose.orientation.{part}': 'rad' for part in ('yaw', 'pitch', 'roll')},
    }
    assert (units['twist.twist.angular.z'], units['time'], units['stamp_ns']) == (
        'rad/s', 's', 'ns'
    )  # fmt: skip
    assert 'child_frame_id' not in units
    assert odom.loc[0.1:0.155].attrs['units'] == units
    assert flight['/clock']['stamp_ns'].iloc[-1] == START + 39 * 10**7
    # A message without a stamp stands where its log time is on the clock of the stamps.
    np.testing.assert_array_equal(
        flight['energy/reserve']['stamp_ns'], START + np.arange(4) * 10**8
    )
    lines = repr(flight).splitlines()
    assert lines[0] == f'{flight_bag}: 2 topics of lta1, 0.4 s'
    assert lines[1].split() == ['odom', '40', 'nav_msgs/msg/Odometry']


def test_what_is_not_there_is_told_with_what_is(flight_bag):
    flight = lta_analysis.open(flight_bag)
    with pytest.raises(BadInput, match=r"Unknown topic 'imu'; known: energy/reserve, odom\."):
        flight['imu']
    with pytest.raises(BadInput, match='does not exist; give a rosbag2 folder'):
        lta_analysis.open(flight_bag / 'nothing')


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
    assert lta_analysis.open().bag.path == Path('runs/b/bag')
    shutil.rmtree('runs/b')
    assert lta_analysis.open(robot='lta1').bag.path == Path('runs/a')


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
    assert {'effort.up', 'effort.left'} <= {*motors.columns}
    assert 'effort[0]' not in motors.columns
    assert motors.attrs['units']['effort.left'] == '1'
    np.testing.assert_array_equal(motors['effort.left'], [0.2, 1.2])
    assert 'effort[0]' in flight['mixed'].columns


def numbers(name, milliseconds, **columns):
    """Return a table of a topic by hand."""
    stamps = START + np.array(milliseconds, np.int64) * 1_000_000
    return build_table(
        name, START, stamps, {key: np.array(values) for key, values in columns.items()}, {}
    )


def at(milliseconds):
    return START + np.array(milliseconds, np.int64) * 1_000_000


def test_previous_is_what_was_last_said_and_no_older_than_the_gap():
    slow = numbers(
        'slow', [0, 100, 200, 500], a=[1.0, 2.0, 3.0, 4.0], n=[5, 6, 7, 8], t=['p', 'q', 'r', 's']
    )
    clock = at([-10, 0, 99, 100, 250, 499, 500, 801])
    found = align_tables([slow], clock)  # three periods of 100 ms
    np.testing.assert_array_equal(found['slow/a'], [np.nan, 1, 1, 2, 3, 3, 4, np.nan])
    np.testing.assert_array_equal(found['slow/n'], [np.nan, 5, 5, 6, 7, 7, 8, np.nan])
    assert found['slow/t'].tolist() == ['', 'p', 'p', 'q', 'r', 'r', 's', '']
    found = align_tables([slow], clock, gap=0.2)
    np.testing.assert_array_equal(found['slow/a'], [np.nan, 1, 1, 2, 3, np.nan, 4, np.nan])
    assert align_tables([slow], at([0, 50, 100]))['slow/n'].dtype == np.int64


def test_linear_is_between_neighbours_and_never_across_a_gap():
    slow = numbers('slow', [0, 100, 200, 600], a=[0.0, 1.0, 3.0, 7.0], n=[5, 6, 7, 8])
    found = align_tables([slow], at([-1, 0, 50, 100, 175, 200, 400, 600, 601]), 'linear')
    np.testing.assert_allclose(
        found['slow/a'], [np.nan, 0, 0.5, 1, 2.5, 3, np.nan, 7, np.nan], rtol=0, atol=1e-12
    )
    np.testing.assert_array_equal(found['slow/n'], [np.nan, 5, 5, 6, 6, 7, np.nan, 8, np.nan])
    assert align_tables([slow], at([400]), 'linear', gap=0.4)['slow/a'].iloc[0] == 5.0


def test_angles_go_the_shorter_way_across_the_wrap():
    half = np.radians([170.0, -170.0, -150.0]) / 2
    turn = {'q.x': [0.0] * 3, 'q.y': [0.0] * 3, 'q.z': np.sin(half), 'q.w': np.cos(half)}
    turn['q.z'][1], turn['q.w'][1] = -turn['q.z'][1], -turn['q.w'][1]  # the same attitude
    turn['q.yaw'] = [0.0] * 3
    found = align_tables([numbers('odom', [0, 100, 200], **turn)], at([25, 50, 75, 150]), 'linear')
    np.testing.assert_allclose(
        np.degrees(found['odom/q.yaw']) % 360, [175.0, 180.0, 185.0, 200.0], rtol=0, atol=1e-9
    )


@settings(max_examples=40)
@given(
    seed=st.integers(0, 2**31),
    count=st.integers(2, 30),
    share=st.lists(st.floats(0, 1), min_size=1, max_size=10),
)
def test_turns_are_those_of_scipy(seed, count, share):
    rng = np.random.default_rng(seed)
    attitude = Rotation.from_quat(rng.normal(size=(count, 4)))
    times = np.cumsum(rng.integers(1, 1000, count))
    q = attitude.as_quat()
    table = numbers('odom', times, **{f'q.{axis}': q[:, k] for k, axis in enumerate('xyzw')},
                    **{'q.yaw': np.zeros(count)})  # fmt: skip
    clock = np.sort(times[0] + np.round(np.array(share) * (times[-1] - times[0]))).astype(np.int64)
    found = align_tables([table], at(clock), 'linear', gap=np.inf)
    found = found[[f'odom/q.{axis}' for axis in 'xyzw']].to_numpy()
    expected = Slerp(times, attitude)(clock)
    assert (Rotation.from_quat(found).inv() * expected).magnitude().max() < 1e-7


@settings(max_examples=40)
@given(seed=st.integers(0, 2**31), count=st.integers(1, 40), rows=st.integers(0, 40))
def test_alignment_is_that_of_pandas_and_numpy(seed, count, rows):
    rng = np.random.default_rng(seed)
    times, values = rng.integers(0, 500, count), rng.normal(size=count)
    clock = np.sort(rng.integers(-50, 600, rows))
    table = numbers('t', times, a=values)  # in any order, some stamps twice: the last one counts
    given_ = pandas.DataFrame({'time': times, 'a': values}).sort_values('time', kind='stable')
    given_ = given_.drop_duplicates('time', keep='last')
    expected = pandas.merge_asof(
        pandas.DataFrame({'time': clock}, dtype='int64'), given_, on='time', tolerance=40
    )['a']
    found = align_tables([table], at(clock), gap=0.04)['t/a']
    np.testing.assert_array_equal(found, expected)
    between = align_tables([table], at(clock), 'linear', gap=np.inf)['t/a']
    straight = np.interp(clock, given_['time'], given_['a'], np.nan, np.nan)
    np.testing.assert_allclose(between, straight, rtol=1e-12, atol=1e-12)


def test_clocks(flight_bag):
    flight = lta_analysis.open(flight_bag)
    on_first = flight.align_topics('odom', 'energy/reserve')
    np.testing.assert_array_equal(on_first['stamp_ns'], flight['odom']['stamp_ns'])
    assert on_first['energy/reserve/data'].tolist() == [i >= 20 for i in range(40)]
    assert on_first.attrs['units']['odom/pose.pose.position.x'] == 'm'
    assert not any('header' in name or 'covariance' in name for name in on_first)
    on_other = flight.align_topics('odom', on='energy/reserve')
    np.testing.assert_allclose(on_other['odom/pose.pose.position.x'], [0, 1, 2, 3])
    even_rate = flight.align_topics('odom', rate=50.0)
    np.testing.assert_allclose(even_rate.index, 0.02 * np.arange(20), rtol=0, atol=1e-12)
    assert (
        build_even_clock([numbers('a', [105, 250], x=[0, 0])], 10.0).tolist() == at([200]).tolist()
    )
    with pytest.raises(BadInput, match='span 1770000000 s, too long to resample at 50 Hz'):
        build_even_clock([numbers('a', [0, 1_770_000_000_000], x=[0, 0])], 50.0)
    for wrong, said in [
        ({'rate': 5.0, 'on': 'odom'}, r"Both rate=5.0 Hz and on='odom' were given"),
        ({'rate': 0.0}, 'The rate is 0.0, but must be a number above 0'),
        ({'rate': '50'}, "The rate is '50', but must be a number above 0"),
        ({'method': 'cubic'}, "Unknown method 'cubic'; known: linear, previous"),
        ({'gap': -1.0}, 'The maximum gap is -1.0, but must be a number above 0'),
        ({'gap': '1'}, "The maximum gap is '1', but must be a number above 0"),
        ({'on': 'imu'}, "Unknown topic 'imu'"),
    ]:
        with pytest.raises(BadInput, match=said):
            flight.align_topics('odom', **wrong)
    with pytest.raises(
        BadInput, match='No topics to align were given; choose from: energy/reserve, odom'
    ):
        flight.align_topics()
