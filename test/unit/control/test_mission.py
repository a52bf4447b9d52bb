# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The mission: rest, climb, seek, land; forward only."""

import itertools
import math

from lta_config.course import Course
from lta_control.guidance import ReserveResponseSettings
from lta_control.mission import (
    course_step,
    FlightPermission,
    Mission,
    mission_step,
    MissionSettings,
    Phase,
)
from lta_control.motion import Setpoint
from lta_control.strategies import find_navigation_strategy
from lta_control.strategies.protocol import LightMeasurement
import pytest

SETTINGS = MissionSettings()
LAND = ReserveResponseSettings().rule
BAG = find_navigation_strategy('bag')
SEEN = LightMeasurement(seen=True, bearing=0.4, heading=1.0, amplitudes=(0.0,) * 8, interval=0.1)
BLIND = SEEN._replace(seen=False, bearing=0.0)


def go(mission=Mission(), sight=SEEN, altitude=0.42, order=FlightPermission.FLY):  # noqa: B008 - immutable
    return mission_step(SETTINGS, BAG, mission, sight, altitude, order, 1, LAND)


def test_it_seeks_where_the_strategy_says():
    setpoint, mission = go(Mission(Phase.SEEK, (1.0,), heading=1.0), altitude=0.5)
    assert setpoint == Setpoint(0.5, pytest.approx(1.4), 0.5)
    assert mission == Mission(Phase.SEEK, (pytest.approx(1.4),), heading=pytest.approx(1.4))


@pytest.mark.parametrize('order', [FlightPermission.RESERVE, FlightPermission.DOWN])
@pytest.mark.parametrize('phase', [Phase.CLIMB, Phase.SEEK, Phase.LAND])
@pytest.mark.parametrize('altitude', [0.42, 0.5])
def test_the_reserve_lands_it(phase, altitude, order):
    setpoint, mission = go(Mission(phase, (0.7,), heading=0.7), altitude=altitude, order=order)
    assert mission.phase is Phase.LAND
    assert setpoint == Setpoint(0.3, 0.7, 0.0)


@pytest.mark.parametrize('order', [FlightPermission.RESERVE, FlightPermission.DOWN])
def test_it_does_not_take_off_on_the_reserve_and_does_when_it_is_taken_back(order):
    setpoint, mission = go(order=order)
    assert (setpoint, mission) == (Setpoint(0.0, 1.0, 0.0), Mission())
    assert go(mission)[1].phase is Phase.CLIMB


def test_phases_only_go_forward():
    names = ['rest', 'climb', 'seek', 'arrived', 'home', 'land', 'hold']
    assert list(map(str, Phase)) == names
    phases = [phase for phase in Phase if phase is not Phase.HOLD]  # only between commands
    inputs = list(
        itertools.product((SEEN, BLIND), (math.nan, 0.1, 0.42, 0.47, 3.0), tuple(FlightPermission))
    )
    for phase, (sight, altitude, order) in itertools.product(phases, inputs):
        memory = () if phase is Phase.REST else (0.7,)
        _, after = go(Mission(phase, memory), sight, altitude, order)
        assert phases.index(after.phase) >= phases.index(phase)


def test_a_course_is_flown_by_its_rows_until_the_energy_reserve():
    row = {'at': '2 s', 'altitude': '1 m', 'heading': '0.5 rad', 'speed': '0.4 m/s'}
    course = Course.model_validate({'between': 'step', 'rows': [row]})
    assert course_step(course, 2.0, 0.3, 0.42, FlightPermission.FLY) == Setpoint(1.0, 0.5, 0.4)
    assert course_step(course, 1.0, 0.3, 0.42, FlightPermission.FLY) == Setpoint(0.0, 0.5, 0.0)
    assert course_step(course, 2.0, 0.3, math.nan, FlightPermission.FLY) == Setpoint(0.0, 0.3, 0.0)
    for order in (FlightPermission.RESERVE, FlightPermission.DOWN):
        assert course_step(course, 2.0, 0.3, 0.42, order) == Setpoint(0.0, 0.5, 0.0)


def test_at_rest_it_asks_for_nothing():
    setpoint, mission = go(altitude=math.nan)
    assert setpoint == Setpoint(0.0, 1.0, 0.0)
    assert mission == Mission(Phase.REST, ())
    assert go(altitude=math.nan, order=FlightPermission.RESERVE)[1] == mission
