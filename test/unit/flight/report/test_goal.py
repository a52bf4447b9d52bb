# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The lamps of a route in their order: which is next, and when each was reached."""

import math
from types import SimpleNamespace

from lta_config.course import Course
from lta_flight.report.goal import FlightGoal
from lta_flight.report.page import build_tiles, describe_outcome
from lta_flight.report.results import compute_results
from lta_model.scenario import load_scenario
from lta_model.vehicle import load_vehicle
from lta_report.curves import DirectionCurve, MotionCurve, PeakCurves, TimeCurve
import numpy as np
import pytest

PATROL = load_scenario('warehouse_patrol')  # dock (-3.5, -2), aisle (3.5, -2), gate (0, 4)
ROUND = PATROL.model_copy(update={'route': ('aisle', 'dock')})  # ends where it begins
ROOM = load_scenario('lamp_room')  # at (3.5, 0)
TOPICS = {
    'peaks': 'light/peaks',
    'sighting': 'light/estimate',
    'speed_setpoint': 'setpoint/velocity',
}


def flown(x, scenario=ROUND, height=1.0, **more):
    """Return a flight along y = -2 at a height [m], one place a second, nose along x."""
    x = np.array(x, dtype=float)
    zero = np.zeros(len(x))
    here = {'time': np.arange(len(x), dtype=float), 'x': x, 'y': zero - 2.0, 'z': zero + height}
    truth = MotionCurve(**{name: here.get(name, zero) for name in MotionCurve._fields})
    known = {'ground_truth/odom', *(TOPICS[name] for name in more)}
    return SimpleNamespace(
        scene=SimpleNamespace(scenario=scenario, vehicle=None), goal=FlightGoal(scenario, truth),
        truth=truth, span=(0.0, float(len(x) - 1)),
        has_topics=lambda *topics: set(topics) <= known,
        **more,
    )  # fmt: skip


def test_a_round_is_not_over_where_it_begins():
    view = flown([-3.2, 0.0, 3.0, 3.5, 0.0, -3.0, -3.5])
    goal, truth = view.goal, view.truth
    assert goal.arrivals == [2.0, 5.0]
    assert goal.leg_index(truth.time).tolist() == [0, 0, 0, 1, 1, 1, 1]
    assert goal.lamp_distance(truth) == pytest.approx([6.7, 3.5, 0.5, 7.0, 3.5, 0.5, 0.0])
    assert np.abs(goal.lamp_direction(truth)[[0, 3]]) == pytest.approx(
        [0.0, math.pi]
    )  # ahead, behind
    found = compute_results(view)
    assert found.success is True
    assert (found.lamps, found.lamps_reached) == (2, 2)
    assert found.end == 5.0
    assert found.path_length == pytest.approx(6.7 + 6.5)
    assert found.straight_length == pytest.approx(6.7 - 1.0 + 7.0 - 2.0)  # circle to circle
    assert 'all 2 lamps of its route' in describe_outcome(found)


def test_homing_reaches_the_last_lamp_when_it_has_stayed_there_for_3_s():
    """It passes the aisle, where it counts at once, and the dock first for 2 s, then for 3 s."""
    way = [-3.2, 0.0, 3.5, 0.0, -3.0, -3.2, -3.5, 0.0, -3.5, -3.4, -3.3, -3.2, -3.1]
    truth = flown(way).truth
    assert FlightGoal(ROUND, truth, 'homing').arrivals == [2.0, 11.0]
    assert FlightGoal(ROUND, truth, 'bag').arrivals == [2.0, 4.0]


def test_who_never_left_reached_nothing():
    view = flown([-3.2, -3.5, -3.0])
    assert view.goal.arrivals == []
    found = compute_results(view)
    assert found.success is False
    assert found.search_time is None
    assert found.closest_horizontal == pytest.approx(6.5)
    assert '0 of the 2 lamps' in describe_outcome(found)
    assert 'no nearer to the next than 6.5 m' in describe_outcome(found)


def test_the_last_lamp_counts_from_its_turn_on():
    found = compute_results(flown([-3.2, 0.0, 3.0, 0.0]))
    assert found.success is False
    assert found.closest_horizontal == pytest.approx(3.5)
    assert '1 of the 2 lamps' in describe_outcome(found)
    assert 'no nearer to the next than 3.5 m' in describe_outcome(found)


def test_of_two_lamps_of_one_frequency_the_next_of_the_route_is_meant():
    """On the way to the aisle the nose points at it; on the way back it is behind."""
    lamps = dict(ROUND.lamps)
    same = lamps['aisle'].frequency
    alike = {name: lamp.model_copy(update={'frequency': same}) for name, lamp in lamps.items()}
    view = flown([-3.2, 0.0, 3.0, 3.5, 0.0], ROUND.model_copy(update={'several': alike}))
    angle = view.goal.beacon_direction(view.truth, np.full(5, same.si))
    assert np.abs(angle[[0, 1, 4]]) == pytest.approx([0.0, 0.0, math.pi])


def test_an_arrival_without_a_search_tells_no_time():
    found = compute_results(flown([-3.2, 0.0, 3.0, 3.5, 0.0, -3.0, -3.5]))
    assert found.search_time is None
    assert describe_outcome(found) == 'The drone reached all 2 lamps of its route over 13.2 m'


def test_one_lamp_alone_is_the_last():
    found = compute_results(flown([-3.0, np.nan, 0.0], ROOM))
    assert found.closest_horizontal == pytest.approx(math.hypot(3.5, 2.0))
    assert found.straight_length == pytest.approx(math.hypot(6.5, 2.0) - 1.0)
    assert describe_outcome(found).endswith('it came no nearer than 4.0 m horizontally')


@pytest.mark.parametrize(
    ('height', 'reached'), [(0.1, True), (1.59, True), (1.61, False), (6.85, False)]
)
def test_a_lamp_is_reached_at_its_height_only(height, reached):
    """Lanterns at 0.1 m with a tolerance of 1.5 m; in the rest, the flight is a full round."""
    found = compute_results(flown([-3.2, 0.0, 3.0, 3.5, 0.0, -3.0, -3.5], height=height))
    assert (found.success, found.lamps_reached) == (reached, 2 if reached else 0)
    assert found.closest_horizontal == pytest.approx(0.0)  # it is horizontal


def test_a_flight_above_the_lamp_says_how_high():
    asked = TimeCurve(np.array([0.0]), np.array([0.5]))
    view = flown([-3.0, 0.0, 3.5], ROOM, 6.85, speed_setpoint=asked)
    view.truth = view.truth._replace(speed=np.full(3, 0.5))
    assert describe_outcome(compute_results(view)).endswith(
        'it came no nearer than 2.0 m horizontally, at a mean height of 6.8 m'
    )


def test_a_flight_in_the_sun_tells_what_its_gas_gained():
    """80 klx and the lamp at 0.017 K m2/W after 140 s, twice the lag: half of 0.413 kg by T."""
    scenario = load_scenario('sunny_field')
    view = flown(np.full(141, -3.5), scenario)
    assert compute_results(view).gas_lift is None  # the vehicle is not known
    view.scene.vehicle = load_vehicle('gtmab').file
    found = compute_results(view)
    irradiance = (92e3 + 15e3 * 0.5 * (1 + math.sin(math.pi / 4))) / 105.0
    assert found.gas_warmth == pytest.approx(0.017 * irradiance * (1.0 - math.exp(-2.0)), rel=0.1)
    assert found.gas_lift == pytest.approx(0.5 * 0.4129 * found.gas_warmth / 293.15, rel=0.01)
    (tile,) = [each for each in build_tiles(found) if each.name == 'Lift by sunlight']
    assert tile.value == f'{1e3 * found.gas_lift:.1f}'


def test_on_a_course_no_lamp_is_sought():
    view = flown([-3.0, 3.5], ROOM.model_copy(update={'course': Course.model_construct()}))
    assert np.isnan(view.goal.lamp_distance(view.truth)).all()
    assert not view.goal.is_reached
    assert compute_results(view).success is None


def test_light_is_judged_by_the_lamp_that_is_listened_for():
    """The aisle (230 Hz) is reached at 2 s, and listened for until 4 s; from then on the dock."""
    time = np.arange(7.0)
    aisle = time < 4.0
    fields = {
        'snr': np.tile([1.0, 9.0], (7, 1)),
        'frequency': np.stack([np.full(7, 370.0), np.where(aisle, 231.0, 149.0)], axis=1),
    }
    view = flown(
        [-3.2, 0.0, 3.0, 3.2, 3.2, 3.2, 3.2],
        peaks=PeakCurves(time, fields),
        sighting=DirectionCurve(
            time, np.where(aisle, 0.0, math.pi)
        ),  # ahead is the aisle, behind the dock
        speed_setpoint=TimeCurve(time, np.full(7, 0.3)),
    )
    assert view.goal.arrivals == [2.0]
    assert compute_results(view).lamp_error == pytest.approx(0.0, abs=1e-9)
