# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The data of the 3-D view: tracks at common times, and their encoding."""

import base64
import json
import re

from lta_model.vehicle import load_vehicle
from lta_report.flight_scene import (
    draw_vehicle,
    FanFlight,
    hold_columns,
    interpolate_attitude,
    pack_column,
    render_fan,
    render_scene,
    sample_times,
    SceneFlight,
    SceneSet,
)
import numpy as np
import pytest

HALF = np.sqrt(0.5)


def test_an_attitude_turns_the_short_way_whatever_the_sign_of_its_quaternion():
    """Half way between no turn and a quarter turn about z lies an eighth."""
    quarter = np.array([0.0, 0.0, HALF, HALF])
    level = np.array([0.0, 0.0, 0.0, 1.0])
    for sign in (1.0, -1.0):
        found = interpolate_attitude(
            np.array([0.5]), np.array([0.0, 1.0]), np.stack([level, sign * quarter])
        )
        eighth = [0.0, 0.0, np.sin(np.pi / 8), np.cos(np.pi / 8)]
        assert found[0] == pytest.approx(eighth)


def test_a_value_is_held_until_it_is_too_old():
    found = hold_columns(
        np.array([0.5, 1.0, 1.4, 1.6]), np.array([1.0]), np.array([[7.0, 8.0]]), longest=0.5
    )
    assert np.isnan(found[[0, 3]]).all()
    assert found[[1, 2]].tolist() == [[7.0, 8.0], [7.0, 8.0]]


def test_a_column_is_packed_to_within_its_resolution():
    values = np.array([0.0, -3.2, np.nan, 1.6])
    packed = pack_column(values)
    numbers = np.frombuffer(base64.b64decode(packed['data']), '<i2')
    assert numbers[2] == -32768
    assert numbers[[0, 1, 3]] * packed['scale'] == pytest.approx(values[[0, 1, 3]], abs=1e-4)


def test_a_long_flight_is_sampled_no_more_often_than_a_page_can_hold():
    assert len(sample_times(0.0, 10.0)) == 202
    assert len(sample_times(0.0, 3600.0)) == 1500


def test_names_of_strangers_are_words_in_the_view():
    time = np.array([0.0, 1.0])
    body, reach, vehicle = draw_vehicle(None)
    assert (reach, vehicle) == (0.5, None)
    evil = '</script><script>alert(1)</script>'
    flight = SceneFlight(evil, '#0b62a8', body, np.zeros((2, 3)), np.zeros((2, 4)))
    panel = render_scene([SceneSet(time, [flight])], [], 'About.', reach)
    assert '<script>alert' not in panel
    assert render_scene([], [], 'About.', reach) == ''


def test_flights_of_a_fan_begin_together_and_stay_where_they_ended():
    level = [0.0, 0.0, 0.0, 1.0]
    short = FanFlight('short', '#0b62a8', np.array([[0.0, 1.0, 0.0, 1.0, *level],
                                                    [1.0, 2.0, 0.0, 1.0, *level]]))  # fmt: skip
    long = FanFlight('long', '#c8500a', np.array([[0.0, 1.0, 0.0, 1.0, *level],
                                                  [4.0, 9.0, 0.0, 1.0, *level]]))  # fmt: skip
    panel, bar, track = render_fan([short, long], load_vehicle('gtmab').file, [], 'About.')
    assert 'Play the flights' in bar
    assert (track['time'][0], track['time'][-1]) == (0.0, 4.0)
    (text,) = re.findall(r'<script[^>]*id="scene"[^>]*>(.*?)</script>', panel, re.DOTALL)
    (fan,) = json.loads(text)['sets']
    ends = []
    for flight in fan['flights']:
        along = flight['position'][0]
        ends.append(np.frombuffer(base64.b64decode(along['data']), '<i2')[-1] * along['scale'])
    assert ends == pytest.approx([2.0, 9.0], abs=1e-3)
    assert render_fan([], load_vehicle('gtmab').file, [], 'About.') == ('', '', {})
