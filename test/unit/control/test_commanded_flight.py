# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""A flight by commands: each task, how each may end, and what the drone does then."""

import math
from pathlib import Path
import re

from lta_config.errors import BadInput
from lta_control.actions.tasks import (
    TaskKind,
    TaskLimits,
    TaskOutcome,
    TaskProgress,
    TaskResult,
)
from lta_control.commanded_flight import check_commanded, CommandedFlight
from lta_control.guidance import GuidanceInputs, ReserveReport, ReserveResponseSettings
from lta_control.mission import MissionSettings, Phase
from lta_control.motion import CascadeMeasurement, Setpoint
from lta_control.odometry.tracked_motion import LocatedMotion
from lta_control.place_hold import Place, Route
from lta_control.strategies import find_navigation_strategy
from lta_control.strategies.protocol import LightMeasurement, NavigationStrategy, SteeringCommand
import pytest

ACTIONS = Path(__file__).resolve().parents[3] / 'src/lta_msgs/action'
STANDING = 0.4  # m
GROUND = 0.42  # m, within the tolerance of standing
BLOCK_NS = 100_000_000
SETTINGS = MissionSettings()  # flown at 0.5 m, reached 0.04 m below, landing to 0.3 m
LIMITS = TaskLimits(take_off=10.0, go_to_lamp=20.0, place=20.0, unseen=5.0, land=10.0)
BLIND = LightMeasurement(seen=False, bearing=0.0, heading=1.0, amplitudes=(0.0,) * 8, interval=0.1)
SEEN = BLIND._replace(seen=True, bearing=0.4, strength=10.0)
NEAR = SEEN._replace(strength=200.0)

THERE = Route((Place(3.0, 0.0, 0.7),), 0.5)


def steer(_settings, memory, sight):
    """Turn to the light at 0.5 m/s; strong light is an arrival. Remember heading and distance."""
    heading = sight.heading + sight.bearing
    near = sight.strength >= 100.0
    distance = 100.0 / sight.strength if sight.strength else math.nan
    return SteeringCommand(heading, 0.1 if near else 0.5, near), (heading, distance)


STRATEGY = NavigationStrategy(
    'simple', lambda heading: (heading, math.nan), steer, onward=lambda memory: memory,
    distance=lambda memory: memory[1],
)  # fmt: skip


class Drone:
    """A flight with the inputs that it gets; each step is one light block."""

    def __init__(self, action='land'):
        self.flight = CommandedFlight(LIMITS, STANDING, (10.0, 8.0, 3.0))
        self.reserve = ReserveResponseSettings(action=action)
        self.blocks = 0
        self.altitude, self.climb, self.sight = GROUND, 0.0, BLIND
        self.measured, self.report = True, ReserveReport(0, False, False)
        self.located = None

    def step(self, seconds=0.1):
        """Fly light blocks for a time, and return the last setpoint."""
        for _ in range(round(seconds * 10)):
            self.blocks += 1
            stamp_ns = self.blocks * BLOCK_NS
            if self.report is not None:
                self.report = self.report._replace(reserve_ns=stamp_ns)
            at = CascadeMeasurement(self.altitude, self.climb, 1.0, 0.0, 0.0, 0.0, 0.0)
            inputs = GuidanceInputs(
                SETTINGS, self.reserve, STRATEGY, stamp_ns, self.sight,
                at if self.measured else None, self.report, self.located,
            )  # fmt: skip
            setpoint = self.flight.choose_setpoint(inputs)
        return setpoint

    @property
    def phase(self):
        return self.flight.mission.phase


@pytest.fixture
def rests():
    drone = Drone()
    drone.step()
    return drone


def fly(drone):
    """Take off to 0.5 m."""
    task = drone.flight.request(TaskKind.TAKE_OFF)
    drone.step()
    drone.altitude = 0.5
    drone.step()
    assert task.result == TaskResult(TaskOutcome.SUCCEEDED, 'the height is reached')
    return drone


@pytest.fixture
def holds(rests):
    return fly(rests)


def place_at(drone, x, y):
    """Let a tracker see the drone at rest with its nose along map x, which is 1 rad in odom."""
    drone.located = LocatedMotion((x, y), (0.0, 0.0), (0.0, 0.0), 0.0, 1.0, True)


@pytest.fixture
def tracked(rests):
    """Return a drone that holds its place in the origin of the map."""
    place_at(rests, 0.0, 0.0)
    return fly(rests)


def outcome(task):
    return None if task.result is None else task.result.outcome


def test_without_a_command_it_stays_on_the_ground(rests):
    assert rests.step(60.0) == Setpoint(0.0, 1.0, 0.0)
    assert rests.phase is Phase.REST


@pytest.mark.parametrize(('asked', 'height'), [(0.0, 0.5), (0.8, 0.8)])
def test_a_take_off_climbs_to_its_height_and_holds_there(rests, asked, height):
    task = rests.flight.request(TaskKind.TAKE_OFF, asked)
    assert rests.step() == Setpoint(height, 1.0, 0.0)
    rests.altitude, rests.climb = height - 0.041, 0.1
    rests.step()
    assert task.result is None
    assert rests.flight.progress.height == height - 0.041
    assert rests.flight.progress.climb == 0.1
    rests.altitude = height - 0.039
    rests.sight = BLIND._replace(heading=1.2)  # the heading of the take-off is held
    assert rests.step() == Setpoint(height, 1.0, 0.0)
    assert outcome(task) is TaskOutcome.SUCCEEDED
    assert rests.step(60.0) == Setpoint(height, 1.0, 0.0)
    assert rests.phase is Phase.HOLD


def test_a_flight_to_a_lamp_steers_until_it_arrives(holds):
    task = holds.flight.request(TaskKind.GO_TO_LAMP, 170.0)
    assert holds.flight.beacon == 170.0
    holds.sight = NEAR
    # Two blocks may still hold the light of another lamp: no bearing, no arrival
    assert holds.step(0.2) == Setpoint(0.5, 1.0, 0.5)
    holds.sight = SEEN
    assert holds.step() == Setpoint(0.5, pytest.approx(1.4), 0.5)
    holds.step()
    assert holds.flight.progress == TaskProgress(0.5, 0.0, True, 10.0, 0.4)
    assert task.result is None
    holds.sight = NEAR
    assert holds.step(3.0) == Setpoint(0.5, pytest.approx(1.4), 0.1)
    assert task.result is None
    holds.step()
    assert task.result == TaskResult(TaskOutcome.SUCCEEDED, 'the lamp is reached')
    # It holds its position as the strategy does, and does not search for a lamp that it loses
    assert holds.step(60.0) == Setpoint(0.5, pytest.approx(1.4), 0.1)
    holds.sight = BLIND
    assert holds.step(60.0) == Setpoint(0.5, 1.0, 0.0)
    assert holds.phase is Phase.HOLD


@pytest.mark.parametrize(
    'away',
    [SEEN, NEAR._replace(strength=100.0)],  # the second 1 m from the lamp, which it once reached
)
def test_a_drone_that_passes_the_lamp_has_not_reached_it(holds, away):
    task = holds.flight.request(TaskKind.GO_TO_LAMP)
    for sight in (NEAR, away, NEAR):
        holds.sight = sight
        holds.step(2.9)
    assert task.result is None
    holds.step(0.2)
    assert outcome(task) is TaskOutcome.SUCCEEDED


def test_a_flight_to_a_place_succeeds_after_3_s_there(tracked):
    task = tracked.flight.request(TaskKind.GO_TO_POSE, 0.0, THERE)
    setpoint = tracked.step()
    assert setpoint[:2] == pytest.approx((0.7, 1.0))  # along map x
    # T = pi / 0.48 = 6.545 s: 0.12 (sqrt(T^2 + 2 * 3 / 0.12) - T) = 0.369 m/s, but no more than
    assert setpoint.speed == pytest.approx(0.3)
    # 3 m away, and 0.2 m below
    assert tracked.flight.progress.distance == pytest.approx(math.hypot(3.0, 0.2))
    tracked.altitude = 0.7
    place_at(tracked, 2.6, 0.0)
    tracked.step(2.9)
    place_at(tracked, 2.4, 0.0)  # it passes
    tracked.step()
    place_at(tracked, 3.1, 0.0)
    tracked.step(3.0)
    assert task.result is None
    tracked.step()
    assert task.result == TaskResult(TaskOutcome.SUCCEEDED, 'the place is reached')
    # And it returns whenever it has drifted off
    place_at(tracked, 1.0, 0.0)
    assert tracked.step(5.0).speed > 0.2


def test_a_path_is_flown_place_by_place(tracked):
    path = Route((Place(0.2, 0.0, 0.0), Place(0.2, 3.0, 0.0)))
    task = tracked.flight.request(TaskKind.FOLLOW_PATH, 0.0, path)
    tracked.step()
    assert task.place == 1  # the first was within the 1 m of the settings
    # To the left of the nose, 0.5 rad at a time in calm air
    assert tracked.step().heading == pytest.approx(1.5)
    assert tracked.flight.progress.place == 1
    place_at(tracked, 0.2, 2.5)
    tracked.step(3.1)
    assert outcome(task) is TaskOutcome.SUCCEEDED


def test_a_place_that_is_not_reached_in_time_ends_in_a_hold_where_the_drone_is(tracked):
    task = tracked.flight.request(TaskKind.GO_TO_POSE, 0.0, THERE)
    tracked.altitude = 0.7
    place_at(tracked, 1.0, 0.0)
    tracked.step(20.2)
    assert task.result == TaskResult(
        TaskOutcome.TIMEOUT, '2.00 m from the place after 20 s; holding'
    )
    assert tracked.step().speed == 0.0


def test_a_lost_tracker_ends_a_flight_to_a_place_and_every_thrust_for_it(tracked):
    task = tracked.flight.request(TaskKind.GO_TO_POSE, 0.0, THERE)
    assert tracked.step().speed > 0.0
    before = tracked.located
    tracked.located = before._replace(tracked=False)
    assert tracked.step() == Setpoint(0.7, 1.0, 0.0)
    assert task.result == TaskResult(
        TaskOutcome.FAULT, 'the tracker is lost; holding height and heading'
    )
    assert refuse(tracked, TaskKind.GO_TO_POSE) == 'no tracker sees the drone'
    tracked.located = before
    assert tracked.step(5.0) == Setpoint(0.7, 1.0, 0.0)
    assert tracked.flight.find_obstacle(TaskKind.GO_TO_POSE, 0.0, THERE) == ''


def test_a_place_outside_the_room_is_refused(tracked):
    outside = Route((Place(6.0, 0.0, 0.0),))
    assert 'outside the room' in refuse(tracked, TaskKind.GO_TO_POSE, 0.0, outside)


def test_a_tracked_drone_holds_its_place_after_each_command(tracked):
    place_at(tracked, -2.0, 0.0)  # blown off after the take-off
    assert tracked.step().speed > 0.1
    task = tracked.flight.request(TaskKind.GO_TO_POSE, 0.0, THERE)
    tracked.step()
    assert tracked.flight.cancel(task)
    assert tracked.step().speed == 0.0
    place_at(tracked, -4.0, 0.0)  # 2 m from where it was canceled
    assert tracked.step().speed > 0.1


def test_a_landing_ends_on_the_ground_and_the_drone_can_take_off_again(holds):
    task = holds.flight.request(TaskKind.LAND)
    assert holds.step() == Setpoint(0.3, 1.0, 0.0)
    holds.altitude, holds.climb = GROUND, -0.06  # still sinking
    holds.step()
    assert task.result is None
    holds.climb = 0.0
    assert holds.step() == Setpoint(0.0, 1.0, 0.0)
    assert task.result == TaskResult(TaskOutcome.SUCCEEDED, 'the drone stands on the ground')
    fly(holds)


def refuse(drone, kind, value=0.0, route=THERE):
    """Request a task that is refused, and return why; nothing changes."""
    before = drone.flight.mission
    why = drone.flight.find_obstacle(kind, value, route)
    with pytest.raises(BadInput, match=re.escape(why)):
        drone.flight.request(kind, value, route)
    assert drone.flight.mission == before
    return why


def test_nothing_begins_before_the_first_light_block():
    for kind in TaskKind:
        assert refuse(Drone(), kind) == 'no light block has come yet'


def test_on_the_ground_only_a_take_off_begins(rests):
    for kind in (TaskKind.GO_TO_LAMP, TaskKind.LAND):
        assert refuse(rests, kind) == 'the drone does not fly'


@pytest.mark.parametrize('height', [-1.0, 0.44, 0.47, 100.1, math.inf, math.nan])
def test_a_height_that_cannot_be_flown_is_refused(rests, height):
    assert refuse(rests, TaskKind.TAKE_OFF, height) == (
        f'the hull centre cannot fly {height:g} m above the ground; give more than 0.47, at most '
        '100'
    )


@pytest.mark.parametrize('frequency', [-1.0, 1e6, math.inf, math.nan])
def test_a_frequency_that_is_none_is_refused(holds, frequency):
    assert 'a lamp cannot flicker at' in refuse(holds, TaskKind.GO_TO_LAMP, frequency)


def test_while_one_task_runs_only_a_landing_begins_and_ends_it(holds):
    task = holds.flight.request(TaskKind.GO_TO_LAMP)
    for kind in (TaskKind.GO_TO_LAMP, TaskKind.TAKE_OFF):
        assert refuse(holds, kind) == 'go_to_lamp is in progress; cancel it first'
    landing = holds.flight.request(TaskKind.LAND)
    assert task.result == TaskResult(TaskOutcome.CANCELED, 'a landing was commanded')
    assert holds.step() == Setpoint(0.3, 1.0, 0.0)
    assert landing.result is None


def test_in_the_air_no_take_off_begins(holds):
    assert refuse(holds, TaskKind.TAKE_OFF) == 'the drone flies already'


@pytest.mark.parametrize(
    ('report', 'why'),
    [
        (None, 'no report from the energy monitor'),
        (ReserveReport(0, True, False), 'the energy reserve is reached'),
        (ReserveReport(0, False, True, 'the battery is empty'), 'the battery is empty'),
    ],
)
def test_without_energy_no_take_off_begins(rests, report, why):
    rests.report = report
    rests.step()
    assert refuse(rests, TaskKind.TAKE_OFF) == why


def test_while_the_estimate_is_unknown_nothing_begins(rests):
    rests.measured = False
    assert rests.step() == Setpoint(0.0, 1.0, 0.0)
    assert refuse(rests, TaskKind.TAKE_OFF) == 'the estimate is unknown'
    rests.measured = True
    rests.step()
    fly(rests)


def test_a_take_off_that_does_not_rise_ends_in_a_landing(rests):
    """Motors that are armed minutes later must not start."""
    task = rests.flight.request(TaskKind.TAKE_OFF)
    rests.step(10.1)  # the limit counts from the first block
    assert task.result is None
    assert rests.step().altitude == 0.3
    assert outcome(task) is TaskOutcome.TIMEOUT
    assert rests.step() == Setpoint(0.0, 1.0, 0.0)
    assert rests.phase is Phase.REST


def test_a_lamp_that_is_not_reached_in_time_ends_in_holding(holds):
    task = holds.flight.request(TaskKind.GO_TO_LAMP)
    holds.sight = SEEN
    holds.step(20.1)
    assert task.result is None
    assert holds.step() == Setpoint(0.5, 1.0, 0.0)
    assert task.result == TaskResult(TaskOutcome.TIMEOUT, 'not at the lamp after 20 s; holding')


def test_a_lamp_that_is_not_seen_ends_in_holding(holds):
    task = holds.flight.request(TaskKind.GO_TO_LAMP)
    holds.sight = SEEN
    holds.step(3.0)
    holds.sight = BLIND
    holds.step(5.0)
    assert task.result is None
    assert holds.step() == Setpoint(0.5, 1.0, 0.0)
    assert task.result == TaskResult(
        TaskOutcome.NOT_SEEN, 'no light from the lamp for 5 s; holding'
    )


@pytest.mark.parametrize('kind', [TaskKind.GO_TO_LAMP, TaskKind.LAND])
def test_time_limits_count_on_after_a_clock_that_jumps_back(holds, kind):
    holds.blocks = 1000
    holds.step()
    task = holds.flight.request(kind)
    holds.sight = SEEN
    holds.step(5.0)
    holds.blocks = 10
    # The blocks at its begin and at the jump count as no time
    limit = LIMITS.go_to_lamp if kind is TaskKind.GO_TO_LAMP else LIMITS.land
    holds.step(limit - 5.0 + 0.2)
    assert task.result is None
    holds.step(0.1)
    assert outcome(task) is TaskOutcome.TIMEOUT


def test_a_landing_ends_on_a_floor_that_reads_too_high(holds):
    """Otherwise it would never end, and no take-off would be accepted again."""
    holds.flight.limits = LIMITS.model_copy(update={'land': 60.0})
    task = holds.flight.request(TaskKind.LAND)
    for tenth in range(10):  # 5 cm/s from 0.5 m
        holds.altitude = 0.5 - 0.005 * tenth
        holds.step()
    holds.altitude = STANDING + 0.05
    holds.step(14.9)
    assert task.result is None
    assert holds.step(0.5) == Setpoint(0.0, 1.0, 0.0)
    assert outcome(task) is TaskOutcome.SUCCEEDED
    fly(holds)


def test_a_drone_that_is_carried_up_without_its_motors_does_not_hold(rests):
    """Motors that are armed later would turn in somebody's hands."""
    rests.flight.motors_turn = False
    task = rests.flight.request(TaskKind.TAKE_OFF)
    rests.step()
    rests.altitude = 0.5
    assert rests.step() == Setpoint(0.3, 1.0, 0.0)
    assert task.result == TaskResult(
        TaskOutcome.FAULT, 'lifted without its motors; landing (are they armed?)'
    )
    assert rests.phase is Phase.LAND


def test_motors_that_turned_at_any_time_of_the_climb_have_lifted_it(rests):
    task = rests.flight.request(TaskKind.TAKE_OFF)
    rests.step()
    rests.flight.motors_turn = False  # it coasts into its height
    rests.altitude = 0.5
    rests.step()
    assert outcome(task) is TaskOutcome.SUCCEEDED


def test_a_landing_that_takes_too_long_goes_on(holds):
    task = holds.flight.request(TaskKind.LAND)
    holds.step(10.1)
    assert task.result is None
    assert holds.step() == Setpoint(0.3, 1.0, 0.0)
    assert task.result == TaskResult(TaskOutcome.TIMEOUT, 'not on the ground after 10 s')
    assert holds.phase is Phase.LAND


@pytest.mark.parametrize(
    ('report', 'ended'),
    [
        (ReserveReport(0, True, False), TaskOutcome.RESERVE),
        (ReserveReport(0, False, True, 'the battery is empty'), TaskOutcome.RESERVE),
        (None, TaskOutcome.FAULT),
    ],
)
@pytest.mark.parametrize('kind', [TaskKind.TAKE_OFF, TaskKind.GO_TO_LAMP])
def test_the_reserve_ends_a_task_and_lands(rests, report, ended, kind):
    drone = rests if kind is TaskKind.TAKE_OFF else fly(rests)
    task = drone.flight.request(kind)
    drone.step()
    drone.report = report
    assert drone.step().altitude == 0.3
    assert outcome(task) is ended
    assert drone.phase is Phase.LAND


def test_a_drone_whose_client_has_gone_holds_until_the_reserve_lands_it(holds):
    assert holds.step(600.0) == Setpoint(0.5, 1.0, 0.0)
    holds.report = ReserveReport(0, True, False)
    assert holds.step() == Setpoint(0.3, 1.0, 0.0)
    assert refuse(holds, TaskKind.GO_TO_LAMP) == 'the energy reserve is reached'
    holds.altitude = GROUND
    holds.step()
    assert refuse(holds, TaskKind.TAKE_OFF) == 'the energy reserve is reached'


def test_the_reserve_returns_where_it_is_set_so():
    drone = Drone(action='return')
    drone.step()
    fly(drone)
    task = drone.flight.request(TaskKind.GO_TO_LAMP)
    drone.sight = SEEN._replace(position=(3.0, 0.0))
    drone.step()
    drone.report = ReserveReport(0, True, False)
    # It took off at the origin
    assert drone.step() == Setpoint(0.5, pytest.approx(math.pi), 0.5)
    assert outcome(task) is TaskOutcome.RESERVE
    assert refuse(drone, TaskKind.GO_TO_LAMP) == 'the energy reserve is reached'


def test_the_reserve_flies_on_to_the_lamp_where_it_is_set_so():
    drone = Drone(action='perch')
    drone.step()
    fly(drone)
    task = drone.flight.request(TaskKind.GO_TO_LAMP)
    drone.sight = NEAR
    drone.report = ReserveReport(0, True, False)
    drone.step(3.0)
    assert task.result is None
    drone.step(0.3)  # two blocks without light, and the first at the lamp
    assert outcome(task) is TaskOutcome.SUCCEEDED
    assert drone.step().altitude == 0.3


def test_a_commanded_landing_goes_on_through_the_reserve(holds):
    task = holds.flight.request(TaskKind.LAND)
    holds.report = ReserveReport(0, True, False)
    holds.step()
    assert task.result is None
    holds.altitude = GROUND
    holds.step()
    assert outcome(task) is TaskOutcome.SUCCEEDED


@pytest.mark.parametrize('kind', list(TaskKind))
def test_a_fault_ends_each_task_and_lands(rests, kind):
    place_at(rests, 0.0, 0.0)
    drone = rests if kind is TaskKind.TAKE_OFF else fly(rests)
    task = drone.flight.request(kind, 0.0, THERE)
    drone.step()
    drone.flight.fail('the drone turned over')
    assert task.result == TaskResult(TaskOutcome.FAULT, 'the drone turned over')
    assert drone.phase is Phase.LAND
    assert refuse(drone, kind) == 'the drone turned over'


def test_a_lost_estimate_ends_the_task_and_lands(holds):
    task = holds.flight.request(TaskKind.GO_TO_LAMP)
    holds.measured = False
    assert holds.step() == Setpoint(0.0, 1.0, 0.0)
    assert task.result == TaskResult(TaskOutcome.FAULT, 'the estimate is unknown')
    holds.measured = True
    assert holds.step() == Setpoint(0.3, 1.0, 0.0)


def test_a_drone_that_sank_to_the_ground_does_not_climb_again(holds):
    """Its motors may have been off: whoever arms them again does not start them."""
    task = holds.flight.request(TaskKind.GO_TO_LAMP)
    holds.altitude = GROUND
    assert holds.step() == Setpoint(0.0, 1.0, 0.0)
    assert task.result == TaskResult(TaskOutcome.FAULT, 'the drone stands on the ground')
    assert holds.step(60.0) == Setpoint(0.0, 1.0, 0.0)


def test_a_canceled_take_off_holds_the_height_reached(rests):
    task = rests.flight.request(TaskKind.TAKE_OFF, 2.0)
    rests.step()
    rests.altitude, rests.sight = 1.1, BLIND._replace(heading=1.2)
    rests.step()
    assert rests.flight.cancel(task)
    assert task.result == TaskResult(TaskOutcome.CANCELED, 'canceled')
    assert rests.step(60.0) == Setpoint(1.1, 1.2, 0.0)
    assert not rests.flight.cancel(task)


def test_a_canceled_flight_to_a_lamp_holds_heading_and_height(holds):
    task = holds.flight.request(TaskKind.GO_TO_LAMP)
    holds.sight, holds.altitude = SEEN._replace(heading=2.0), 0.53
    holds.step(1.0)
    assert holds.flight.cancel(task)
    assert outcome(task) is TaskOutcome.CANCELED
    assert holds.step(60.0) == Setpoint(0.5, 2.0, 0.0)


def test_a_canceled_landing_holds_the_height_reached(holds):
    task = holds.flight.request(TaskKind.LAND)
    holds.altitude = 0.47
    holds.step()
    assert holds.flight.cancel(task)
    assert outcome(task) is TaskOutcome.CANCELED
    assert holds.step(60.0) == Setpoint(0.47, 1.0, 0.0)


def test_a_person_ends_the_task_and_the_drone_stays_where_they_leave_it(holds):
    task = holds.flight.request(TaskKind.GO_TO_LAMP)
    holds.step()
    holds.flight.yield_to_person()
    assert task.result == TaskResult(TaskOutcome.CANCELED, 'a person took control')
    assert refuse(holds, TaskKind.LAND) == 'a person has control'
    holds.altitude = 0.9
    holds.step()
    holds.flight.yield_to_person()
    assert holds.step(60.0) == Setpoint(0.9, 1.0, 0.0)
    holds.altitude = GROUND  # they land it
    holds.step()
    assert holds.phase is Phase.REST
    holds.flight.yield_to_person()
    assert holds.step() == Setpoint(0.0, 1.0, 0.0)
    holds.altitude = 1.4  # they start again, and let go
    holds.step()
    holds.flight.yield_to_person()
    assert holds.step(60.0) == Setpoint(1.4, 1.0, 0.0)
    assert holds.phase is Phase.HOLD


def test_a_strategy_that_never_arrives_and_a_course_are_refused():
    with pytest.raises(BadInput, match='strategy bag never reports an arrival'):
        check_commanded(find_navigation_strategy('bag'), has_course=False)
    with pytest.raises(BadInput, match='with a course flies by itself'):
        check_commanded(find_navigation_strategy('homing'), has_course=True)
    check_commanded(find_navigation_strategy('homing'), has_course=False)


@pytest.mark.parametrize('path', sorted(ACTIONS.iterdir()), ids=lambda path: path.stem)
def test_the_outcomes_have_the_numbers_of_the_action(path):
    numbers = dict(re.findall(r'^uint8 (\w+)=(\d+)', path.read_text('utf-8'), re.MULTILINE))
    assert numbers == {name: str(TaskOutcome[name].value) for name in numbers}
    assert 'SUCCEEDED' in numbers
