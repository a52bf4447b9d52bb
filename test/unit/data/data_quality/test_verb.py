# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""`lta bag check`: bags in, findings, exit status and JSON out."""

import json
import re

from lta_bag.schemas import load_jazzy_types
from lta_data.bag import open_flight
from lta_data.bag.channels import read_flight
import numpy as np
import pytest

IMU, ODOM = 'sensor_msgs/msg/Imu', 'nav_msgs/msg/Odometry'
START = 1_000_000_000


def stamp(time):
    return load_jazzy_types().types['builtin_interfaces/msg/Time'](time // 10**9, time % 10**9)


def imu(time, rates, force):
    """Return a message of an IMU without orientation, as ROS declares it."""
    types = load_jazzy_types().types
    unknown = np.array([-1.0, *[0.0] * 8])
    vector = types['geometry_msgs/msg/Vector3']
    return types[IMU](
        types['std_msgs/msg/Header'](stamp(time), 'imu_link'),
        types['geometry_msgs/msg/Quaternion'](0.0, 0.0, 0.0, 1.0),
        unknown,
        vector(*rates),
        np.zeros(9),
        vector(*force),
        np.zeros(9),
    )


@pytest.fixture
def check(call):
    """Return a function that calls `lta bag check`: exit status, output, errors."""

    def check(*words):
        status, said = call('bag', 'check', *words)
        return status, said.out, said.err

    return check


@pytest.fixture
def imu_bag(record):
    """Return a function that records a resting IMU; `stuck` readings of one axis are equal."""

    def make(name='bag', seed=0, stuck=0, robots=('lta1',)):
        messages = []
        for robot in robots:
            rng = np.random.default_rng(seed)
            rates = rng.normal(0.0, 1.4e-3, (800, 3))
            force = rng.normal(0.0, 0.01, (800, 3)) + np.array([0.0, 0.0, 9.80665])
            if stuck:
                rates[300 : 300 + stuck, 1] = rates[300, 1]
            for i in range(800):
                time = START + i * 10**7
                row = imu(time, rates[i], force[i])
                messages.append((f'/{robot}/imu', IMU, row, time))
        return record(sorted(messages, key=lambda row: row[3]), name)

    return make


def test_a_clean_bag_is_clean(imu_bag, check):
    status, out, _ = check(imu_bag())
    assert status == 0
    assert 'clean' in out


def test_a_stop_is_told_and_is_the_exit_status(imu_bag, check):
    status, out, _ = check(imu_bag(stuck=60), '--json')
    (told,) = json.loads(out)
    (finding,) = told['findings']
    assert status == 1
    assert (told['robot'], told['suspicious'], told['losses']) == ('lta1', True, [])
    assert (finding['kind'], finding['channel']) == ('frozen', 'imu/angular_velocity.y')
    assert (finding['from_s'], finding['to_s']) == pytest.approx((3.0, 3.59))
    assert finding['severity'] == 'suspicious'


def test_a_finding_is_a_line_for_people(imu_bag, check):
    status, out, _ = check(imu_bag(stuck=60))
    assert status == 1
    assert {'suspicious', 'frozen', '3.00 to 3.59 s'} <= set(re.split(r' {2,}|\n', out))


def test_several_robots_are_checked_each_or_one(imu_bag, check):
    bag = imu_bag(robots=('lta1', 'lta2'))
    _, out, _ = check(bag, '--json')
    assert [one['robot'] for one in json.loads(out)] == ['lta1', 'lta2']
    _, out, _ = check(bag, '--robot', 'lta2', '--json')
    assert [one['robot'] for one in json.loads(out)] == ['lta2']
    assert check(bag, '--robot', 'lta3')[0] == 2


def test_the_same_run_in_two_bags_is_named(imu_bag, check):
    one, other, again = (imu_bag(n, seed) for n, seed in (('a', 1), ('b', 2), ('c', 1)))
    assert check(one, other)[0] == 0
    status, out, _ = check(one, other, again, '--json')
    told = json.loads(out)
    assert status == 1
    assert [len(entry['findings']) for entry in told] == [0, 0, 1]
    assert str(one) in told[2]['findings'][0]['evidence']


def test_a_damaged_bag_is_checked_as_far_as_it_goes(imu_bag, check):
    file = imu_bag(stuck=60) / 'bag_0.mcap'
    file.write_bytes(file.read_bytes()[:-200])
    status, out, _ = check(file, '--json')
    (told,) = json.loads(out)
    assert status == 1
    assert told['losses']
    assert told['findings'][0]['kind'] == 'frozen'


def test_what_is_no_bag_is_one_sentence(tmp_path, check):
    file = tmp_path / 'notes.txt'
    file.write_text('no bag')
    status, _, err = check(file)
    assert status == 2
    assert 'is not an MCAP recording' in err


def test_an_unknown_orientation_is_no_attitude_and_log_times_come_along(imu_bag):
    recording = read_flight(open_flight(imu_bag()), raw=True)
    assert recording.losses == ()
    assert 'imu/orientation.w' not in recording.channels
    np.testing.assert_allclose(recording.arrivals['imu'], np.arange(800) * 0.01)


def test_quaternions_come_as_they_are(flight_bag):
    recording = read_flight(open_flight(flight_bag), raw=True)
    path = 'odom/pose.pose.orientation'
    z, w = (recording.channels[f'{path}.{part}'].values for part in 'zw')
    np.testing.assert_allclose(z, np.sin(0.05 * np.arange(40)))
    np.testing.assert_allclose(w, np.cos(0.05 * np.arange(40)))
    assert recording.is_simulated  # its provenance has seed and scenario
