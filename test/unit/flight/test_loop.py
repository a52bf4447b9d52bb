# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Whole flights in one process: they reach the lamp in good order, step by step as the graph."""

from dataclasses import dataclass, replace
from functools import cache
import math

from lta_config.files import find_file, load_yaml
from lta_config.topics import load_topic_table
from lta_control.allocation import create_working_array
from lta_control.autopilot import build_drone_constants, MEMORY_LAYOUT
from lta_control.estimator import EstimatorSettings
from lta_control.flight_step import DroneMemory, flight_step, SensorInputs
from lta_control.laws import load_gains
from lta_control.laws.cascade import CASCADE_LAW
from lta_control.mission import MissionSettings, Phase
from lta_control.motion import level_quaternion, Setpoint, wrap_angle, yaw_from_quaternion
from lta_control.strategies import find_navigation_strategy
from lta_control.strategies.bearing_angle import BEARING_ANGLE_STRATEGY
from lta_flight.closed_loop import ClosedLoop, newest_range, round_heading, round_to_float32
from lta_flight.flight_stack import FlightStack
from lta_model.scenario import load_scenario, Scenario
from lta_model.vehicle import load_vehicle
from lta_sim.readings import FlightOutcome
from lta_sim.world import World
from lta_vlc.demodulation import DiodeFault
import numpy as np
import pytest
import yaml

BLOCKS = 11  # control steps until the first light block is read
SEEDS = (1, 2, 3, 4, 5)
SPEED = 0.5


def start(seed, vehicle='gtmab', **policy):
    scenario = load_scenario('lamp_room')
    vehicle = load_vehicle(str(vehicle), scenario.air.density)
    table = load_topic_table()
    policy = {'strategy': find_navigation_strategy('bag'), 'gains': load_gains('gtmab'), **policy}
    world = World(vehicle, scenario, table, seed)
    return ClosedLoop(world, table, FlightStack(**policy))


@dataclass
class Flight:
    outcome: FlightOutcome
    time: np.ndarray
    position: np.ndarray  # true, map [m]
    surge: np.ndarray  # true, body; through still air [m/s]
    estimated: np.ndarray  # surge, altitude
    phases: list

    @property
    def path(self):
        return np.linalg.norm(np.diff(self.position[:, :2], axis=0), axis=1).sum()

    @property
    def cruise(self):
        """From where 90 % of the set speed is first reached."""
        return slice(int(np.argmax(self.surge >= 0.9 * SPEED)), None)


@cache
def fly(seed):
    loop = start(seed)
    rows, phases, outcome = [(0.0, *loop.world.state[:3], 0.0, 0.0, 0.0)], [Phase.REST], None
    while (outcome := loop.step()) is FlightOutcome.FLYING:
        state, estimate = loop.world.state, loop.estimate
        guess = estimate.airspeed.surge, estimate.altitude.height
        rows.append((loop.world.elapsed, *state[:3], state[7], *guess))
        phases.append(loop.mission.phase)
    rows.append((loop.world.elapsed, *loop.world.state[:3], loop.world.state[7], *guess))
    table = np.array(rows)
    return Flight(outcome, table[:, 0], table[:, 1:4], table[:, 4], table[:, 5:], phases)


@pytest.mark.parametrize('seed', SEEDS)
def test_it_reaches_the_lamp_in_good_order(seed):
    flight = fly(seed)
    cruise = flight.cruise
    assert flight.outcome is FlightOutcome.REACHED
    assert math.dist(flight.position[-1, :2], (3.5, 0.0)) <= 1.0
    assert 6.0 <= flight.path < 12.0  # 7 m to the lamp, which is reached at 1 m
    assert flight.time[-1] < 40.0
    assert flight.surge[cruise].mean() == pytest.approx(SPEED, abs=0.1)
    assert len(flight.surge[cruise]) > 300

    def rms(error):
        return math.sqrt(np.mean(error**2))

    height = flight.position[cruise, 2]
    assert rms(height - 0.5) < 0.05
    # Believed against true: 20 mm of offset of the range, and the model's airspeed
    assert rms(flight.estimated[cruise, 0] - flight.surge[cruise]) < 0.06
    assert rms(flight.estimated[cruise, 1] - height) < 0.03
    places = [list(Phase).index(phase) for phase in flight.phases]
    assert places == sorted(places)
    assert set(flight.phases) == {Phase.REST, Phase.CLIMB, Phase.SEEK}


def test_a_lamp_behind_is_reached_without_flying_away_from_it():
    """Seed 5 starts 160 degrees off: the push waits for the nose, so that little way is lost."""
    flight = fly(5)
    away = np.hypot(flight.position[:, 0] - 3.5, flight.position[:, 1])
    assert away[0] == pytest.approx(7.0)
    assert away.max() < 8.2


@pytest.mark.long
def test_nineteen_of_twenty_reach_the_lamp():
    flights = [fly(seed) for seed in range(1, 21)]
    assert sum(flight.outcome is FlightOutcome.REACHED for flight in flights) >= 19
    cruises = [flight.surge[flight.cruise].mean() for flight in flights]
    assert np.mean(cruises) == pytest.approx(SPEED, abs=0.1)


def test_one_seed_is_one_flight():
    a, b = start(7), start(7)
    for _ in range(700):
        assert a.step() is b.step()
    assert a.estimate == b.estimate
    assert a.duties == b.duties
    np.testing.assert_array_equal(a.world.state, b.world.state)


def test_the_motors_wait_for_the_estimator():
    loop = start(2)
    for step in range(230):
        loop.step()
        assert (loop.measured_state() is None) == (step < 199)  # 200 samples of rest
        assert step >= 199 or not any(loop.duties)
    assert any(loop.duties)
    assert loop.mission.phase is Phase.CLIMB


def test_a_setpoint_acts_one_step_after_its_light_block():
    loop, changes, before = start(2), [], None
    for step in range(900):
        loop.step()
        if loop.setpoint != before:
            changes.append(step)
        before = loop.setpoint
    assert changes[0] == 11  # the first block is whole at step 10
    assert len(changes) > 20
    assert {step % 10 for step in changes} == {1}


def test_a_bearing_is_added_to_the_heading_at_the_middle_of_its_block():
    seen, headings = [], []

    def spy(settings, memory, sight):
        seen.append((len(headings), sight.heading))
        return BEARING_ANGLE_STRATEGY.steer(settings, memory, sight)

    loop = start(2, strategy=replace(BEARING_ANGLE_STRATEGY, steer=spy))
    for _ in range(900):
        loop.step()
        headings.append(yaw_from_quaternion(loop.estimate.attitude))
    assert len(seen) > 20
    for step, believed in seen:
        assert believed == headings[step - 5]


def test_a_range_travels_in_32_bits_and_a_heading_as_a_level_attitude():
    assert round_to_float32(0.1) == 13421773 / 2**27  # the float32 nearest to 0.1
    assert level_quaternion(0.6) == (0.0, 0.0, math.sin(0.3), math.cos(0.3))
    asked = Setpoint(0.7, -2.5, 0.3)
    assert round_heading(asked) == pytest.approx(asked)


def test_the_newest_range_is_that_of_its_message():
    reach = (0.1, 0.3)
    assert newest_range([(1, 0.25), (2, 0.2)], reach) == round_to_float32(0.2) != 0.2
    # In single precision, 0.3 is above itself; as in the message, limit and distance are equal
    assert newest_range([(1, 0.3)], reach) == round_to_float32(0.3) > 0.3
    assert math.isnan(newest_range([(1, 0.31)], reach))
    assert math.isnan(newest_range([], reach))


def test_it_decides_as_plain_python_does():
    """A whole climb and search: the compiled step and the same functions in Python, to the bit."""
    loop, scratch = start(2), create_working_array()
    vehicle = load_vehicle('gtmab')
    drone = build_drone_constants(vehicle, EstimatorSettings(), load_gains('gtmab'), 0.01)
    memory, taken = DroneMemory(), []
    sense = loop.world.sense
    loop.world.sense = lambda: taken.append(sense()) or taken[-1]
    for _ in range(900):
        loop.step()
        readings = taken.pop()
        heard = SensorInputs(
            readings.rates,
            readings.force,
            round_to_float32(readings.ranges[-1][1]) if readings.ranges else math.nan,
            math.nan if readings.pressure is None else readings.pressure,
        )
        if loop.setpoint is not None:
            asked = round_heading(loop.setpoint)
            memory = memory._replace(setpoint=asked, guided=True)
        memory = flight_step(CASCADE_LAW, drone, memory, heard, scratch)
        np.testing.assert_array_equal(
            MEMORY_LAYOUT.write(loop.autopilot.memory), MEMORY_LAYOUT.write(memory)
        )
        assert loop.duties == memory.pilot.law.command.duties[:4]
    assert loop.mission.phase is Phase.SEEK
    assert any(loop.duties)


def test_the_controller_never_sees_the_truth():
    """What the cascade acts on is the estimate, which differs from the truth."""
    loop, pairs = start(2), []
    for _ in range(600):
        loop.step()
        if (measured := loop.measured_state()) is not None:
            pairs.append((measured.altitude, loop.world.state[2]))
    assert len(pairs) > 300
    assert all(believed != true for believed, true in pairs)


def test_it_hovers_at_the_altitude_it_is_told():
    loop = start(2, mission=MissionSettings(altitude=0.8, speed=0.0))
    heights = []
    for _ in range(4000):
        loop.step()
        heights.append(loop.world.state[2])
    # The range's own offset, up to 20 mm, is what it cannot know.
    assert np.mean(heights[-1000:]) == pytest.approx(0.8, abs=0.021)
    assert np.ptp(heights[-1000:]) < 0.02


def test_a_course_flies_the_same_without_the_light_and_the_meters():
    scenario, table = load_scenario('hall'), load_topic_table()
    vehicle = load_vehicle('gtmab', scenario.air.density)

    def setpoint_at(time):
        return Setpoint(1.0, 0.5, 0.3) if time >= 2.5 else None

    tracks = []
    for motion_only in (False, True):
        policy = FlightStack(
            find_navigation_strategy('bag'), load_gains('gtmab'), course=setpoint_at
        )
        world = World(vehicle, scenario, table, 1)
        loop = ClosedLoop(world, table, policy, motion_only=motion_only)
        rows = [
            (*world.state.tolist(), *loop.duties)
            for _ in loop.iterate_until(lambda world=world: world.elapsed >= 6.0)
        ]
        assert (loop.energy is None) == motion_only
        tracks.append(np.array(rows))
    full, fast = tracks
    assert (full == fast).all()
    duties = fast[:, -4:]
    assert not duties[:250].any()  # no setpoint yet
    assert duties[251].any()
    assert fast[-1, 2] > fast[0, 2] + 0.1


@pytest.mark.parametrize(('gain', 'calm'), [(None, True), (0.0, False)])
def test_the_forward_rotors_keep_the_hull_from_swinging(gain, calm):
    """The last 20 s of a minute of cruise; without their help it swings up by itself."""
    scenario = load_scenario('hall')
    table, gains = load_topic_table(), load_gains('gtmab')
    if gain is not None:
        gains = gains.model_copy(update={'swing_gain': gain})
    world = World(load_vehicle('gtmab', scenario.air.density), scenario, table, 1)
    loop = ClosedLoop(
        world,
        table,
        FlightStack(
            find_navigation_strategy('bag'), gains, course=lambda time: Setpoint(0.6, 0.0, 0.6)
        ),
    )
    tilts = []
    while world.elapsed < 60.0:
        loop.step()
        x, y = world.state[3], world.state[4]
        tilts.append(math.acos(1.0 - 2.0 * (x * x + y * y)))
    last = np.degrees(tilts[-2000:])
    assert (last.std() < 0.3) == calm
    assert (last.max() > 10.0) != calm


def with_rotors(path, change):
    """Write GT-MAB with other rotors: name to position [cm], force and moment per newton."""
    content = load_yaml(find_file('vehicle', 'gtmab'))
    rotors, columns = content['rotors'], content['aero']['thrust_allocation']
    for name, values in change.items():
        rotors.pop(name, None)
        columns.pop(name, None)
        if values:
            place, force, moment = (
                {'value': list(value), 'unit': unit, 'source': 'assumed'}
                for value, unit in zip(values, ('cm', 'N/N', 'm'), strict=True)
            )
            axis = {'value': [round(x) for x in values[1]], 'unit': '1', 'source': 'assumed'}
            rotors[name] = {'reversible': False, 'position': place, 'axis': axis}
            columns[name] = {'force': force, 'moment': moment}
    path.write_text(yaml.safe_dump(content, sort_keys=False), encoding='utf-8')
    return path


FLEETS = {
    3: {'up_left': None, 'up_right': None, 'up': ((0, 0, -34), (0, 0, 0.96), (0, 0, 0))},
    6: {
        'up_front': ((19, 0, -34), (0, 0, 0.96), (0, -0.188, 0)),
        'up_back': ((-19, 0, -34), (0, 0, 0.96), (0, 0.188, 0)),
    },
    8: {
        'up_front': ((19, 0, -34), (0, 0, 0.96), (0, -0.188, 0)),
        'up_back': ((-19, 0, -34), (0, 0, 0.96), (0, 0.188, 0)),
        'turn_left': ((30, 0, -34), (0, 0.96, 0), (0, 0, 0.3)),
        'turn_right': ((30, 0, -34), (0, -0.96, 0), (0, 0, -0.3)),
    },
}


@pytest.mark.parametrize('number', FLEETS)
def test_any_number_of_rotors_reaches_the_lamp(number, tmp_path):
    loop = start(1, with_rotors(tmp_path / 'rotors.yaml', FLEETS[number]))
    assert len(loop.duties) == number
    used = np.zeros(number)
    while (outcome := loop.step()) is FlightOutcome.FLYING:
        used = np.maximum(used, loop.duties)
    assert outcome is FlightOutcome.REACHED
    assert loop.world.elapsed < 40.0
    assert (used > 0.05).all()


def test_a_course_ends_on_the_floor_with_its_motors_off_and_counts_as_reached():
    scene = load_yaml(find_file('scenario', 'hall'))
    scene['goal']['time_limit'] = '40 s'
    up = {'at': '2 s', 'altitude': '0.9 m', 'heading': '90 deg', 'speed': '0 m/s'}
    down = {**up, 'at': '15 s', 'altitude': '0 m'}
    scene['course'] = {'between': 'step', 'rows': [up, down]}
    table, vehicle = load_topic_table(), load_vehicle('gtmab')
    world = World(vehicle, Scenario.model_validate(scene), table, 1)
    loop = ClosedLoop(
        world, table, FlightStack(find_navigation_strategy('bag'), load_gains('gtmab'))
    )
    heights, began = {}, world.state[2]
    turned = yaw_from_quaternion(tuple(world.state[3:7].tolist()))
    for _ in loop.iterate_steps():
        heights[round(world.elapsed, 2)] = float(world.state[2])
        if round(world.elapsed, 2) == 14.9:
            turned = wrap_angle(yaw_from_quaternion(tuple(world.state[3:7].tolist())) - turned)
    assert world.outcome is FlightOutcome.REACHED
    assert heights[1.9] == pytest.approx(began, abs=0.01)
    assert heights[14.9] == pytest.approx(0.9, abs=0.1)
    assert heights[40.0] == pytest.approx(began, abs=0.02)
    assert turned == pytest.approx(math.pi / 2, abs=0.1)
    assert set(loop.duties) == {0.0}


def test_a_finer_converter_hears_the_lamp_as_well(tmp_path):
    """Sixteen times as many counts, by the vehicle file; as of 12 bits all would be clipped."""
    content = load_yaml(find_file('vehicle', 'gtmab'))
    snr = []
    for bits in (12, 16):
        content['sensors']['diodes']['bits'] = bits
        path = tmp_path / f'{bits}.yaml'
        path.write_text(yaml.safe_dump(content, sort_keys=False), encoding='utf-8')
        loop = start(1, path)
        for _ in range(BLOCKS):
            loop.step()
        assert set(loop.light.hearing.faults) == {DiodeFault.NONE}
        snr.append(loop.light.hearing.peaks[0].snr.max())
    assert snr[1] > 0.9 * snr[0] > 10.0
