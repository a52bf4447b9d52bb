# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The 3-D view of two flights: where both are at one time, and when it is left out."""

from lta_analysis.comparison.report import build_report
from lta_data.compare.channel_comparison import select_topic_pairs
from lta_data.compare.comparison import compare_sides, ComparisonRequest
from lta_data.flight import Channel
import numpy as np
import pytest

from .compare_flight import side_of

T = np.arange(0.0, 10.0, 0.02)
REQUEST = ComparisonRequest(align='none', frames='none')


def build_page(a, b):
    """Return the report of two flights, each given by its fields."""
    sides = [
        side_of(
            [
                Channel(f'odom/pose.pose.{name}', 'rad' if 'yaw' in name else 'm', T, values)
                for name, values in fields.items()
            ],
            label,
        )
        for label, fields in (('A', a), ('B', b))
    ]
    return build_report(
        compare_sides(*sides, select_topic_pairs((), (), ['odom'], ['odom']), REQUEST)
    )


def fly(east, turn):
    """Return a flight north at 1 m/s."""
    still = 0.0 * T
    return {
        'position.x': east + still,
        'position.y': T,
        'position.z': 1.0 + still,
        'orientation.yaw': np.pi / 2 + turn + still,
    }


def test_both_flights_are_drawn_at_one_time_with_their_distance():
    gap = np.where((T > 6.0) & (T < 8.0), np.nan, 0.0)
    page = build_page(fly(0.0, 0.0), fly(2.0 + gap, 0.5))
    at = np.array(page.track['time'])
    assert at[[0, -1]].tolist() == pytest.approx([T[0], T[-1]])
    absent = (at > 6.05) & (at < 7.95)
    present = np.abs(at - 7.0) > 1.05
    for name, expected in (('apart', 2.0), ('turned', np.degrees(0.5))):
        values = np.array(page.track[name], dtype=float)
        assert values[present] == pytest.approx(expected, abs=1e-3)
        assert np.isnan(values[absent]).all()
    for name in 'AB':
        assert f'</i>{name}</li>' in page.scene
    assert 'id="time"' in page.time_bar


def test_without_positions_there_is_no_view():
    page = build_page({'position.z': T}, {'position.z': T + 1.0})
    assert (page.scene, page.time_bar) == ('', '')
