"""What a live view hands on: never more than its pace, and every gap is counted."""

import struct

from hypothesis import given
from hypothesis import strategies as st
from lta_bridge.live.origin_gate import build_app_url, check_port_available
from lta_bridge.live.server import RateLimiter, SCREEN_RATE, TopicThrottle
from lta_config.errors import BadInput
from lta_config.topics import load_topic_table
import pytest

TABLE = load_topic_table()
START, MS, S = TABLE.start_ns, 10**6, 10**9


def cdr(stamp):
    """Return the beginning of a serialised message."""
    return b'\0\1\0\0' + struct.pack('<iI', *divmod(stamp, S)) + bytes(8)


class Wall:
    """A clock that is set by hand. [s]"""

    def __init__(self):
        self.now = 100.0

    def __call__(self):
        return self.now


@given(st.lists(st.floats(0.0, 0.05), min_size=1, max_size=200), st.sampled_from([10.0, 60.0]))
def test_no_stretch_of_time_has_more_than_its_share(gaps, rate):
    pace, now, passed = RateLimiter(rate), 0.0, []
    for gap in gaps:
        now += gap
        if pace.try_acquire(now):
            passed.append(now)
        else:  # nor does it starve
            assert now - passed[-1] < 2.0 / rate
    for first, start in enumerate(passed):
        for last in range(first, len(passed)):
            assert last - first + 1 <= rate * (passed[last] - start) + 2 + 1e-6


@given(st.lists(st.floats(-0.4, 0.4), min_size=2, max_size=100))
def test_what_comes_at_the_pace_passes_whole_however_unsteady(jitter):
    pace = RateLimiter(10.0)
    assert all(pace.try_acquire(0.1 * (k + early)) for k, early in enumerate(jitter))


def test_a_fast_flight_is_thinned_and_the_gaps_are_counted():
    wall = Wall()
    feed = TopicThrottle(TABLE, wall)
    shown = []
    for k in range(1000):  # 10 s of flight within 1 s: 1000 messages of odom
        wall.now += 0.001
        if feed.admit_message('odom', cdr(START + 10 * k * MS), has_viewers=True) is not None:
            shown.append(k)
    assert SCREEN_RATE - 1 <= feed.sent['odom'] == len(shown) <= SCREEN_RATE + 2
    assert feed.left_out['odom'] == shown[-1] - shown[0] + 1 - len(shown)


def test_what_the_middleware_dropped_is_counted_as_well():
    wall = Wall()
    feed = TopicThrottle(TABLE, wall)
    for k in (0, 1, 5):
        wall.now += 1.0
        assert (
            feed.admit_message('imu', cdr(START + 10 * k * MS), has_viewers=True)
            == START + 10 * k * MS
        )
    assert (feed.sent, feed.left_out) == ({'imu': 3}, {'imu': 3})


def test_nobody_misses_what_nobody_looks_at():
    wall = Wall()
    feed = TopicThrottle(TABLE, wall)
    for k, wanted in enumerate((True, False, False, True)):
        wall.now += 1.0
        feed.admit_message('imu', cdr(START + 10 * k * MS), has_viewers=wanted)
    assert (feed.sent, feed.left_out) == ({'imu': 2}, {})


def test_log_times_are_those_of_a_recording():
    wall = Wall()
    feed = TopicThrottle(TABLE, wall)
    assert feed.admit_message('photodiodes', cdr(START), has_viewers=True) == START + 100 * MS
    assert (
        feed.admit_message('energy/reserve', b'\0\1\0\0\1', has_viewers=True) == START + 100 * MS
    )
    assert feed.admit_message('/diagnostics', cdr(START), has_viewers=True) == START + 100 * MS


def test_light_blocks_come_ten_times_a_second_and_diagnostics_all():
    wall = Wall()
    feed = TopicThrottle(TABLE, wall)
    for k in range(90):  # a second at nine times real time
        wall.now += 1.0 / 90.0
        feed.admit_message('photodiodes', cdr(START + 100 * k * MS), has_viewers=True)
        feed.admit_message('/diagnostics', cdr(START), has_viewers=True)
    assert 10 <= feed.sent['photodiodes'] <= 11
    assert feed.sent['/diagnostics'] == 90


def test_the_address_is_the_one_that_foxglove_opens():
    url = 'https://app.foxglove.dev/?ds=foxglove-websocket&ds.url=ws://localhost:8765'
    assert build_app_url(8765) == url


def test_an_address_of_another_machine_is_refused():
    with pytest.raises(BadInput, match=r'Port 8765 cannot be used for the live view \(.+\); stop'):
        check_port_available('192.0.2.1', 8765)
