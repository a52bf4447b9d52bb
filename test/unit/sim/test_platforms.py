# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Each platform's published steady state or limit, by hand from its file and by the kernel."""

import math

from lta_config.errors import BadInput
from lta_config.files import list_shipped_names, share_folder
from lta_model.effects import initial_memory
from lta_model.limits import level_force, level_speed, tumble_speed
from lta_model.mass_properties import added_mass
from lta_model.state import pack_state
from lta_model.vehicle import load_vehicle
from lta_sim.kernels import kernel
from lta_windtunnel.sweep_table import read_sweep
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

G = 9.80665
RHO = 1.2041
HEAVE, YAW = 2, 5


@pytest.fixture(scope='module')
def vehicles():
    return {name: load_vehicle(name, RHO) for name in list_shipped_names('vehicles')}


def flown(vehicle, duty, seconds, step=0.002):
    """Return the state after so long at constant duties, from rest high above the floor."""
    vehicle.check_step(step)
    state = pack_state((0.0, 0.0, 100.0), memory=initial_memory())
    count = round(seconds / step)
    command = vehicle.pack_command(duty)
    return kernel.advance(state, vehicle.build_model(), command, np.zeros(3), step, count)


def spun_up(vehicle, duty):
    """Return the wrench on a resting vehicle of which the motors have reached their duties."""
    calm = flown(vehicle, duty, 2.0)
    calm[:13] = pack_state((0.0, 0.0, 100.0))[:13]
    look = kernel.effect_wrenches(
        calm, vehicle.build_model(), vehicle.pack_command(duty), np.zeros(3)
    )
    jets = look['rotor_thrust']
    return jets + look.get('rotor_envelope_interaction', 0.0)


def blown(name, pattern):
    """Return what the rotors of a pattern did at full thrust in the wind tunnel [N, N m]."""
    blow = read_sweep(share_folder() / 'aero' / f'{name}.sweep.json').blows[pattern]
    return np.array([*blow.force, *blow.moment])


@pytest.mark.parametrize('name', list_shipped_names('vehicles'))
def test_each_stands_on_its_feet(vehicles, name):
    vehicle = vehicles[name]
    state = pack_state((0.0, 0.0, vehicle.hull_height_on_floor), memory=initial_memory())
    command = vehicle.pack_command([0.0] * len(vehicle.rotors))
    state = kernel.advance(state, vehicle.build_model(), command, np.zeros(3), 0.002, 5000)
    assert state[2] == pytest.approx(vehicle.hull_height_on_floor, abs=2e-3)
    tilt = Rotation.from_quat(state[3:7]).apply((0.0, 0.0, 1.0))[2]
    assert math.degrees(math.acos(min(tilt, 1.0))) < 3.0


class TestBlimp2b:
    """Zufferey 2006: T = D v^2 and N = D r, from the published coefficients."""

    @pytest.mark.parametrize(
        ('duty', 'axis', 'speed'),
        [
            ((1, 0, 0), 7, math.sqrt(0.040 / 0.07)),  # 0.756 m/s
            ((-1, 0, 0), 7, -math.sqrt(0.045 / 0.07)),
            ((0, 0, 1), 9, math.sqrt(0.045 / 0.22)),
            ((0, 0, -1), 9, -math.sqrt(0.025 / 0.22)),
        ],
    )
    def test_steady_speeds(self, vehicles, duty, axis, speed):
        state = flown(vehicles['blimp2b'], duty, 120.0)
        # What is left are the last swings: the body axes hold the thrust and the drag.
        assert state[axis] == pytest.approx(speed, rel=1e-4)

    @pytest.mark.parametrize(('duty', 'thrust'), [(1, 0.030), (-1, -0.025)])
    def test_steady_turn(self, vehicles, duty, thrust):
        """The yaw propeller pushes the tail to the left, so the vehicle turns right."""
        vehicle = vehicles['blimp2b']
        wrench = spun_up(vehicle, (0, duty, 0))
        np.testing.assert_allclose(
            wrench, (0, thrust, 0, 0.198 * thrust, 0, -0.484 * thrust), atol=1e-15
        )
        rate = -0.484 * thrust / 0.0079  # 1.84 and 1.53 rad/s
        # It also drifts, and the Munk moment of that is a thousandth of the propeller's.
        assert flown(vehicle, (0, duty, 0), 60.0)[12] == pytest.approx(rate, rel=2e-3)

    def test_levers_about_the_centre_of_gravity_are_the_published_ones(self, vehicles):
        vehicle = vehicles['blimp2b']
        for column, about in zip(
            vehicle.allocation, ((0, -0.144, 0), (0.073, 0, -0.484), (0, -0.045, 0)), strict=True
        ):
            moved = np.array(column[3:]) - np.cross(vehicle.cg, column[:3])
            np.testing.assert_allclose(moved, about, atol=1e-15)

    def test_it_is_neutral_and_lambs_added_mass_is_near_the_published(self, vehicles):
        vehicle = vehicles['blimp2b']
        assert vehicle.displaced_mass == vehicle.mass == 0.184
        assert vehicle.hover_duty == 0.0
        # The ellipsoid as drawn: 0.155 m3, 0.186 kg of air.
        assert vehicle.volume * RHO == pytest.approx(0.186, abs=5e-4)
        assert vehicle.added_mass == (0.033, 0.129, 0.129, 0.0, 0.0, 0.0)
        own = vehicle.file.hull.model_copy(update={'added_mass': None})
        assert added_mass(own, RHO)[:3] == pytest.approx((0.0367, 0.1335, 0.1335), abs=1e-4)


class TestGtmab:
    """The seed paper's platform: 0.318 N forward, 1.5 to 1.9 m/s through the air."""

    def test_top_speed(self, vehicles):
        vehicle = vehicles['gtmab']
        assert level_speed(vehicle) == pytest.approx(
            math.sqrt(2 * 0.981 * 0.1592 / 0.092), rel=1e-3
        )
        assert 1.5 < level_speed(vehicle) < 1.9

    def test_it_tumbles_where_the_weight_no_longer_rights_it(self, vehicles):
        """The hull turns across its way by what is left of the Munk moment."""
        vehicle = vehicles['gtmab']
        # 0.415 kg, 10.4 cm; 0.134 and 0.343 kg of air; 0.48 of the moment are lost.
        by_hand = 0.4153 * G * 0.1043 * (0.4153 + 0.3435) / (0.2095 * (0.4153 + 0.1340)) / 0.52
        assert tumble_speed(vehicle) == pytest.approx(math.sqrt(by_hand), rel=1e-3)

    @pytest.mark.parametrize(('share', 'upright'), [(0.97, True), (1.03, False)])
    def test_it_tumbles_where_the_closed_form_says(self, vehicles, share, upright):
        """Let go at a speed with nothing but weight, buoyancy and added mass at work."""
        vehicle = vehicles['gtmab']
        kept = ('weight_and_buoyancy', 'added_mass', 'added_inertia', 'munk_moment')
        given = {name: vehicle.collect_effects()[name] for name in kept}
        model = type(vehicle.build_model()).build(
            given,
            mass=vehicle.mass,
            cg=vehicle.cg,
            inertia=vehicle.inertia,
            displaced=vehicle.mass,
        )
        speed = share * tumble_speed(vehicle)
        state = pack_state((0, 0, 100.0), velocity=(speed, 0, 0), memory=initial_memory())
        state[11] = 1e-4  # a touch of pitch rate [rad/s]
        worst = 0.0
        for _ in range(400):
            state = kernel.advance(state, model, (), np.zeros(3), 0.002, 50)
            worst = max(worst, abs(Rotation.from_quat(state[3:7]).as_euler('ZYX')[1]))
        assert (worst < 0.02) == upright


class TestBeavis:
    """Sharma 2023: lateral rotors alone; the net vertical force is 0.05 N in the seed paper."""

    def test_all_jets_together_lift(self, vehicles):
        wrench = spun_up(vehicles['beavis'], (1, 1, 1, 1))
        # The seed paper has 0.05 N, and jets that push straight outwards 0.145 N.
        assert 0.05 < wrench[HEAVE] < 0.145
        assert wrench[HEAVE] == pytest.approx(blown('beavis', 'all')[HEAVE], rel=2e-3)
        np.testing.assert_allclose(np.delete(wrench, HEAVE), 0.0, atol=1e-12)

    def test_one_jet_alone_does_not(self, vehicles):
        for i in range(4):
            assert spun_up(vehicles['beavis'], np.eye(4)[i])[HEAVE] < 0.0

    def test_it_moves_turns_and_rises_with_four_rotors(self, vehicles):
        """Around half thrust: surge, sway, yaw and heave follow from four duties."""
        vehicle = vehicles['beavis']
        half = spun_up(vehicle, (0.5,) * 4)
        changes = []
        for i in range(4):
            duty = [0.5] * 4
            duty[i] = 0.6
            changes.append((spun_up(vehicle, duty) - half)[[0, 1, 5]])
        assert np.linalg.matrix_rank(np.array(changes), tol=1e-4) == 3
        assert spun_up(vehicle, (0.8, 0.2, 0.8, 0.2))[YAW] > 0.0
        assert spun_up(vehicle, (0.2, 0.8, 0.2, 0.8))[YAW] < 0.0


class TestSblimp:
    """Xu 2023: tilted rotors share the thrust between up and sideways; at most 0.8 m/s."""

    def test_the_sideways_limit(self, vehicles):
        vehicle = vehicles['sblimp']
        # Two rotors carry it: what one pushes up, beside what it pushes to the side.
        _, sway, heave, *_ = blown('sblimp', 'front_left')
        force = 0.010 * G * sway / heave
        assert level_force(vehicle) == pytest.approx(force, rel=1e-3)
        speed = math.sqrt(force / (0.81 * 0.092))
        assert level_speed(vehicle) == pytest.approx(speed, rel=1e-3)
        # Published 0.8 m/s; ours from an assumed tilt and weight, and not tuned.
        assert speed == pytest.approx(0.76, abs=0.01)


class TestSkye:
    """Burri 2013: a sphere of 2.7 m, near neutral, that moves and turns any way."""

    def test_added_mass_is_half_of_the_displaced_air(self, vehicles):
        vehicle = vehicles['skye']
        half = 0.5 * RHO * 4 / 3 * math.pi * 1.35**3
        assert half == pytest.approx(6.2, abs=0.01)
        np.testing.assert_allclose(vehicle.added_mass, [half] * 3 + [0.0] * 3, rtol=1e-9)
        assert tumble_speed(vehicle) == math.inf

    def test_rotors_push_along_the_hull_and_span_all_wrenches(self, vehicles):
        vehicle = vehicles['skye']
        assert len(vehicle.rotors) == 8
        for rotor in vehicle.rotors:
            assert math.hypot(*rotor.place) == pytest.approx(1.35, abs=1e-3)
            assert np.dot(rotor.place, rotor.axis) == pytest.approx(0.0, abs=1e-4)
        for one, other in zip(vehicle.rotors[::2], vehicle.rotors[1::2], strict=True):
            assert one.place == other.place
            assert np.dot(one.axis, other.axis) == pytest.approx(0.0, abs=1e-4)
        singular = np.linalg.svd(np.array(vehicle.allocation), compute_uv=False)
        assert singular[-1] > 0.5 * singular[0]


class TestMultirotor:
    """Crazyflie 2.1 with stock firmware: 27 g on four rotors, each asked for 0.12 N at most."""

    def test_hover_duty_by_hand(self, vehicles):
        vehicle = vehicles['multirotor']
        assert vehicle.battery_compensated
        assert vehicle.full_thrust == 0.12
        assert vehicle.hover_duty == pytest.approx(0.027 * G / 4 / 0.12, rel=1e-12)

    def test_its_motors_hover_between_two_rows_of_the_bench(self, vehicles):
        """Bitcraze's bench: 24.4 g at 50 % of 3.71 V, 41.7 g at 75 % of 3.56 V."""
        motor = vehicles['multirotor'].collect_effects()['thrust_polynomial']
        cubic = [motor[name] for name in ('c_3', 'c_2', 'c_1', 'c_0')]
        assert np.polyval(cubic, 0.5 * 3.71) < 0.027 * G / 4 < np.polyval(cubic, 0.75 * 3.56)

    def test_each_rotor_turns_it_as_the_firmware_mixes(self, vehicles):
        """Signs of controlModeForceTorque: m1 is - - -, m2 - + +, m3 + + -, m4 + - +."""
        signs = np.sign(np.array(vehicles['multirotor'].allocation)[:, 3:])
        np.testing.assert_array_equal(signs, [(-1, -1, -1), (-1, 1, 1), (1, 1, -1), (1, -1, 1)])


class TestRgblimp:
    """The authors' equations (zhu-yj/ABNODE), written out here in their own axes."""

    TURN = np.array([1.0, -1.0, -1.0])  # forward, right, down <-> forward, left, up

    @staticmethod
    def published(rotation, v, w, left, right):
        """Return the accelerations of their model; rotation: body to world, z down."""

        def cross(a):
            return np.array([[0, -a[2], a[1]], [a[2], 0, -a[0]], [-a[1], a[0], 0]])

        m, mb, lift, area = 0.10482, 0.05407, 0.15204, 0.25
        r, rb = np.array([-0.0432, -0.0003, 0.0079]), np.array([0.0747, 0.0006, 0.238])
        inertia = np.diag([0.030, 0.015, 0.010]) - mb * cross(rb) @ cross(rb)
        speed = np.linalg.norm(v)
        alpha, beta = math.atan2(v[2], v[0]), math.asin(v[1] / speed)
        q = 0.5 * 1.2187 * speed**2 * area
        force = q * np.array(
            [
                -(0.2425 + 4.4195 * alpha**2 + 7.508 * beta**2),
                0.0083 - 0.0744 * alpha**2 - 2.114 * beta,
                -(0.1594 + 2.9375 * alpha + 4.5537 * beta**2),
            ]
        )
        moment = q * np.array(
            [
                0.0131 - 0.0301 * alpha - 0.5256 * beta,
                0.0568 + 0.0933 * alpha + 5.2357 * beta**4,
                0.0006 - 0.0012 * alpha - 0.0936 * beta,
            ]
        ) - w * np.array([0.0503, 0.0264, 0.0137])
        ca, sa, cb, sb = math.cos(alpha), math.sin(alpha), math.cos(beta), math.sin(beta)
        turn = np.array([[ca * cb, -ca * sb, -sa], [sb, cb, 0], [sa * cb, -sa * sb, ca]])
        down = rotation.T @ np.array([0.0, 0.0, G])
        first = m * r + mb * rb
        f = (m + mb) * np.cross(v, w) + np.cross(np.cross(w, first), w)
        f = f + (m + mb - lift) * down + turn @ force + np.array([left + right, 0.0, 0.0])
        t = np.cross(inertia @ w, w) + np.cross(first, np.cross(v, w)) + np.cross(first, down)
        t = t + turn @ moment
        t = t + np.array([0.0, (left + right) * rb[2], (left - right) * 0.15])
        matrix = np.block([[(m + mb) * np.eye(3), -cross(first)], [cross(first), inertia]])
        return np.linalg.solve(matrix, np.concatenate([f, t]))

    @pytest.mark.parametrize('seed', range(5))
    def test_it_moves_as_its_authors_say(self, vehicles, seed):
        vehicle = vehicles['rgblimp']
        generator = np.random.default_rng(seed)
        v = np.array([0.6, 0.05, 0.1]) + generator.normal(size=3) * 0.05
        w = generator.normal(size=3) * 0.1
        pose = Rotation.from_euler('ZYX', generator.normal(size=3) * 0.2)
        duty = generator.uniform(0.2, 1.0, size=2)
        over = np.diag(self.TURN)
        expected = self.published(over @ pose.as_matrix() @ over, v, w, *(0.060 * duty))
        state = pack_state((0, 0, 100.0), memory=initial_memory())
        state[3:7] = pose.as_quat()
        state[7:10], state[10:13] = self.TURN * v, self.TURN * w
        rate = kernel.state_derivative(state, vehicle.build_model(), vehicle.pack_command(duty))[
            7:13
        ]
        # 1e-5: below 1 mm/s the effect fades the wind axes out, (1 mm/s / 0.6 m/s)^2 here.
        scale = np.abs(expected).max()
        np.testing.assert_allclose(rate * np.tile(self.TURN, 2), expected, atol=1e-5 * scale)

    def test_it_is_heavy_and_cannot_hover(self, vehicles):
        vehicle = vehicles['rgblimp']
        assert vehicle.heaviness == pytest.approx(0.00685)
        assert vehicle.displaced_mass == pytest.approx(0.15204, rel=1e-12)
        with pytest.raises(
            BadInput, match=r'^rgblimp has no rotor that pushes upwards, so it cannot hover'
        ):
            _ = vehicle.hover_duty

    def test_it_spirals_as_the_real_one_did(self, vehicles):
        """
        Thrusts of the first four published flights, against the second half of each.

        They flew at 0.54 to 0.62 m/s forward and 0.17 to 0.18 m/s sideways, turned right at 0.67
        to 0.70 rad/s with the nose 8 to 9 degrees up, and sank by 2.3 to -1.1 cm/s.
        """
        state = flown(vehicles['rgblimp'], (0.01666 / 0.060, 0.05292 / 0.060), 60.0)
        assert 0.54 < state[7] < 0.63
        assert state[8] == pytest.approx(-0.175, abs=0.015)
        assert abs(state[12]) == pytest.approx(0.68, abs=0.04)
        turn = Rotation.from_quat(state[3:7])
        assert abs(turn.apply(state[7:10])[2]) < 0.06  # as far as repeats differ from each other
