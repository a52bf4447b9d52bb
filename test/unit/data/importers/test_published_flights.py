# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The shipped mappings on the published flights, against numpy and against physics."""

import gzip

import numpy as np
import pytest
from rosbags.highlevel import AnyReader
from scipy.spatial.transform import Rotation

TRUTH = '/lta1/ground_truth/odom'


def columns(path):
    """Return a text's columns, read by numpy."""
    with gzip.open(path, 'rt') as stream:
        names = stream.readline().strip().split(',')
        return dict(zip(names, np.loadtxt(stream, delimiter=',').T, strict=True))


def vectors(messages, path):
    """Return a vector of each message, shape (n, 3) or (n, 4)."""
    found = []
    for message in messages:
        for name in path.split('.'):
            message = getattr(message, name)
        found.append([getattr(message, axis) for axis in 'xyzw' if hasattr(message, axis)])
    return np.array(found)


def rms(values):
    return np.sqrt(np.mean(np.square(values)))


@pytest.mark.parametrize('flight', [1, 60])
def test_rgblimp_flies_the_way_it_moves(bring, measured, flight):
    source = measured(f'rgblimp/data_{flight}.csv.gz')
    found, raw = bring(source), columns(source)
    assert found.imported.mapping == 'rgblimp'
    truth = found.messages[TRUTH]
    p = vectors(truth, 'pose.pose.position')
    assert p.tolist() == np.stack([raw['p_1'], -raw['p_2'], -raw['p_3']], axis=1).tolist()
    v = vectors(truth, 'twist.twist.linear')
    assert v.tolist() == np.stack([raw['vb_1'], -raw['vb_2'], -raw['vb_3']], axis=1).tolist()
    w = vectors(truth, 'twist.twist.angular')
    assert w.tolist() == np.stack([raw['wb_1'], -raw['wb_2'], -raw['wb_3']], axis=1).tolist()
    k = np.arange(len(p))
    assert found.stamps(TRUTH) == [10**9 + round(one * 10**9 / 60) for one in k.tolist()]
    # Turned into the world, the velocity is the derivative of the position; so is the rate of
    # turn that of the attitude. A wrong sign or order is wrong by a tenth of the speed at least.
    q = Rotation.from_quat(vectors(truth, 'pose.pose.orientation'))
    moved = np.gradient(p, 1 / 60, axis=0)
    assert rms((q.apply(v) - moved)[20:-20]) < 0.02 * rms(moved)
    turned = (q[:-1].inv() * q[1:]).as_rotvec() * 60
    assert rms((w[:-1] - turned)[20:-20]) < 0.01 * rms(turned)
    # It flies above the floor, and the mass hangs below the hull.
    assert 0.3 < p[:, 2].min() < p[:, 2].max() < 3.0
    motors = found.messages['/lta1/motors'][0]
    told = dict(zip(motors.name, motors.position.tolist(), strict=True))
    assert told['moving_mass_z'] == -0.238
    effort = dict(zip(motors.name, motors.effort.tolist(), strict=True))
    assert (effort['left'], effort['right']) == (raw['Fl_series'][0], raw['Fr_series'][0])
    # The right propeller pushes harder, so that it turns to the left: about up.
    assert effort['right'] > effort['left']
    assert w[:, 2].mean() > 0.3


def test_nanobench_is_consistent_in_axes_units_and_time(bring, measured):
    source = measured('crazyflie_flights/B9_trefoil_slow_rep2.csv.gz')
    found, raw = bring(source), columns(source)
    assert found.imported.mapping == 'nanobench'
    truth = found.messages[TRUTH]
    p = vectors(truth, 'pose.pose.position')
    assert p.tolist() == np.stack([raw['px'], raw['py'], raw['pz']], axis=1).tolist()
    told = vectors(truth, 'pose.pose.orientation')
    assert told.tolist() == np.stack([raw[f'q{axis}'] for axis in 'xyzw'], axis=1).tolist()
    # Times keep the nanoseconds of the text, which a float of 1.7e9 s does not hold.
    with gzip.open(source, 'rt') as stream:
        texts = [line.split(',')[0] for line in stream.readlines()[1:]]
    assert found.stamps(TRUTH) == [int(text.replace('.', '')) for text in texts]
    q = Rotation.from_quat(told)
    v = vectors(truth, 'twist.twist.linear')
    moved = np.gradient(p, raw['t'], axis=0)
    assert rms(q.apply(v) - moved) < 0.05 * rms(moved)
    # At rest on the floor gravity is +1 g up; in flight the mean over minutes is, too.
    force = vectors(found.messages['/lta1/imu'], 'linear_acceleration')
    assert force[:100].mean(axis=0) == pytest.approx([0, 0, 9.80665], abs=0.15)
    # The gyro turns as Vicon says: both smoothed to 0.3 s, they agree in every axis.
    rates = vectors(found.messages['/lta1/imu'], 'angular_velocity')
    turned = (q[:-1].inv() * q[1:]).as_rotvec() / np.diff(raw['t'])[:, None]
    kernel = np.ones(30) / 30
    for axis in range(3):
        gyro, vicon = (np.convolve(one[:, axis], kernel, 'valid') for one in (rates[:-1], turned))
        assert np.corrcoef(gyro, vicon)[0, 1] > 0.8
        assert np.polyfit(gyro, vicon, 1)[0] == pytest.approx(1.0, abs=0.25)
    # The drone's own estimate has the same axes: a degree and centimetres apart.
    own = Rotation.from_quat(vectors(found.messages['/lta1/odom'], 'pose.pose.orientation'))
    assert np.median((q.inv() * own).magnitude()) < np.radians(2.0)
    efforts = np.array([message.effort for message in found.messages['/lta1/motors']])
    assert 0.0 == efforts.min() < efforts.max() <= 1.0
    assert efforts[:, 1].tolist() == (raw['motor_motor_m2'] / 65535).tolist()
    volts = [message.voltage for message in found.messages['/lta1/battery']]
    assert volts == np.float32(raw['pwr_pm_vbat']).tolist()


@pytest.mark.long
def test_an_aeroplanes_recording_is_the_same_afterwards(bring, measured):
    source = measured('outdoor_mcap/cub_stabilize_2025_11_13.mcap')
    mapping = (
        'schema: 1\nname: cub\nabout: an aeroplane\nformat: bag\n'
        'topics:\n  - {topic: ground_truth/odom, table: /cub1/pose}\n'
    )
    found = bring(source, mapping)
    poses, times, sticks = [], [], []
    with AnyReader([source]) as reader:
        for connection, time, data in reader.messages():
            message = reader.deserialize(data, connection.msgtype)
            if connection.topic == '/cub1/pose':
                poses.append(message)
                times.append(time)
            else:
                sticks.append((time, message.data.tolist()))
    truth = found.messages[TRUTH]
    assert len(truth) == len(poses) == 19703
    for path in ('pose.position', 'pose.orientation'):
        assert vectors(truth, f'pose.{path}').tolist() == vectors(poses, path).tolist()
    stamps = [one.header.stamp.sec * 10**9 + one.header.stamp.nanosec for one in poses]
    assert found.stamps(TRUTH) == stamps
    assert found.times[TRUTH] == times
    topic = '/cub1/joy_serial_status'
    assert found.types[topic] == 'std_msgs/msg/UInt16MultiArray'
    kept = [message.data.tolist() for message in found.messages[topic]]
    assert list(zip(found.times[topic], kept, strict=True)) == sticks
