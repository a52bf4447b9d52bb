# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The results of a flight against figures worked out by hand."""

import math

from lta_data.bag import open_flight
from lta_data.compare.sampling import wrap_angle
from lta_flight.report.page import build_tiles
from lta_flight.report.results import compute_results, FlightResults
from lta_flight.report.view import FlightView
from lta_report.curves import hold_last, TimeCurve
import numpy as np
import pytest

from ...report_flight import header, make, Stream, vector, write_flight  # noqa: TID252 - `test` is Python's own


def results(folder):
    return compute_results(FlightView(open_flight(folder)))


@pytest.fixture(scope='module')
def found(tmp_path_factory):
    return results(write_flight(tmp_path_factory.mktemp('flight') / 'bag'))


BY_HAND = {
    'success': True,
    'search_start': 4.0,
    'end': 16.0,
    'search_time': 12.0,
    'path_length': 6.0,
    'straight_length': 6.0,
    'closest_horizontal': 1.0,
    'forward_airspeed': 0.5,
    'forward_airspeed_spread': 0.0,
    'altitude': 0.5,
    'altitude_error': 0.0,
    'heading_error': 0.0,
    'lamp_error': 0.02,  # what the drone steers by
    'lamp_share': 110 / 120,
    'bearing_error': 0.05,  # the paper's
    'bearing_share': 100 / 120,  # blocks of 12 s, those of 2 s without
    # 10 x 500 counts m2 / r^2 at the median of the first and last five blocks, 6.9 m and 1.15 m
    'snr_start': 5000.0 / 6.9**2,
    'snr_end': 5000.0 / 1.15**2,
    'power': 1.6,  # 4 V times 400 mA
    'cruise_power': 1.6,
}


def test_figures_by_hand(found):
    for name, value in BY_HAND.items():
        assert getattr(found, name) == pytest.approx(value, rel=1e-6, abs=1e-12), name
    assert found.lift_off == pytest.approx(2.25, abs=0.021)  # 1 cm of 8 cm in 2 s, truth at 50 Hz
    assert found.flight_time == pytest.approx(16.0 - found.lift_off)
    assert found.energy == pytest.approx(1.6 * found.flight_time, rel=1e-6)


def test_the_tile_is_of_what_the_drone_steers_by(found):
    (tile,) = [each for each in build_tiles(found) if each.name == 'Direction of the lamp']
    assert (tile.value, tile.unit) == ('1.1', '° median error')
    # The errors of the scene are constant, so that medians and RMS are equal
    assert tile.note == "RMS 1.1° with the last blocks; paper's bearing: median 2.9°, RMS 2.9°"


def test_estimator_errors(found):
    assert found.altitude_estimate_error == pytest.approx(0.02)
    total = round((found.end - found.lift_off) / 0.01) + 1  # estimates in flight, 1201 cruising
    # One more falls between two samples of the truth, at rest and at 0.5 m/s: it is 0.25 m/s off.
    squares = 1201 * 0.05**2 + 0.25**2
    assert found.airspeed_estimate_error == pytest.approx(math.sqrt(squares / total))
    squares = 1200 * 1201 * 2401 / 6  # of 0, 1, ... 1200
    assert found.heading_estimate_error == pytest.approx(1e-4 * math.sqrt(squares / total))
    assert found.heading_drift == pytest.approx(0.12)


def test_estimate_is_laid_on_the_truth_where_both_begin(tmp_path):
    view = FlightView(open_flight(write_flight(tmp_path / 'bag', until=8.0)))
    truth_x = np.interp(view.estimate.time, view.truth.time, view.truth.x)
    np.testing.assert_allclose(view.estimate.x, truth_x, atol=1e-9)
    np.testing.assert_allclose(view.estimate.y, 0.0, atol=1e-9)
    np.testing.assert_allclose(view.heading_setpoint.value, 0.0, atol=1e-9)


def test_range_is_raised_to_the_hull_centre(tmp_path):
    view = FlightView(open_flight(write_flight(tmp_path / 'bag', until=1.0)))
    np.testing.assert_allclose(view.range_altitude.value, 0.42, atol=1e-6)


def test_wind_is_taken_off_the_speed(tmp_path):
    wind = Stream(
        0.1,
        lambda t: make(
            'geometry_msgs/msg/Vector3Stamped', header=header(t), vector=vector(-0.2, 0.1, 0.0)
        ),
    )
    folder = write_flight(tmp_path / 'bag', instead={'wind': wind})
    assert results(folder).forward_airspeed == pytest.approx(0.7)


def test_flight_that_ends_early_has_not_reached(tmp_path):
    found = results(write_flight(tmp_path / 'bag', until=10.0))
    assert found.success is False
    assert found.flight_time is None
    assert found.search_time is None
    assert found.closest_horizontal == pytest.approx(4.0)  # 3 m of 7 m flown
    assert found.path_length == pytest.approx(3.0)


@pytest.mark.parametrize(
    ('missing', 'unknown', 'known'),
    [
        (
            'ground_truth/odom',
            ['success', 'forward_airspeed', 'heading_drift', 'energy'],
            ['snr_end'],
        ),
        ('odom', ['altitude_estimate_error', 'heading_drift'], ['forward_airspeed', 'energy']),
        ('battery', ['energy', 'power', 'cruise_power'], ['forward_airspeed']),
        ('light/bearing', ['bearing_error', 'bearing_share'], ['snr_start', 'lamp_error']),
        ('light/estimate', ['lamp_error', 'lamp_share'], ['snr_start', 'bearing_error']),
        ('light/peaks', ['snr_start', 'snr_end'], ['bearing_error']),
        ('setpoint/velocity', ['search_time', 'forward_airspeed', 'snr_start'], ['path_length']),
        ('setpoint/pose', ['altitude_error'], ['altitude']),
        ('wind', [], ['forward_airspeed']),
    ],
)
def test_missing_topic_leaves_its_figures_unknown(tmp_path, missing, unknown, known):
    found = results(write_flight(tmp_path / 'bag', without=[missing]))
    assert [name for name in unknown if getattr(found, name) is not None] == []
    assert [name for name in known if getattr(found, name) is None] == []


def test_without_scenario_nobody_knows_where_the_lamp_is(tmp_path):
    found = results(write_flight(tmp_path / 'bag', facts={'seed': '1'}))
    assert (found.success, found.path_length, found.bearing_error) == (None, None, None)
    assert found.end == pytest.approx(17.0)


def test_a_whole_recording_tells_every_figure(found):
    assert [name for name, value in found.to_dict().items() if value is None] == [
        'gas_warmth', 'gas_lift',  # there is no sun in the lamp room
    ]  # fmt: skip


def test_every_figure_says_what_it_is():
    for field in FlightResults.__dataclass_fields__.values():
        assert set(field.metadata) == {'unit', 'about', 'digits', 'display'}
        assert field.metadata['about']


def test_wrapped_angles():
    given = np.array([0.0, 3.2, -3.2, 2 * math.pi, math.pi])
    expected = [0.0, 3.2 - 2 * math.pi, 2 * math.pi - 3.2, 0.0, -math.pi]
    np.testing.assert_allclose(wrap_angle(given), expected, atol=1e-12)


def test_set_point_holds_until_the_next_one():
    track = TimeCurve(np.array([1.0, 2.0]), np.array([5.0, 7.0]))
    given = hold_last(np.array([0.5, 1.0, 1.9, 2.0, 9.0]), track)
    np.testing.assert_array_equal(given, [np.nan, 5.0, 5.0, 7.0, 7.0])
