"""Several topics on one clock: values against hand calculation, pandas, numpy and scipy."""

from hypothesis import given, settings
from hypothesis import strategies as st
import lta_analysis
from lta_config.errors import BadInput
from lta_data.bag.align import align_tables, build_even_clock
from lta_data.bag.table import RecordingTable
import numpy as np
import pandas
import pytest
from scipy.spatial.transform import Rotation, Slerp

START = 1_000_000_000


def numbers(name, milliseconds, **columns):
    """Return a table of a topic by hand."""
    stamps = START + np.array(milliseconds, np.int64) * 1_000_000
    return RecordingTable(
        name, stamps, START, {key: np.array(values) for key, values in columns.items()}, {}
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
    inside = align_tables([slow], at([0, 50, 100]))
    assert inside['slow/n'].dtype == np.int64


def test_linear_is_between_neighbours_and_never_across_a_gap():
    slow = numbers('slow', [0, 100, 200, 600], a=[0.0, 1.0, 3.0, 7.0], n=[5, 6, 7, 8])
    found = align_tables([slow], at([-1, 0, 50, 100, 175, 200, 400, 600, 601]), 'linear')
    np.testing.assert_allclose(
        found['slow/a'], [np.nan, 0, 0.5, 1, 2.5, 3, np.nan, 7, np.nan], rtol=0, atol=1e-12
    )
    np.testing.assert_array_equal(found['slow/n'], [np.nan, 5, 5, 6, 6, 7, np.nan, 8, np.nan])
    assert align_tables([slow], at([400]), 'linear', gap=0.4)['slow/a'][0] == 5.0


def test_angles_go_the_shorter_way_across_the_wrap():
    half = np.radians([170.0, -170.0, -150.0]) / 2
    turn = {'q.x': [0.0] * 3, 'q.y': [0.0] * 3, 'q.z': np.sin(half), 'q.w': np.cos(half)}
    turn['q.z'][1], turn['q.w'][1] = -turn['q.z'][1], -turn['q.w'][1]  # the same attitude
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
    table = numbers('odom', times, **{f'q.{axis}': q[:, k] for k, axis in enumerate('xyzw')})
    clock = np.sort(times[0] + np.round(np.array(share) * (times[-1] - times[0]))).astype(np.int64)
    found = align_tables([table], at(clock), 'linear', gap=np.inf).vector('odom/q')
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
    np.testing.assert_array_equal(on_first.stamp_ns, flight['odom'].stamp_ns)
    assert on_first['energy/reserve/data'].tolist() == [i >= 20 for i in range(40)]
    assert on_first.units['odom/pose.pose.position.x'] == 'm'
    assert not any('header' in name or 'covariance' in name for name in on_first)
    on_other = flight.align_topics('odom', on='energy/reserve')
    np.testing.assert_allclose(on_other['odom/pose.pose.position.x'], [0, 1, 2, 3])
    even_rate = flight.align_topics('odom', rate=50.0)
    np.testing.assert_allclose(even_rate.time, 0.02 * np.arange(20), rtol=0, atol=1e-12)
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
