# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""One wrong unit or axis of a whole recording is found by its cause; clean ones are not."""

from lta_data.data_quality.checks.units import find_unit_by_size
from lta_data.data_quality.registry import run_checks
from lta_data.flight import Channel, Flight
from lta_data.interpretation.attitude_readings import shrink_angles
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

TOPIC = 'ground_truth/odom'


def record(
    time=1.0, length=1.0, speed=1.0, angle=1.0, rate=1.0, flip=False, straight=False, late=0
):
    """
    Return a flight of 30 s, with factors on its numbers.

    `straight`: it keeps its heading. `late`: samples by which a filter delays velocity and rates
    of a quick swing.
    """
    rng = np.random.default_rng(3)
    t = np.arange(0.0, 30.0, 0.02)
    angles = np.stack([0.35 * t, 0.12 * np.sin(0.9 * t), 0.1 * np.sin(1.3 * t)], axis=1)
    if straight:
        angles = np.stack([np.cos(0.4 * t), np.sin(0.9 * t), np.sin(1.3 * t)], axis=1) * 0.03
    if late:
        angles[:, 1:] = 0.12 * np.stack([np.sin(4.5 * t), np.cos(4.1 * t)], axis=1)
    turn = Rotation.from_euler('ZYX', angles)
    body = np.stack([0.4 + 0.1 * np.sin(t), 0.03 * np.sin(t), 0.1 * np.cos(0.6 * t)], axis=1)
    body *= 0.5 if straight else 1.0
    place = np.cumsum(turn.apply(body), axis=0) * 0.02 + [0.0, 0.0, 1.5]
    rates = (turn[:-1].inv() * turn[1:]).as_rotvec() / 0.02
    rates = np.concatenate([rates, rates[-1:]])
    place, body = place + rng.normal(0, 1e-4, place.shape), body + rng.normal(0, 2e-3, body.shape)
    rates = rates + rng.normal(0, 3e-3, rates.shape)
    # A log has angles from -pi to pi
    wrapped = np.arctan2(np.sin(angles), np.cos(angles)) + rng.normal(0, 3e-4, angles.shape)
    read = Rotation.from_euler('ZYX', wrapped * angle)
    if flip:
        down = np.diag([1.0, -1.0, -1.0])
        read = Rotation.from_matrix(down @ read.as_matrix() @ down)
        place, body, rates = (v * [1.0, -1.0, -1.0] for v in (place, body, rates))
    body, rates = (np.roll(one, late, axis=0) for one in (body, rates))
    parts = {
        'pose.pose.position': (place * length, 'm'),
        'pose.pose.orientation': (read.as_quat(), '1'),
        'twist.twist.linear': (body * speed, 'm/s'),
        'twist.twist.angular': (rates * rate, 'rad/s'),
    }
    channels = [
        Channel(f'{TOPIC}/{path}.{axis}', unit, t * time, values[:, index].copy())
        for path, (values, unit) in parts.items()
        for index, axis in enumerate('xyzw'[: values.shape[1]])
    ]
    return Flight({c.name: c for c in channels}, {'data': 'measured'})


def grave(recording):
    return [one for one in run_checks(recording).findings if one.is_grave]


def test_a_clean_flight_has_no_finding():
    assert grave(record()) == []


DEG = np.degrees(1.0)
CASES = {
    'position large': ({'length': 1e3}, 'position', '1000 times too large'),
    'lengths large': ({'length': 1e3, 'speed': 1e3}, 'position', '1000 times too large'),
    'position small': ({'length': 1e-3}, 'position', '1000 times too small'),
    'lengths small': ({'length': 1e-3, 'speed': 1e-3}, 'position', '1000 times too small'),
    'angles in deg': ({'angle': DEG}, 'orientation', 'The unit looks like deg'),
    'angles and rates in deg': ({'angle': DEG, 'rate': DEG}, 'orientation', 'looks like deg'),
    'angles small': ({'angle': 1 / DEG}, 'orientation', '57.3 times too small'),
    'angles and rates small': ({'angle': 1 / DEG, 'rate': 1 / DEG}, 'orientation', 'too small'),
    'times short': ({'time': 1e-3}, 'position', '1000 times too short'),
    'times long': ({'time': 1e3}, 'position', '1000 times too long'),
    'z down': ({'flip': True}, 'position', 'The z axis points down'),
}


@pytest.mark.parametrize(('factors', 'channel', 'sentence'), CASES.values(), ids=CASES)
def test_the_cause_is_found_and_nothing_else(factors, channel, sentence):
    (finding,) = grave(record(**factors))
    assert finding.channel.endswith(channel)
    assert sentence in finding.evidence


@pytest.mark.parametrize(
    'kind', ['lengths small', 'angles small', 'angles and rates small', 'lengths large']
)
def test_the_unit_of_a_straight_flight_is_found(kind):
    """Yaw, pitch and roll stay within 2 degrees, while it flies 6 m."""
    factors, channel, sentence = CASES[kind]
    (finding,) = grave(record(**factors, straight=True))
    assert finding.channel.endswith(channel)
    assert sentence in finding.evidence


def test_a_straight_flight_has_no_finding():
    assert grave(record(straight=True)) == []


@pytest.mark.parametrize(
    'kind', ['angles small', 'angles and rates small', 'angles in deg', 'angles and rates in deg']
)
def test_the_unit_of_angles_is_found_beside_late_rates(kind):
    """A filter delays velocity and rates of a swing by 0.2 s: the clock is another finding."""
    factors, channel, sentence = CASES[kind]
    units = [
        one
        for one in grave(record(**factors, straight=True, late=10))
        if one.kind in ('unit', 'axes')
    ]
    assert [one.channel.endswith(channel) for one in units] == [True]
    assert sentence in units[0].evidence


@pytest.mark.parametrize('above', [0.4, 0.3, -0.3])
def test_markers_away_from_the_axis_of_a_swing_are_not_upside_down(above):
    """A pendulum of 1.4 s: those above accelerate against the lean by 6 or 8 m/s2 per rad."""
    rng = np.random.default_rng(5)
    t = np.arange(0.0, 30.0, 0.01)
    roll = 0.4 * np.exp(-0.05 * t) * np.cos(4.5 * t)
    turn = Rotation.from_rotvec(np.outer(roll, [1.0, 0.0, 0.0]))
    centre = np.array([0.0, 0.0, 1.5])
    place = turn.apply([0.0, 0.0, above]) + centre + rng.normal(0, 3e-4, (len(t), 3))
    parts = {'position': place, 'orientation': turn.as_quat()}
    channels = [
        Channel(f'{TOPIC}/pose.pose.{part}.{axis}', 'm', t, values[:, index].copy())
        for part, values in parts.items()
        for index, axis in enumerate('xyzw'[: values.shape[1]])
    ]
    recording = Flight({one.name: one for one in channels}, {'data': 'measured'})
    assert grave(recording) == []


def test_angles_that_turned_many_times_are_followed():
    t = np.arange(0.0, 20.0, 0.01)
    angles = np.stack([0.3 * t, 0.15 * np.sin(t), 0.1 * np.sin(1.7 * t + 0.3)], axis=1)
    read = Rotation.from_euler('ZYX', angles * DEG)
    found = Rotation.from_euler('ZYX', shrink_angles(read))
    truth = Rotation.from_euler('ZYX', angles)
    # The start has whole turns of 57.3 times the angle: compare the changes
    turned = (found[0].inv() * found[-1]).magnitude()
    assert turned == pytest.approx((truth[0].inv() * truth[-1]).magnitude(), abs=0.05)


def commands(values):
    time = np.arange(len(values)) * 0.01
    return Channel('motors/effort.left', '1', time, np.asarray(values))


def test_corrupt_commands_are_no_other_unit_and_per_cent_is_one():
    rng = np.random.default_rng(0)
    duty = rng.uniform(0.2, 0.9, 2000)
    broken = duty.copy()
    broken[::25] = rng.uniform(2.0, 90.0, 80)
    assert list(find_unit_by_size(commands(broken))) == []
    (finding,) = find_unit_by_size(commands(duty * 100.0))
    assert 'looks like %' in finding.evidence
    recording = Flight({'motors/effort.left': commands(broken)}, {'data': 'measured'})
    findings = grave(recording)
    assert {one.kind for one in findings} == {'impossible'}
    assert 'a duty is between -1 and 1' in findings[0].evidence


def test_corrupt_commands_of_idle_motors_are_no_other_unit():
    rng = np.random.default_rng(0)
    idle = np.zeros(2000)
    idle[rng.choice(2000, 60, replace=False)] = rng.uniform(2.0, 60.0, 60)
    assert list(find_unit_by_size(commands(idle))) == []
    busy = np.zeros(2000)
    busy[400:600] = 40.0
    (finding,) = find_unit_by_size(commands(busy))
    assert 'looks like %' in finding.evidence


def reread(change):
    """Return what is said of the axes where attitude or velocity were read in another way."""
    channels = dict(record().channels)

    def table(path, axes):
        return np.stack([channels[f'{TOPIC}/{path}.{axis}'].values for axis in axes], axis=1)

    turn = Rotation.from_quat(table('pose.pose.orientation', 'xyzw'))
    speed = table('twist.twist.linear', 'xyz')
    for path, values in change(turn, speed).items():
        for index, axis in enumerate('xyzw'[: values.shape[1]]):
            name = f'{TOPIC}/{path}.{axis}'
            column = values[:, index].copy()
            channels[name] = Channel(name, '', channels[name].time, column)
    report = run_checks(Flight(channels, {'data': 'measured'}))
    return ' '.join(one.evidence for one in report.findings if one.kind == 'axes')


@pytest.mark.parametrize(('signs', 'words'), [
    ((1.0, -1.0, 1.0), 'The pitch angle is inverted'),
    ((-1.0, 1.0, 1.0), 'The yaw angle is inverted'),
])  # fmt: skip
def test_an_inverted_angle_is_named(signs, words):
    def invert(turn, _):
        angles = turn.as_euler('ZYX') * np.array(signs)
        return {'pose.pose.orientation': Rotation.from_euler('ZYX', angles).as_quat()}

    assert words in reread(invert)


def test_a_body_velocity_that_was_read_as_one_of_the_world_is_named():
    words = 'The body velocity was rotated into the body once more'
    assert words in reread(lambda turn, speed: {'twist.twist.linear': turn.inv().apply(speed)})
    assert reread(lambda _, speed: {'twist.twist.linear': speed}) == ''
