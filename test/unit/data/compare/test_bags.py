# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Comparing bags: offsets, frames, faults and partings that are known by hand."""

from lta_analysis.comparison.sentences import format_verdict
from lta_bag import BagWriter
from lta_bag.schemas import load_jazzy_types
from lta_config.errors import BadInput
from lta_data.bag import open_flight
from lta_data.compare.channel_comparison import select_topic_pairs
from lta_data.compare.comparison import compare_flights, compare_sides, ComparisonRequest
from lta_data.flight import Channel
import numpy as np
import pytest

from ...report_flight import make, pose, write_flight  # noqa: TID252 - `test` is Python's own
from .compare_flight import side_of, stamped
from .compare_two import channel, NOISY, OTHER, YAW, Z
from .compare_two import two as two

ODOMETRY = 'nav_msgs/msg/Odometry'


def test_a_tracker_and_a_recorder_aboard_are_laid_on_each_other(two):
    turned = {'turn': 0.6, 'shift': (3.0, -1.0, 0.25), 'frame': 'tracker'}
    found = two(NOISY, OTHER | {'offset': 0.1234} | turned)
    timing = found.timing
    assert (timing.how, timing.on_stamps) == ('clock', True)
    assert abs(timing.offset - 0.1234) < 4 * timing.sigma < 0.02
    (frame,) = found.frames
    assert frame.applied
    assert frame.fit.yaw == pytest.approx(-0.6, abs=0.003)
    assert frame.fit.z == pytest.approx(-0.25, abs=0.003)
    assert frame.fit.after < 0.03
    for each in found.channels:
        assert each.verdict == 'together', each.name
        if each.name.startswith('odom/pose.pose.position'):
            # The slower is B; A's noise between two instants is a little smoothed.
            assert 0.010 < each.measures.rms < 0.0145
    assert found.verdict == 'same'
    assert format_verdict(found).startswith('The flights agree within their noise')


def test_clocks_that_share_nothing_count_from_each_start(two):
    found = two(NOISY, OTHER | {'start': 1_000_000_000, 'offset': 0.4})
    assert (found.timing.how, found.timing.on_stamps) == ('clock', False)
    # B's own time begins at its first message, which is 3 ms into the motion.
    assert found.timing.offset == pytest.approx(-0.003, abs=4 * found.timing.sigma)


def test_a_frame_of_the_same_name_is_fitted_where_one_run_shows_that_it_differs(two):
    found = two(NOISY, OTHER | {'offset': 0.1234, 'turn': 0.6})
    assert found.frames[0].applied
    given = two(NOISY, OTHER | {'offset': 0.1234, 'turn': 0.6}, frames='given')
    assert not given.frames[0].applied
    assert channel(given, YAW).measures.bias == pytest.approx(0.6, abs=0.01)
    assert channel(given, YAW).parting.at is not None


def test_a_step_is_found_as_the_parting_and_comes_first(two):
    step = {'step': (20.0, 0.3)}
    found = two(NOISY, OTHER | {'offset': 0.1234} | step)
    worst = found.channels[0]
    assert (worst.name, worst.verdict) == (Z, 'parted')
    assert worst.parting.at == pytest.approx(20.0, abs=0.05)
    assert found.verdict == 'different'
    assert 'at 20.0' in format_verdict(found)
    assert 'altitude of odom' in format_verdict(found)


def test_a_tolerance_takes_the_place_of_the_noise(two):
    step = OTHER | {'offset': 0.1234, 'step': (20.0, 0.3)}
    wide = two(NOISY, step, tolerances={'odom/*position*': 0.5})
    assert channel(wide, Z).parting.band == 0.5
    assert wide.verdict == 'same'
    with pytest.raises(BadInput, match=r"no channel of both flights matches 'nose'"):
        two(NOISY, step, tolerances={'nose': 0.5})


def test_an_offset_by_hand_is_taken_as_it_is(two):
    found = two(NOISY, OTHER | {'offset': 0.1234}, offset=0.2)
    assert (found.timing.how, found.timing.offset, found.timing.sigma) == ('given', 0.2, 0.0)
    lag = channel(found, Z).lag.lag
    assert lag == pytest.approx(0.1234 - 0.2, abs=0.01)


def test_the_same_stamps_are_one_clock(two):
    found = two(NOISY, NOISY | {'seed': 3})
    assert (found.timing.how, found.timing.offset) == ('none', 0.0)
    assert 'same time stamps' in found.timing.reason


def test_a_bag_beside_itself_is_identical(two):
    found = two(NOISY, NOISY)
    assert found.is_identical
    assert found.verdict == 'identical'
    assert found.identical_topics == ('odom',)
    assert format_verdict(found) == 'Identical: the only topic is identical in every value.'
    assert all(each.measures is None or each.measures.rms == 0.0 for each in found.channels)


def test_padding_makes_no_difference_but_a_letter_does(tmp_path):
    """Seven bytes behind the frame, before the first number; they hold what memory held."""
    kind = 'geometry_msgs/msg/Vector3Stamped'

    def record(name, changed, to):
        with BagWriter(tmp_path / name, {}) as bag:
            bag.add_topic('/lta1/wind', kind, [])
            for second in range(10):
                vector = make('geometry_msgs/msg/Vector3', x=1.0, y=2.0, z=3.0)
                header = stamped(second * 10**9, 'odom')
                message = make(kind, header=header, vector=vector)
                data = bytearray(load_jazzy_types().serialize_cdr(message, kind))
                assert data[12:28] == b'\5\0\0\0odom' + bytes(8)
                data[changed] = to
                bag.write('/lta1/wind', bytes(data), second * 10**9)
        return open_flight(tmp_path / name)

    clean, dirty = record('clean', 27, 0), record('dirty', 27, 0xFF)
    other = record('other', 19, ord('n'))
    assert compare_flights(clean, dirty, ComparisonRequest()).is_identical
    assert compare_flights(clean, dirty, ComparisonRequest()).identical_topics == ('wind',)
    assert not compare_flights(clean, other, ComparisonRequest()).is_identical


def test_gaps_are_never_bridged(two):
    found = two(NOISY, OTHER | {'offset': 0.1234, 'drop': (10.0, 15.0)})
    both = channel(found, Z).both
    inside = (both.time > 10.1) & (both.time < 14.9)
    assert not np.isfinite(both.difference[inside]).any()
    assert found.verdict == 'same'


def test_doubled_and_late_messages_make_no_difference(record):
    def at(k):
        covered = make('geometry_msgs/msg/PoseWithCovariance', pose=pose(0.01 * k, 0.0, 1.0, 0.0))
        time = 1_000_000_000 + 10_000_000 * k
        message = make(ODOMETRY, header=stamped(time, 'map'), pose=covered)
        return '/lta1/odom', ODOMETRY, message, time

    order = [*range(50), 49, *range(50, 80), 75, *range(80, 100)]
    a = open_flight(record([at(k) for k in range(100)], 'a'))
    b = open_flight(record([at(k) for k in order], 'b'))
    found = compare_flights(a, b, ComparisonRequest())
    assert not found.is_identical
    assert found.is_within_bands


def test_the_sentence_names_what_the_ranking_has_first(tmp_path):
    t = np.arange(0.0, 20.0, 0.02)
    chance = np.random.default_rng(0)

    def side(label, faster, slip):
        noise = 1e-4 * chance.normal(size=(3, len(t)))
        lines = {
            'odom/pose.pose.position.x': np.sin(t) + noise[0],
            'odom/twist.twist.linear.x': np.cos(t) + noise[1] + faster * (t > 5.0),
            'odom/twist.twist.linear.y': 0.1 * np.cos(t) + noise[2] + slip * (t > 8.0),
        }
        return side_of([Channel(name, 'm', t, line) for name, line in lines.items()], label)

    a, b = side('A', 0.0, 0.0), side('B', 0.01, 0.2)
    found = compare_sides(
        a, b, select_topic_pairs((), (), ['odom'], ['odom']), ComparisonRequest(align='none')
    )
    assert found.channels[0].name == 'odom/twist.twist.linear.y'
    assert format_verdict(found).startswith(
        'The flights diverge at 5.02 s, first in forward speed of odom'
    )
    assert 'and most in sideways speed of odom' in format_verdict(found)


def test_the_verdict_says_how_far_apart_the_positions_are():
    t = np.arange(0.0, 10.0, 0.02)
    ramp = np.clip(t - 3.0, 0.0, 1.0)  # 5 m away from 4 s on: 3 m along x and 4 m along y

    def side(label, share):
        lines = {'x': np.sin(t) + 3.0 * share * ramp, 'y': 4.0 * share * ramp, 'z': np.cos(t)}
        return side_of(
            [Channel(f'odom/pose.pose.position.{k}', 'm', t, line) for k, line in lines.items()],
            label,
        )

    found = compare_sides(
        side('A', 0.0),
        side('B', 1.0),
        select_topic_pairs((), (), ['odom'], ['odom']),
        ComparisonRequest(align='none', tolerances={'odom/*': 1e-9}),
    )
    said = format_verdict(found)
    assert said.endswith(
        ' The positions are up to 5 m apart, at 4.0 s, and 5 m at 10.0 s, the last time of both.'
    )


def test_a_bag_is_gone_through_a_few_times_whatever_it_holds(tmp_path, monkeypatch):
    write_flight(tmp_path / 'bag')
    flight = open_flight(tmp_path / 'bag')
    passes = []
    read = type(flight.bag).iterate_messages

    def counted(bag, topics=None):
        passes.append(topics)
        return read(bag, topics)

    monkeypatch.setattr(type(flight.bag), 'iterate_messages', counted)
    found = compare_flights(flight, flight, ComparisonRequest())
    assert found.verdict == 'identical'
    packed = {'lta_msgs/msg/LightBlock', 'lta_msgs/msg/LampPeaks'}
    single = [name for name in flight.topics if flight.message_type(name) in packed]
    assert len(flight.topics) > 5
    # All bytes once, all numbers once, and what has blocks or points by itself.
    assert len(passes) == 2 + len(single)
