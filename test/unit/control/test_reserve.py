# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The reserve obeyed: what the navigator believes, and landing, returning and perching on it."""

import math

from lta_config.errors import BadInput
from lta_control.guidance import (
    check_reserve,
    decide_permission,
    explain_restriction,
    ReserveReport,
    ReserveResponseSettings,
)
from lta_control.mission import FlightPermission, Mission, mission_step, MissionSettings, Phase
from lta_control.motion import Setpoint
from lta_control.strategies import find_navigation_strategy
from lta_control.strategies.protocol import LightMeasurement, NavigationStrategy, SteeringCommand
import pytest

SECOND = 1_000_000_000
SETTINGS = MissionSettings(speed=0.5)
LAND, RETURN, PERCH = (
    ReserveResponseSettings(action=word) for word in ('land', 'return', 'perch')
)
SIGHT = LightMeasurement(seen=True, bearing=0.0, heading=0.2, amplitudes=(0.0,), interval=0.1)


def arriving(settings, memory, sight):
    """Seek for three turns, then be there."""
    heading, turns = memory
    return SteeringCommand(0.7, 0.5, turns >= 3), (heading, turns + 1)


SEEKER = NavigationStrategy(
    'seeker', lambda heading: (heading, 0), arriving, onward=lambda memory: memory
)


def go(mission, order, reserve, position=(0.0, 0.0), altitude=0.5):
    sight = SIGHT._replace(position=position)
    return mission_step(SETTINGS, SEEKER, mission, sight, altitude, order, 1, reserve.rule)


def airborne(position=(0.0, 0.0)):
    """Return a mission that has taken off somewhere and seeks."""
    return go(Mission(), FlightPermission.FLY, LAND, position)[1]


@pytest.mark.parametrize(
    ('word', 'order', 'why'),
    [
        (None, FlightPermission.DOWN, 'no report from the energy monitor'),
        (ReserveReport(9 * SECOND, False, False), FlightPermission.FLY, ''),
        (ReserveReport(9 * SECOND, True, False, '20% left'), FlightPermission.RESERVE, '20% left'),
        (
            ReserveReport(9 * SECOND, True, False),
            FlightPermission.RESERVE,
            'the energy reserve is reached',
        ),
        (ReserveReport(9 * SECOND, True, True, 'brown-out'), FlightPermission.DOWN, 'brown-out'),
        # 1.0 s is the default: the word of 9 s is good for 10 s, and not for a moment longer.
        (ReserveReport(9 * SECOND - 1, False, False), FlightPermission.DOWN, 'for 1.0 s'),
        (ReserveReport(4 * SECOND, False, False, 'all well'), FlightPermission.DOWN, 'for 6.0 s'),
    ],
)
def test_what_the_energy_allows(word, order, why):
    assert decide_permission(LAND, word, 10 * SECOND) is order
    if order is not FlightPermission.FLY:
        assert why in explain_restriction(LAND, word, 10 * SECOND)


@pytest.mark.parametrize('reserve', [LAND, RETURN, PERCH])
def test_what_is_urgent_lands_it_at_once(reserve):
    assert go(airborne(), FlightPermission.DOWN, reserve)[1].phase is Phase.LAND
    mission = airborne()._replace(phase=Phase.HOME, left=60.0)
    assert go(mission, FlightPermission.DOWN, reserve, (3.0, 0.0))[1].phase is Phase.LAND


def test_it_returns_to_where_it_took_off_and_lands_there():
    mission = airborne((1.0, 1.0))
    assert mission.start == (1.0, 1.0)
    setpoint, mission = go(mission, FlightPermission.RESERVE, RETURN, (4.0, 5.0))
    assert mission.phase is Phase.HOME
    # 5 m at 0.5 m/s take 10 s, and it has twice that, and 20 s to turn.
    assert mission.left == pytest.approx(40.0)
    assert setpoint == Setpoint(SETTINGS.altitude, math.atan2(-4.0, -3.0), 0.5)
    # The reserve may be taken back on the way: it goes home all the same.
    setpoint, mission = go(mission, FlightPermission.FLY, RETURN, (1.0, 3.0))
    assert mission.phase is Phase.HOME
    assert setpoint.heading == pytest.approx(-math.pi / 2)
    setpoint, mission = go(mission, FlightPermission.RESERVE, RETURN, (1.0, 1.49))
    assert mission.phase is Phase.LAND
    assert setpoint.altitude == SETTINGS.landing


def test_a_return_that_does_not_come_nearer_ends_in_a_landing():
    mission, turns = go(airborne(), FlightPermission.RESERVE, RETURN, (5.0, 0.0))[1], 0
    while mission.phase is Phase.HOME:
        mission, turns = go(mission, FlightPermission.RESERVE, RETURN, (5.0, 0.0))[1], turns + 1
    assert mission.phase is Phase.LAND
    assert turns == pytest.approx(400, abs=1)


def test_who_perches_goes_on_to_the_lamp_and_comes_down_there():
    mission, phases = airborne(), []
    for _ in range(5):
        setpoint, mission = go(mission, FlightPermission.RESERVE, PERCH)
        phases.append(mission.phase)
    assert phases == [Phase.SEEK, Phase.SEEK, Phase.ARRIVED, Phase.LAND, Phase.LAND]
    assert setpoint.altitude == SETTINGS.landing


def test_only_who_arrives_can_perch():
    check_reserve(PERCH, find_navigation_strategy('homing'))
    check_reserve(RETURN, find_navigation_strategy('bag'))
    with pytest.raises(BadInput, match='bag never reports an arrival'):
        check_reserve(PERCH, find_navigation_strategy('bag'))


@pytest.mark.parametrize(('away', 'phase'), [(0.5, Phase.LAND), (0.501, Phase.HOME)])
@pytest.mark.parametrize('angle', [0.0, 2.0])
def test_it_lands_within_half_a_metre_of_where_it_took_off(away, phase, angle):
    mission = airborne()._replace(phase=Phase.HOME, left=60.0)
    place = (away * math.cos(angle), away * math.sin(angle))
    assert go(mission, FlightPermission.FLY, RETURN, place)[1].phase is phase


@pytest.mark.parametrize(('left', 'phase'), [(0.1, Phase.LAND), (0.125, Phase.HOME)])
def test_the_flight_back_ends_when_its_time_is_over(left, phase):
    mission = airborne()._replace(phase=Phase.HOME, left=left)
    mission = go(mission, FlightPermission.FLY, RETURN, (3.0, 0.0))[1]
    assert mission.phase is phase
    assert mission.left == pytest.approx(left - 0.1)


def test_with_a_speed_of_zero_it_lands_instead_of_returning():
    still = MissionSettings(speed=0.0)
    sight = SIGHT._replace(position=(3.0, 0.0))
    asked = (airborne(), sight, 0.5, FlightPermission.RESERVE, 1, RETURN)
    assert mission_step(still, SEEKER, *asked)[1].phase is Phase.LAND
