# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Recorded wind: read strictly, interpolated, and felt by the hull."""

from lta_config.errors import BadInput
from lta_model.scenario import load_scenario
from lta_model.state import QUATERNION, SURROUNDINGS, VELOCITY, WIND, WIND_RATE
from lta_sim.kernels.kernel import advance
from lta_sim.scene_model import load_wind_record
from lta_sim.wind_record import WindRecord
import numpy as np
import pytest
from scipy.spatial.transform import Rotation
import yaml

from . import flat_balloon as balloon
from .lamp_room import build, edited, fly, ROOM


def file(tmp_path, text):
    path = tmp_path / 'wind.csv'
    path.write_text(text)
    return path


def series(tmp_path, rows, head='t,u,v,w\n'):
    return file(tmp_path, head + ''.join(','.join(map(str, row)) + '\n' for row in rows))


ROWS = [(100.0, 0.0, 0.0, 0.0), (101.0, 1.0, -0.5, 0.2), (102.5, 1.0, 1.0, 0.0), (104, 0, 0, 0)]


def test_it_begins_with_the_flight_and_is_interpolated(tmp_path):
    record = WindRecord.read(series(tmp_path, ROWS), 4.0)
    assert record.time.tolist() == [0.0, 1.0, 2.5, 4.0]
    wind, rate = record.average_wind_over_span(0.4, 0.6)
    np.testing.assert_allclose(wind, (0.5, -0.25, 0.1), rtol=1e-15)
    np.testing.assert_allclose(rate, (1.0, -0.5, 0.2), rtol=1e-12)
    wind, rate = record.average_wind_over_span(0.9, 1.1)  # over a corner: the mean rate
    np.testing.assert_allclose(wind, (1.0, -0.5, 0.2))
    np.testing.assert_allclose(rate, (0.5, 0.25, (0.2 * (1 - 0.1 / 1.5) - 0.18) / 0.2))


def test_comments_and_empty_lines_are_passed_over(tmp_path):
    text = '# anemometer 3\n\nt,u,v,w\n0,1,0,0\n# a remark\n1,1,0,0\n'
    assert len(WindRecord.read(file(tmp_path, text), 1.0).time) == 2


@pytest.mark.parametrize(
    ('text', 'sentence'),
    [
        ('time,u,v\n0,1,0\n', 'begins with "time,u,v" instead of the header "t,u,v,w";'),
        ('t,u,v,w\n0,1,0,0\n', 'has 1 rows below its header; at least two are needed.'),
        (
            't,u,v,w\n0,1,0,0\n1,nan,0,0\n',
            'has "1,nan,0,0" in line 3; the line must have four finite',
        ),
        ('t,u,v,w\n0,1,0,0\n1,,0,0\n', 'has "1,,0,0" in line 3; the line must have four finite'),
        ('t,u,v,w\n0,1,0\n', 'has "0,1,0" in line 2; the line must have four finite'),
        (
            't,u,v,w\n0,1,0,0\n1,-99,0,0\n',
            'has a wind of -99 m/s in line 3; at most 60 m/s are allowed.',
        ),
        ('t,u,v,w\n0,1,0,0\n2,1,0,0\n1,1,0,0\n', 'has t = 1 s after t = 2 s; sort its rows'),
        ('t,u,v,w\n0,1,0,0\n0,1,0,0\n', 'has t = 0 s after t = 0 s; sort its rows'),
        (
            't,u,v,w\n0,1,0,0\n1,1,0,0\n2,1,0,0\n3,1,0,0\n9,1,0,0\n',
            'has a gap of 6 s after t = 3 s, where rows are 1 s apart;',
        ),
        ('t,u,v,w\n0,1,0,0\n1,1,0,0\n', 'lasts 1 s, but the flight may take 5 s; give a longer'),
    ],
)
def test_what_is_wrong_with_a_file_is_one_sentence(tmp_path, text, sentence):
    with pytest.raises(BadInput) as caught:
        WindRecord.read(file(tmp_path, text), 5.0)
    assert sentence in str(caught.value)
    assert '\n' not in str(caught.value)


def test_bytes_that_are_no_text_and_no_file_at_all(tmp_path):
    path = tmp_path / 'wind.csv'
    path.write_bytes(b't,u,v,w\n\xff\xfe')
    with pytest.raises(BadInput, match='cannot be read'):
        WindRecord.read(path, 1.0)
    with pytest.raises(BadInput, match='cannot be read'):
        WindRecord.read(tmp_path / 'none.csv', 1.0)


def test_it_stands_beside_the_scenario(tmp_path, monkeypatch):
    series(tmp_path, [(t, 0.3, 0.0, 0.0) for t in range(61)])
    content = edited(ROOM, {'air/recorded': 'wind.csv'})
    (tmp_path / 'scene.yaml').write_text(yaml.safe_dump(content))
    scenario = load_scenario(str(tmp_path / 'scene.yaml'))
    assert scenario.wind_file == tmp_path / 'wind.csv'
    assert load_wind_record(scenario).average_wind_over_span(0.0, 0.01)[0][0] == 0.3
    monkeypatch.chdir(tmp_path.parent)
    assert load_scenario(f'{tmp_path.name}/scene.yaml').wind_file == tmp_path / 'wind.csv'


def test_a_steady_record_is_a_steady_wind_to_the_bit(tmp_path):
    path = series(tmp_path, [(t, 0.4, -0.2, 0.1) for t in range(0, 61, 10)])
    one = build(scene={'air/recorded': str(path)})
    two = build(scene={'air/wind': {'value': [0.4, -0.2, 0.1], 'unit': 'm/s'}})
    fly(one, 100, (0.3, 0.3, 0.2, 0.1))
    fly(two, 100, (0.3, 0.3, 0.2, 0.1))
    np.testing.assert_array_equal(one.state, two.state)
    assert one.wind == two.wind == pytest.approx((0.4, -0.2, 0.1))


def test_a_record_adds_to_the_steady_wind_and_moves_the_hull(tmp_path):
    path = series(tmp_path, [(t, 0.01 * t, 0.0, 0.0) for t in range(61)])
    steady = {'value': [0.0, 0.2, 0.0], 'unit': 'm/s'}
    world = build(scene={'air/recorded': str(path), 'air/wind': steady})
    calm = build()
    fly(world, 1000, (0.5, 0.5, 0.0, 0.0))
    fly(calm, 1000, (0.5, 0.5, 0.0, 0.0))
    # The period that begins at 10 s has the wind of 10.005 s.
    assert world.wind == pytest.approx((0.10005, 0.2, 0.0), rel=1e-12)
    assert world.state[0] - calm.state[0] > 0.02
    assert world.state[1] - calm.state[1] > 0.1


def test_an_inviscid_neutral_balloon_goes_with_the_recorded_air_exactly(tmp_path):
    """Displaced and added mass alike are pushed by the pressure gradient of dU/dt."""
    record = WindRecord.read(series(tmp_path, ROWS), 4.0)
    model = balloon.model(balloon.NEUTRAL | balloon.ADDED, (0.0, 0.0, 0.0), displaced=balloon.MASS)
    state, around = balloon.at(), np.zeros(SURROUNDINGS)
    for k in range(400):
        wind, rate = record.average_wind_over_span(k * 0.01, (k + 1) * 0.01)
        around[WIND : WIND + 3], around[WIND_RATE : WIND_RATE + 3] = wind, rate
        state = advance(state, model, np.zeros(4), around, 0.005, 2)
        now = [np.interp((k + 1) * 0.01, record.time, axis) for axis in record.wind.T]
        # Within a period the held wind is up to 5 mm/s beside that of the hull: enough for a
        # Munk moment that turns a flat hull by a little.
        flown = Rotation.from_quat(state[QUATERNION]).apply(state[VELOCITY])
        np.testing.assert_allclose(flown, now, atol=1e-7)
