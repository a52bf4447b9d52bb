# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The example for notebooks runs as the page shows it, and its figures are right."""

from pathlib import Path
import re
import runpy
import sys

from lta_bag.writer import BagWriter
from lta_config.topics import load_topic_table
from lta_flight.flight_spec import build_loop, load_spec
from lta_flight.messages import LoopRecorder
import numpy as np
import pytest
from rosbags.highlevel import AnyReader

ROOT = Path(__file__).resolve().parents[3]
EXAMPLE = ROOT / 'examples/analyse_a_bag.py'
PAGE = ROOT / 'docs/analysis.md'


@pytest.fixture(scope='module')
def flight(tmp_path_factory):
    """Return the bag of the flight that the page shows."""
    bag = tmp_path_factory.mktemp('flight') / 'bag'
    loop = build_loop(load_spec('gtmab', 'lamp_room', 'bag', ''), 3)
    with BagWriter(bag, {}) as writer:
        recorder = LoopRecorder(writer, loop, load_topic_table(), 'lta1')
        for _ in loop.iterate_steps():
            recorder.record_step()
    return bag


def forward(bag, topic):
    """Return the forward speeds of a topic by stamp, as rosbags decodes them [ns, m/s]."""
    with AnyReader([bag]) as reader:
        connections = [each for each in reader.connections if each.topic == topic]
        messages = [
            reader.deserialize(raw, each.msgtype) for each, _, raw in reader.messages(connections)
        ]
    return {
        m.header.stamp.sec * 10**9 + m.header.stamp.nanosec: m.twist.twist.linear.x
        for m in messages
    }


def test_the_example_prints_the_error_of_the_estimate_by_speed(flight, monkeypatch, capsys):
    monkeypatch.setattr(sys, 'argv', [str(EXAMPLE), str(flight)])
    runpy.run_path(str(EXAMPLE), run_name='__main__')
    shown = [line.rstrip() for line in capsys.readouterr().out.splitlines()]
    assert '\n'.join(shown) in PAGE.read_text(encoding='utf-8')
    title, names, _, *lines = shown
    assert title == 'Estimated less true airspeed [m/s]'
    assert names.split() == ['count', 'mean', 'std', 'min', 'max']
    estimate, truth = (
        forward(flight, '/lta1/airspeed'),
        forward(flight, '/lta1/ground_truth/odom'),
    )
    first = min(truth)
    even = [stamp for stamp in truth if (stamp - first) % 20_000_000 == 0]  # 50 Hz
    speed = np.array([round(truth[stamp], 1) for stamp in even])
    error = np.array([estimate[stamp] - truth[stamp] for stamp in even])
    rows = [[float(word) for word in line.split()] for line in lines]
    assert [row[0] for row in rows] == sorted(set(speed.tolist()))
    for at, count, mean, spread, least, most in rows:
        those = error[np.isclose(speed, at)]
        assert count == len(those)
        deviation = those.std(ddof=1) if count > 1 else np.nan
        np.testing.assert_allclose(
            [mean, spread, least, most],
            [those.mean(), deviation, those.min(), those.max()],
            atol=5.1e-5,
        )
    assert len(rows) > 3


def test_the_page_shows_the_example_as_it_is():
    code = EXAMPLE.read_text(encoding='utf-8').split('"""', 2)[2].strip()
    blocks = re.findall(r'```python\n(.*?)```', PAGE.read_text(encoding='utf-8'), re.DOTALL)
    assert code in {block.strip() for block in blocks}
