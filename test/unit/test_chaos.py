"""The tools of `make chaos` and `make soak`: what spoils messages, writes a page, sees a leak."""

import math
from pathlib import Path
import sys

from lta_config.topics import topic_table
from lta_graph.ros.message_types import message_type
from lta_graph.ros.stamps import from_stamp
import numpy as np
import pytest
from rclpy.serialization import deserialize_message, serialize_message

FOLDER = Path(__file__).resolve().parents[1] / 'score'
sys.path.append(str(FOLDER))

from chaos_spoilt import AGE_NS, spoil, SPOILT  # noqa: E402
import reliability  # noqa: E402
from soak_memory import LEAK, slope_of  # noqa: E402

TOPICS = topic_table().topics


@pytest.mark.parametrize('kind', SPOILT)
def test_any_topic_can_be_spoilt_and_sent(kind):
    for name, row in TOPICS.items():
        message = message_type(row)()
        if hasattr(message, 'header'):
            message.header.stamp.sec = 1000
        spoilt = spoil(kind, message)
        back = deserialize_message(serialize_message(spoilt), type(message))
        assert type(back) is type(message), name
        if hasattr(message, 'header') and kind in ('stale', 'future'):
            by = from_stamp(back.header.stamp) - from_stamp(message.header.stamp)
            assert by == (AGE_NS if kind == 'future' else -AGE_NS)


def test_what_is_spoilt_is_what_it_says():
    odom = message_type(TOPICS['odom'])()
    assert math.isnan(spoil('nan', odom).pose.pose.position.z)
    assert np.isnan(spoil('nan', odom).pose.covariance).all()
    motors = message_type(TOPICS['motors'])()
    motors.name, motors.effort = ['a', 'b'], [0.1, 0.2]
    assert len(spoil('lengths', motors).effort) == 3
    assert list(spoil('names', motors).name) != ['a', 'b']
    assert motors.name == ['a', 'b']  # a copy was spoilt


def test_each_command_writes_its_own_part_of_the_page(tmp_path, monkeypatch):
    monkeypatch.setattr(reliability, 'PAGE', tmp_path / 'page.md')
    by_hand = '# Reliability\n\nHow a fault comes to be named.\n'
    (tmp_path / 'page.md').write_text(by_hand)
    reliability.put('soak', '## Long\n\nfirst')
    reliability.put('chaos', '## Trouble')
    reliability.put('soak', '## Long\n\nsecond\n')
    page = (tmp_path / 'page.md').read_text()
    assert page.index('## Trouble') < page.index('## Long')
    assert 'second' in page
    assert 'first' not in page
    assert page.count('written by make') == 4
    assert page.startswith(by_hand)


@pytest.mark.parametrize(('leak', 'flat'), [(0.0, True), (3.0 * LEAK, False)])
def test_a_leak_is_told_from_noise(leak, flat):
    """Two hours with a look each 5 s, and 1 MB of noise that hangs together over a minute."""
    times = np.arange(0.0, 7200.0, 5.0)
    noise = np.convolve(
        np.random.default_rng(1).normal(size=len(times)), np.ones(12) / 3.5, 'same'
    )
    found = slope_of(times, 100.0 + noise + leak * times / 3600.0)
    assert found.flat == flat
    assert abs(found.slope - leak) < 2.0 * found.within
