# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""lta light calibrate: known diodes of a simulated board that turns, found again."""

from dataclasses import replace
import json
import math

from lta_config.errors import BadInput
from lta_config.files import find_file
from lta_config.schema.vehicle_file import load_vehicle_file
from lta_model.light.view import LightView
from lta_studies.light.bearing.bench import (
    BEARING_PLACES,
    BearingBench,
    build_flight_spec,
    pose_for_lamp_direction,
)
from lta_studies.light.turn.readings import (
    align_directions,
    fit_response,
    summarize_directions,
    TurnReadings,
)
from lta_vlc.diodes import build_diode_array, build_even_ring
import numpy as np
import pytest
import yaml

from ...conftest import header  # noqa: TID252 - `test` is Python's own

GAINS = np.array([1.03, 0.98, 1.0, 0.97, 1.05, 0.99, 1.01, 0.97])
STEP, HOLD_BLOCKS, START = math.radians(22.5), 6, 1_000_000_000
ZERO = math.radians(1.5)  # by which the nose was off the lamp


def readings_of(exponent, noise=0.0, blocks=4):
    """A ring before a far lamp in an even pedestal of 8 %."""
    ring = build_even_ring(8)
    direction = np.repeat(np.arange(16) * STEP, blocks)
    axes = np.array([math.atan2(y, x) for x, y, _ in ring.axes])
    cosine = np.maximum(np.cos(direction[:, None] - axes), 0.0)
    amplitude = 900.0 * GAINS * (cosine**exponent + 0.08)
    amplitude += noise * np.random.default_rng(1).normal(size=amplitude.shape)
    nothing = np.zeros(len(direction))
    return TurnReadings(direction, direction + 0.01, direction - 0.02, nothing, amplitude), ring


@pytest.mark.parametrize('exponent', [1.0, 1.35])
def test_exponent_gains_and_pedestal_are_found_again(exponent):
    found = fit_response(*readings_of(exponent))
    assert found.exponent == pytest.approx(exponent, abs=1e-4)
    assert found.gains == pytest.approx(tuple(GAINS), abs=1e-4)
    assert found.strength == pytest.approx(900.0, rel=1e-4)
    assert found.pedestal == pytest.approx(0.08, abs=1e-4)
    assert found.gain_spread == pytest.approx(np.std(GAINS, ddof=1), abs=1e-4)


def test_the_deviations_hold_what_noise_does():
    found = fit_response(*readings_of(1.2, noise=9.0))
    assert abs(found.exponent - 1.2) < 4.0 * found.exponent_deviation < 0.2
    off = np.abs(np.array(found.gains) - GAINS) / np.array(found.gain_deviations)
    assert off.max() < 5.0


def test_errors_by_direction_by_hand():
    readings, _ = readings_of(1.0)
    found = summarize_directions(readings)
    assert found.blocks == [4] * 16
    assert found.paper == pytest.approx((0.01,) * 16)
    assert found.ours == pytest.approx((0.02,) * 16)


@pytest.mark.parametrize('start', [0.0, 1.0, math.pi])
def test_where_the_nose_was_at_first_does_not_matter(start):
    readings, _ = readings_of(1.0)
    turned = replace(readings, direction=readings.direction - start)
    found = summarize_directions(align_directions(turned))
    assert found.ours == pytest.approx((0.0,) * 16, abs=1e-12)
    assert found.paper == pytest.approx((0.03,) * 16)


def test_half_a_turn_is_refused_by_the_directions_it_lacks():
    readings, _ = readings_of(1.0)
    some = readings.direction < math.pi
    half = TurnReadings(*(getattr(readings, name)[some] for name in TurnReadings.__slots__))
    with pytest.raises(BadInput, match=r'at a bearing of 180, 202\.5'):
        summarize_directions(half)


def record_turn(record, types, diodes, bench, turned, odometry=False):
    """Record the blocks of a board 3 m before the lamp at a list of headings [rad]."""
    chance = np.random.default_rng(5)
    messages = []
    for k, heading in enumerate(turned):
        view = LightView(bench.scenario.light_field, bench._vehicle, diodes)
        view.record_pose(pose_for_lamp_direction(bench, ZERO - heading))
        time = START + k * 100_000_000
        block = view.sample_light_block(time, 1e4, 1000, chance)
        message = types['lta_msgs/msg/LightBlock'](
            header(time), 1e4, 8, block.astype(np.uint16).ravel()
        )
        messages.append(('/lta1/photodiodes', 'lta_msgs/msg/LightBlock', message, time))
        if odometry:
            messages.append(
                ('/lta1/odom', 'nav_msgs/msg/Odometry', odom(types, time, heading), time)
            )
    return record(messages)


def odom(types, time, heading):
    """Return odometry at the origin with a heading."""
    names = 'geometry_msgs/msg/'
    still = types[names + 'Vector3'](0.0, 0.0, 0.0)
    turn = types[names + 'Quaternion'](0.0, 0.0, math.sin(heading / 2), math.cos(heading / 2))
    pose = types[names + 'Pose'](types[names + 'Point'](0.0, 0.0, 1.0), turn)
    none = np.zeros(36)
    return types['nav_msgs/msg/Odometry'](
        header(time),
        'base_link',
        types[names + 'PoseWithCovariance'](pose, none),
        types[names + 'TwistWithCovariance'](types[names + 'Twist'](still, still), none),
    )


@pytest.fixture
def bench():
    return BearingBench(build_flight_spec(BEARING_PLACES['indoor'], 'gtmab', 8))


@pytest.fixture
def bag(record, types, bench):
    """The simulated board 3 m before the lamp, turned by 22.5 degrees every 0.6 s."""
    diodes = bench.sample_diode_gains(np.random.default_rng(5))
    turned = [(k // HOLD_BLOCKS) * STEP for k in range(16 * HOLD_BLOCKS)]
    return record_turn(record, types, diodes, bench, turned)


def test_a_turn_in_place_gives_gains_and_response_for_the_vehicle_file(
    call, record, types, bench, tmp_path
):
    """The diodes are off by 5 % and have another response; the lines go into a file that loads."""
    chance = np.random.default_rng(6)
    gains = 1.0 + 0.05 * chance.standard_normal(8)
    gains /= gains.mean()
    diodes = bench.sample_diode_gains(chance).model_copy(
        update={'gains': tuple(gains.tolist()), 'response': 1.6}
    )
    turned = np.arange(200) * math.tau * 1.05 / 200 - 0.7
    turn = record_turn(record, types, diodes, bench, turned.tolist(), odometry=True)
    status, said = call('light', 'calibrate', turn, '--json', '--out', tmp_path / 'out')
    assert status == 0, said.err
    told = json.loads(said.out)
    response = told['response']
    assert response['exponent'] == pytest.approx(1.6, abs=0.08)
    assert response['gains'] == pytest.approx(gains.tolist(), abs=0.012)
    # Written into the vehicle file, they load, and the drone assumes them
    words = {name: yaml.safe_load(text) for name, text in told['entries'].items()}
    values = yaml.safe_load(find_file('vehicle', 'gtmab').read_text())
    values['sensors']['diodes'].update(words)
    path = tmp_path / 'calibrated.yaml'
    path.write_text(yaml.safe_dump(values))
    known = build_diode_array(load_vehicle_file(str(path)).sensors.diodes)
    assert known.gains == pytest.approx(gains.tolist(), abs=0.012)
    assert known.spread < 0.012


def test_a_bag_without_odometry_is_refused(call, bag):
    status, said = call('light', 'calibrate', bag)
    assert status == 2
    assert said.err.startswith('The recording has no topic odom, so its turn is unknown; record')


def test_a_simulated_turntable_is_studied(call, bag, tmp_path):
    words = ('--step', '22.5', '--hold', '0.6', '--out', tmp_path / 'out', '--json')
    status, said = call('light', 'calibrate', bag, *words)
    assert status == 0, said.err
    told = json.loads(said.out)
    assert told['diodes'] == 8
    assert told['blocks'] == [4] * 16  # of six, the first and the last of each hold are left
    assert math.degrees(np.median(told['fit'])) < 1.0
    assert told['response']['exponent'] == pytest.approx(1.2, abs=0.05)
    assert 'Error by direction' in (tmp_path / 'out' / 'report.html').read_text()


def test_an_incomplete_motion_of_the_turntable_is_refused(call, bag):
    status, said = call('light', 'calibrate', bag, '--step', '22.5')
    assert status == 2
    assert 'give either --rate, or both --step and --hold' in said.err
