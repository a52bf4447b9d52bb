# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""A vehicle weighed by its flight: the loop flies one that is heavier or lighter than its file."""

import math

from campaigns.challenge.recording import write_bag
from lta_config.errors import BadInput
from lta_data.bag.recorded_flight import open_flight
from lta_data.bag.table import stack_components
from lta_model.vehicle import load_vehicle
from lta_vehicle.flight_record import (
    read_flight_record,
    RotorCommands,
    VehiclePath,
    WrenchCommands,
)
from lta_vehicle.trim import describe_heaviness, encode_heaviness, estimate_heaviness
import numpy as np
import pytest

from .weighed_flight import write_hover

G = 9.80665
THRUST = 0.002 * G / (2 * 0.961)  # of each of two rotors of GT-MAB that carry 2 g
DUTY = (-0.0677 + math.sqrt(0.0677**2 + 4 * 0.0915 * THRUST)) / (2 * 0.0915)
LEVEL = np.array([0.0, 0.0, 0.0, 1.0])


@pytest.fixture(scope='module')
def gtmab():
    return load_vehicle('gtmab')


@pytest.fixture(scope='module')
def hover(tmp_path_factory):
    """Return the bag of a flight with 1.5 g more on board than the file says."""
    folder = tmp_path_factory.mktemp('hover') / 'bag'
    more = ('vehicle.effects.payload.mass=1.5 g', 'vehicle.effects.payload.z=-0.4 m')
    return write_hover(folder, *more)


def hanging(seconds=20.0, duty=DUTY, height=lambda t: 0.0 * t, ahead=lambda t: 0.0 * t):
    time = np.arange(0.0, seconds, 0.01)
    place = np.stack([ahead(time), 0.0 * time, 1.0 + height(time)], axis=1)
    attitude = np.tile(LEVEL, (len(time), 1))
    duties = np.tile([duty, duty, 0.0, 0.0], (len(time), 1))
    return VehiclePath(time, place, attitude), RotorCommands(time, duties)


def test_a_hover_at_the_duty_of_two_grams_weighs_two_grams(gtmab):
    found = estimate_heaviness(gtmab, *hanging())
    assert found.heaviness == pytest.approx(0.002, rel=1e-5)
    assert found.error == pytest.approx(0.0, abs=1e-9)
    assert found.ballast_change == pytest.approx(0.0, abs=1e-7)
    assert found.duty == pytest.approx(DUTY)


def test_a_slow_rise_under_the_same_duty_means_less_weight(gtmab):
    """At 4 cm/s the drag of 0.359 N s2/m2 is 0.574 mN, which is 0.0586 g."""
    found = estimate_heaviness(gtmab, *hanging(height=lambda t: 0.04 * t))
    assert found.heaviness == pytest.approx(0.002 - 0.359 * 0.04**2 / G, rel=1e-4)


def test_what_it_gains_in_speed_is_not_weight(gtmab):
    """Rising ever faster by 2 mm/s2: 0.415 kg and the 0.343 kg of air that rises with it."""
    path, commands = hanging(20.0, height=lambda t: 0.001 * t**2)
    found = estimate_heaviness(gtmab, path, commands)
    rising = (gtmab.mass + gtmab.added_mass[2]) * 0.002 / G
    drag = 0.359 * 0.02**2 / G  # at most, at the end of what counts as calm: a few milligrams
    assert found.heaviness == pytest.approx(0.002 - rising, abs=3.0 * drag)


def test_no_still_stretch_is_one_sentence(gtmab):
    with pytest.raises(BadInput, match='has only 0 s of hover'):
        estimate_heaviness(gtmab, *hanging(ahead=lambda t: 0.5 * t))


def test_a_flown_load_is_found_to_a_fifth_of_a_gram(gtmab, hover):
    """1.5 g more on board than the file says, flown by the loop with all its sensor noise."""
    found = estimate_heaviness(gtmab, *read_flight_record(open_flight(hover), gtmab)[:2])
    assert found.heaviness == pytest.approx(0.0035, abs=0.0002)
    assert abs(found.heaviness - 0.0035) < 2.0 * found.error
    assert found.ballast_change == pytest.approx(-0.0015, abs=0.0002)
    assert found.duration >= 10.0


@pytest.mark.long
def test_lost_lift_and_another_seed_as_well(gtmab, tmp_path):
    """0.01 N of lift gone: 1.02 g."""
    bag = write_hover(tmp_path / 'bag', 'vehicle.effects.net_lift.force=-0.01 N', seed=2)
    found = estimate_heaviness(gtmab, *read_flight_record(open_flight(bag), gtmab)[:2])
    assert found.heaviness == pytest.approx(0.002 + 0.01 / G, abs=0.0002)


def test_the_estimate_alone_will_do(gtmab, hover):
    """Without a tracker: the drone's own odometry."""
    flight = open_flight(hover)
    poses = flight['odom']
    path = VehiclePath(
        poses.index.to_numpy(),
        stack_components(poses, 'pose.pose.position'),
        stack_components(poses, 'pose.pose.orientation'),
    )
    _, commands, topic = read_flight_record(flight, gtmab)
    assert topic == 'ground_truth/odom'
    assert estimate_heaviness(gtmab, path, commands).heaviness == pytest.approx(0.0035, abs=0.0003)


def test_words_say_what_to_do(gtmab):
    heavy = estimate_heaviness(gtmab, *hanging(duty=0.2))
    text = describe_heaviness(heavy, 'gtmab', simulated=True)
    grams = 1e3 * 2 * 0.961 * (0.0915 * 0.04 + 0.0677 * 0.2) / G
    assert f'gtmab was {grams:.2f} g heavier than air' in text
    remove = f'Remove {grams - 2.0:.2f} g of ballast to reach trim.heaviness of the vehicle file'
    assert f'{remove} (2.00 g)' in text
    light = estimate_heaviness(gtmab, *hanging(duty=0.05))
    assert 'Add 1.' in describe_heaviness(light, 'gtmab', simulated=True)
    assert 'leave the ballast' in describe_heaviness(
        estimate_heaviness(gtmab, *hanging()), 'gtmab', simulated=True
    )


def test_a_real_flight_is_told_of_the_thrust_curve(gtmab):
    """2.9 mN a rotor, two of them at 0.961: 0.40 g."""
    found = estimate_heaviness(gtmab, *hanging())
    assert 'thrust curve' not in describe_heaviness(found, 'gtmab', simulated=True)
    assert '0.4 g, if it is as accurate' in describe_heaviness(found, 'gtmab', simulated=False)
    expected = 0.0029 * 0.961 * math.sqrt(2.0) / G
    assert encode_heaviness(found)['thrust_curve_error'] == pytest.approx(expected)


def test_duties_of_another_vehicle_are_refused(hover):
    beavis = load_vehicle('beavis')
    with pytest.raises(
        BadInput, match='no motor duties for front, left, rear, right, rotors of beavis'
    ):
        read_flight_record(open_flight(hover), beavis)


def test_a_commanded_force_weighs_as_well_as_duties(gtmab):
    """Half of 39.2 mN arrives and carries 2 g; a tilt of the body turns the force."""
    path, _ = hanging()
    force = np.tile([0.0, 0.0, 2.0 * 0.002 * G], (len(path.time), 1))
    weak = NominalFile(gtmab, {'wrench_gain': {'heave': 0.5}})
    found = estimate_heaviness(weak, path, WrenchCommands(path.time, force))
    assert found.heaviness == pytest.approx(0.002, rel=1e-5)
    assert (found.duty, found.curve_error) == (None, 0.0)
    assert found.force == pytest.approx(0.002 * G, rel=1e-5)
    assert 'a force of 19.6 mN' in describe_heaviness(found, 'gtmab', False)
    assert encode_heaviness(found)['force'] == pytest.approx(0.002 * G, rel=1e-5)


def test_a_commanded_force_weighs_by_the_thrust_law_of_the_file(gtmab):
    """0.5 x 10 mN x (19.8 / 10)^2 = 19.6 mN carry 2 g."""
    path, _ = hanging()
    force = np.tile([0.0, 0.0, 0.01 * math.sqrt(0.002 * G / 0.005)], (len(path.time), 1))
    law = {'heave': 0.5, 'exponent_heave': 2.0, 'reference_heave': 0.01}
    square = NominalFile(gtmab, {'wrench_gain': law})
    found = estimate_heaviness(square, path, WrenchCommands(path.time, force))
    assert found.heaviness == pytest.approx(0.002, rel=1e-5)


class NominalFile:
    """A vehicle with more effects."""

    def __init__(self, vehicle, more):
        self._vehicle, self._more = vehicle, more

    def __getattr__(self, name):
        return getattr(self._vehicle, name)

    def collect_effects(self):
        return {**self._vehicle.collect_effects(), **self._more}


def test_a_bag_with_a_commanded_wrench_alone_is_weighed(gtmab, tmp_path):
    time = 0.01 * np.arange(3000)
    pose = np.tile([0.0, 0.0, 1.5, 0.0, 0.0, 0.0, 1.0], (len(time), 1))
    wrench = np.tile([0.0, 0.0, 0.003 * G, 0.0, 0.0, 0.0], (len(time), 1))
    write_bag(
        tmp_path / 'bag',
        {'ground_truth/odom': (time, pose), 'wrench_command': (time, wrench)},
        gtmab.rotor_names,
        {},
    )
    path, commands, topic = read_flight_record(open_flight(tmp_path / 'bag'), gtmab)
    assert topic == 'ground_truth/odom'
    assert estimate_heaviness(gtmab, path, commands).heaviness == pytest.approx(0.003, rel=1e-4)
