# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Each law once more, from its docstring: with vectors of numpy and turns of scipy.

The allocation has its own tests: here it is a stand-in, which keeps what is asked of it.
"""

import math

from lta_config.constants import STANDARD_GRAVITY
from lta_control import allocation
from lta_control.allocation import create_working_array, thrusts_to_duties
from lta_control.laws import find_control_law, glide, lateral, load_law_gains
from lta_control.laws.protocol import LawInputs
from lta_control.motion import ControlMotion, Setpoint
from lta_model.vehicle import load_vehicle
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

SEEDS = range(12)
DT = 0.02
GIVEN = (0.02, -0.01, 0.3, 0.001, 0.002, -0.003)


def duties(constants, thrusts):
    return thrusts_to_duties(constants.rotors, thrusts, create_working_array())


def thrusts(rotors):
    """Return a thrust of each rotor that is there."""
    return tuple(0.01 * k if k < rotors.number else 0.0 for k in range(8))


def ready(name):
    vehicle = load_vehicle(name)
    made = find_control_law(vehicle.file.control.law)
    return made, made.build_constants(
        load_law_gains(made.gains, vehicle.file.control.gains), vehicle
    )


def somewhere(chance, fast=0.3):
    """Return any motion, any setpoint, and the attitude as scipy has it."""
    turn = Rotation.from_rotvec(chance.normal(0.0, 0.4, 3))
    motion = ControlMotion(
        tuple(chance.normal(1.0, 1.0, 3).tolist()),
        tuple(turn.as_quat(canonical=True).tolist()),
        tuple(chance.normal(0.0, fast, 3).tolist()),
        tuple(chance.normal(0.0, 0.3, 3).tolist()),
    )
    setpoint = Setpoint(chance.uniform(0.5, 1.5), chance.uniform(-3.0, 3.0), chance.uniform(0, 1))
    return motion, setpoint, turn


def pid(gains, integral, error, rate=0.0, shortfall=0.0):
    wanted = gains.kp * error + integral - gains.kd * rate
    output = float(np.clip(wanted, -gains.limit, gains.limit))
    unwound = gains.ki / gains.kp * (output - wanted + shortfall) if gains.kp else 0.0
    return output, integral + DT * (gains.ki * error + unwound)


def climbing(gains, integral, error, climb, missing):
    wanted = np.clip(gains.altitude_kp * error, -gains.climb_limit, gains.climb_limit)
    return pid(gains.climb, integral, wanted - climb, 0.0, missing)


def along(heading, length):
    return length * np.array([math.cos(heading), math.sin(heading), 0.0])


def dragged(drag, setpoint):
    return along(setpoint.heading, drag[0] * setpoint.speed + drag[1] * setpoint.speed**2)


def yaw_of(turn):
    return float(turn.as_euler('ZYX')[0])


def wrapped(angle):
    return math.remainder(angle, 2.0 * math.pi)


def small_turn(here, there):
    """Return twice the vector of the quaternion of the short way."""
    return 2.0 * (here.inv() * there).as_quat(canonical=True)[:3]


@pytest.fixture
def asked(monkeypatch):
    """Return a list of the wrenches that the laws ask for."""
    wrenches = []

    def allocate(rotors, wrench, start, scratch):
        wrenches.append((wrench, start))
        return thrusts(rotors), GIVEN

    monkeypatch.setattr(allocation, 'allocate', allocate)
    return wrenches


def close(values):
    return pytest.approx(np.asarray(values).tolist(), rel=1e-9, abs=1e-12)


@pytest.mark.parametrize('seed', SEEDS)
@pytest.mark.parametrize('begun', [True, False])
def test_skye_holds_a_moving_point_in_six_degrees_of_freedom(asked, seed, begun):
    chance = np.random.default_rng(seed)
    made, constants = ready('skye')
    gains, (motion, setpoint, turn) = constants.gains, somewhere(chance)
    goal = np.array([*chance.normal(1.0, 0.5, 2), setpoint.altitude])
    before = np.clip(chance.normal(0.0, gains.integral_limit, 3), -10.0, 10.0)
    memory = made.start._replace(
        begun=begun, goal=tuple(goal[:2]), integral=tuple(before), thrusts=(0.5,) * 8
    )
    after = made.step(constants, memory, LawInputs(motion, setpoint, DT), create_working_array())
    wanted = along(setpoint.heading, setpoint.speed)
    if not begun:
        goal[:2] = motion.position[:2]
    goal += DT * wanted
    error = np.clip(goal - motion.position, -gains.reach, gains.reach)
    limit = gains.integral_limit
    integral = np.clip(before + DT * gains.position_ki * error, -limit, limit)
    force = gains.position_kp * error + integral + dragged(constants.drag, setpoint)
    force += gains.position_kd * (wanted - turn.apply(motion.velocity))
    force[2] += constants.weight
    moment = gains.attitude_kp * small_turn(turn, Rotation.from_euler('z', setpoint.heading))
    moment -= gains.attitude_kd * np.array(motion.rates)
    assert asked[0][0] == close([*turn.inv().apply(force), *moment])
    assert asked[0][1] == (0.5,) * 8
    assert (after.begun, after.goal, after.integral) == (True, close(goal[:2]), close(integral))
    assert after.thrusts == thrusts(constants.rotors)
    assert after.command.duties == thrusts_to_duties(
        constants.rotors, after.thrusts, create_working_array()
    )


@pytest.mark.parametrize('seed', SEEDS)
def test_sblimp_pushes_the_way_the_velocity_should_change(asked, seed):
    chance = np.random.default_rng(seed)
    made, constants = ready('sblimp')
    gains, (motion, setpoint, turn) = constants.gains, somewhere(chance)
    climb, east, north = chance.normal(0.0, 0.05, 3).tolist()
    gap = chance.normal(0.0, 0.05, 3).tolist()
    memory = made.start._replace(climb=climb, east=east, north=north, missing=tuple(gap))
    after = made.step(constants, memory, LawInputs(motion, setpoint, DT), create_working_array())
    lag = along(setpoint.heading, setpoint.speed) - turn.apply(motion.velocity)
    up, climb = climbing(gains, climb, setpoint.altitude - motion.position[2], -lag[2], gap[2])
    fx, east = pid(gains.velocity, east, lag[0], 0.0, gap[0])
    fy, north = pid(gains.velocity, north, lag[1], 0.0, gap[1])
    force = np.array([fx, fy, up + constants.weight]) + dragged(constants.drag, setpoint)
    wrench = [*turn.inv().apply(force), 0.0, 0.0, -gains.yaw_damping * motion.rates[2]]
    assert asked[0][0] == close(wrench)
    assert (after.climb, after.east, after.north) == close([climb, east, north])
    assert after.missing == close(turn.apply(GIVEN[:3]) - force)
    assert after.thrusts == thrusts(constants.rotors)
    assert after.command.duties == thrusts_to_duties(
        constants.rotors, after.thrusts, create_working_array()
    )


@pytest.mark.parametrize('seed', SEEDS)
@pytest.mark.parametrize('begun', [True, False])
def test_the_multirotor_tilts_as_its_velocity_needs(asked, seed, begun):
    chance = np.random.default_rng(seed)
    made, constants = ready('multirotor')
    gains, (motion, setpoint, turn) = constants.gains, somewhere(chance)
    climb, east, north, gap = chance.normal(0.0, 0.05, 4).tolist()
    rates, slopes = chance.normal(0.0, 0.3, 3), chance.normal(0.0, 1.0, 2)
    memory = made.start._replace(
        begun=begun, climb=climb, east=east, north=north, missing=gap,
        rates=tuple(rates.tolist()), slopes=tuple(slopes.tolist()),
    )  # fmt: skip
    after = made.step(constants, memory, LawInputs(motion, setpoint, DT), create_working_array())
    lag = along(setpoint.heading, setpoint.speed) - turn.apply(motion.velocity)
    push, climb = climbing(gains, climb, setpoint.altitude - motion.position[2], -lag[2], gap)
    thrust = (constants.weight + push) / max(turn.as_matrix()[2, 2], 0.5)
    ax, east = pid(gains.velocity, east, lag[0])
    ay, north = pid(gains.velocity, north, lag[1])
    yaw = yaw_of(turn)
    level = Rotation.from_euler('z', -yaw).apply([ax, ay, 0.0]) / STANDARD_GRAVITY
    goal = Rotation.from_euler('ZYX', [yaw, math.atan(level[0]), -math.atan(level[1])])
    wanted = gains.attitude_kp * small_turn(turn, goal)
    wanted[2] = gains.heading_kp * wrapped(setpoint.heading - yaw)
    wanted = np.clip(wanted, -gains.rate_limit, gains.rate_limit)
    now = np.array(motion.rates)
    share = DT / (gains.slope_time + DT)
    slope = (1.0 - share) * slopes + share * ((now - rates)[:2] / DT if begun else 0.0)
    moment = gains.rate_kp * (wanted - now)
    moment[2] = gains.yaw_rate_kp * (wanted - now)[2]
    moment[:2] -= gains.rate_kd * slope
    assert asked[0][0] == close([0.0, 0.0, thrust, *(constants.inertia * moment)])
    assert (after.climb, after.east, after.north) == close([climb, east, north])
    assert (after.rates, after.slopes) == (motion.rates, close(slope))
    assert (after.begun, after.missing) == (True, close(GIVEN[2] - thrust))


@pytest.mark.parametrize('seed', SEEDS)
def test_beavis_pushes_along_its_course_whatever_its_heading(monkeypatch, seed):
    chance = np.random.default_rng(seed)
    made, constants = ready('beavis')
    gains, (motion, setpoint, turn) = constants.gains, somewhere(chance, fast=0.1)
    climb, yaw_rate, surge, sway = chance.normal(0.0, 0.005, 4).tolist()
    gap = chance.normal(0.0, 0.005, 4).tolist()
    memory = made.start._replace(
        climb=climb, yaw_rate=yaw_rate, surge=surge, sway=sway, missing=tuple(gap)
    )
    wanted = []

    def mixed(constants, *asked):
        wanted.extend(asked)
        return thrusts(constants.rotors), 0.75, 0.02

    monkeypatch.setattr(lateral, 'mix_thrusts', mixed)
    after = made.step(constants, memory, LawInputs(motion, setpoint, DT), create_working_array())
    rising = turn.apply(motion.velocity)[2]
    error = setpoint.altitude - motion.position[2]
    push, climb = climbing(gains, climb, error, rising, gap[0])
    off = wrapped(setpoint.heading - yaw_of(turn))
    rate = np.clip(gains.heading_kp * off, -gains.yaw_rate_limit, gains.yaw_rate_limit)
    moment, yaw_rate = pid(gains.yaw_rate, yaw_rate, rate - motion.rates[2], 0.0, gap[1])
    lag = along(off, setpoint.speed) - motion.velocity
    fx, surge = pid(gains.velocity, surge, lag[0], 0.0, gap[2])
    fy, sway = pid(gains.velocity, sway, lag[1], 0.0, gap[3])
    assert wanted == close([max(constants.weight + push, 0.0), fx, fy, moment])
    assert [after.climb, after.yaw_rate, after.surge, after.sway] == close(
        [climb, yaw_rate, surge, sway]
    )
    short = [0.02 - constants.weight - push, *(-0.25 * np.array([moment, fx, fy]))]
    assert after.missing == close(short)


@pytest.mark.parametrize('seed', SEEDS)
def test_rgblimp_sets_pitch_by_its_mass_and_yaw_by_its_propellers(seed):
    chance = np.random.default_rng(seed)
    made, constants = ready('rgblimp')
    gains, (motion, setpoint, turn) = constants.gains, somewhere(chance)
    climb, pitch, speed, yaw_rate = (0.02 * chance.normal(0.0, 1.0, 4)).tolist()
    gap = chance.normal(0.0, 0.01, 3).tolist()
    memory = made.start._replace(
        climb=climb, pitch=pitch, speed=speed, yaw_rate=yaw_rate, missing=tuple(gap)
    )
    after = made.step(constants, memory, LawInputs(motion, setpoint, DT), create_working_array())
    rising = turn.apply(motion.velocity)[2]
    error = gains.altitude_kp * (setpoint.altitude - motion.position[2])
    wanted = np.clip(error, -gains.climb_limit, gains.climb_limit)
    nose, climb = pid(gains.climb, climb, wanted - rising)
    nose_up = math.asin(turn.as_matrix()[2, 0])
    back, pitch = pid(gains.pitch, pitch, nose - nose_up, -motion.rates[1], gap[0])
    place = float(np.clip(constants.rest[0] - back, constants.low, constants.high))
    thrust, speed = pid(gains.speed, speed, setpoint.speed - motion.velocity[0], 0.0, gap[1])
    off = wrapped(setpoint.heading - yaw_of(turn))
    rate = np.clip(gains.heading_kp * off, -gains.yaw_rate_limit, gains.yaw_rate_limit)
    moment, yaw_rate = pid(gains.yaw_rate, yaw_rate, rate - motion.rates[2], 0.0, gap[2])
    full = constants.rotors.high[0]
    half = float(np.clip(moment / (2.0 * constants.lever), -full / 2, full / 2))
    middle = float(np.clip(thrust / 2, abs(half), full - abs(half)))
    each = (middle - half, middle + half, *(0.0,) * 6)
    assert after.command.duties == close(duties(constants, each))
    assert after.command.mass_place == (close(place), *constants.rest[1:])
    assert [after.climb, after.pitch, after.speed, after.yaw_rate] == close(
        [climb, pitch, speed, yaw_rate]
    )
    given = [constants.rest[0] - place, 2.0 * middle, 2.0 * half * constants.lever]
    assert after.missing == close(np.array(given) - [back, thrust, moment])


def test_the_lever_of_the_glider_is_half_the_distance_of_its_propellers():
    """The columns give the moment of one newton each: the right one turns it left."""
    _, constants = ready('rgblimp')
    left, right = load_vehicle('rgblimp').allocation
    assert left[5] < 0.0 < right[5]
    assert constants.lever == pytest.approx((right[5] - left[5]) / 2)
    assert glide.TWO_COLUMNS == 2


@pytest.mark.parametrize('seed', SEEDS)
@pytest.mark.parametrize('begun', [True, False])
def test_blimp2b_asks_for_the_drag_and_weight_of_steady_motion_to_its_setpoint(asked, seed, begun):
    """Odd seeds start so near that one step gets there; for even ones the rate limits count."""
    chance = np.random.default_rng(seed)
    made, constants = ready('blimp2b')
    vehicle, gains = load_vehicle('blimp2b'), constants.gains
    _, setpoint, _ = somewhere(chance)
    near = 0.5 * DT * chance.uniform(-1.0, 1.0) if seed % 2 else chance.normal()
    altitude = setpoint.altitude - near * gains.climb_rate
    heading = wrapped(setpoint.heading - near * gains.turn_rate)
    memory = made.start._replace(begun=begun, altitude=altitude, heading=heading)
    memory = memory._replace(thrusts=(0.5,) * 8)
    after = made.step(
        constants, memory, LawInputs(ControlMotion(), setpoint, DT), create_working_array()
    )
    if not begun:
        altitude = vehicle.hull_height_on_floor
    limits = (gains.climb_rate, gains.turn_rate)
    wanted = np.array([setpoint.altitude - altitude, wrapped(setpoint.heading - heading)]) / DT
    climb, turn = np.clip(wanted, [-x for x in limits], limits)
    linear, quadratic = vehicle.file.aero.linear_drag, vehicle.file.aero.quadratic_drag
    terms = [*linear.force.vector, *linear.moment.vector]
    squares = [*quadratic.force.vector, *quadratic.moment.vector]
    wrench = [0.0, 0.0, vehicle.heaviness * STANDARD_GRAVITY, 0.0, 0.0, 0.0]
    for axis, speed in ((0, setpoint.speed), (2, climb), (5, turn)):
        wrench[axis] += terms[axis] * speed + squares[axis] * speed * abs(speed)
    assert asked[0] == (close(wrench), (0.5,) * 8)
    assert after.altitude == pytest.approx(altitude + DT * climb)
    assert after.heading == pytest.approx(wrapped(heading + DT * turn))
    assert (after.begun, after.thrusts) == (True, thrusts(constants.rotors))
    assert after.command.duties == thrusts_to_duties(
        constants.rotors, after.thrusts, create_working_array()
    )
