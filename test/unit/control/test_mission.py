"""The mission: rest, climb, seek, land; forward only."""

import itertools

from lta_control.cascade import Setpoint
from lta_control.mission import Mission, mission_step, MissionSettings, Phase
from lta_control.strategies import strategy
from lta_control.strategies.protocol import Sight
import pytest

SETTINGS = MissionSettings()
BAG = strategy('bag')
SEEN = Sight(seen=True, bearing=0.4, heading=1.0, amplitudes=(0.0,) * 8, interval=0.1)
BLIND = SEEN._replace(seen=False, bearing=0.0)


def go(mission=Mission(), sight=SEEN, altitude=0.42, reserve=False):  # noqa: B008 - immutable
    return mission_step(SETTINGS, BAG, mission, sight, altitude, reserve)


def test_at_rest_it_asks_for_nothing():
    setpoint, mission = go(altitude=None)
    assert setpoint == Setpoint(0.0, 1.0, 0.0)
    assert mission == Mission(Phase.REST, ())
    assert go(altitude=None, reserve=True)[1] == mission


def test_it_climbs_on_the_heading_it_stood_on():
    setpoint, mission = go()
    assert setpoint == Setpoint(0.5, 1.0, 0.0)
    assert mission == Mission(Phase.CLIMB, (1.0,))
    setpoint, mission = go(mission, SEEN._replace(heading=1.3))
    assert setpoint == Setpoint(0.5, 1.0, 0.0)


@pytest.mark.parametrize(('altitude', 'phase'), [(0.459, Phase.CLIMB), (0.461, Phase.SEEK)])
def test_the_climb_ends_near_the_altitude(altitude, phase):
    assert go(Mission(Phase.CLIMB, (1.0,)), altitude=altitude)[1].phase is phase


def test_it_seeks_where_the_strategy_says():
    setpoint, mission = go(Mission(Phase.SEEK, (1.0,)), altitude=0.5)
    assert setpoint == Setpoint(0.5, pytest.approx(1.4), 0.5)
    assert mission == Mission(Phase.SEEK, (pytest.approx(1.4),))


def test_sinking_does_not_start_another_climb():
    assert go(Mission(Phase.SEEK, (1.0,)), altitude=0.1)[1].phase is Phase.SEEK


@pytest.mark.parametrize('phase', [Phase.REST, Phase.CLIMB, Phase.SEEK, Phase.LAND])
@pytest.mark.parametrize('altitude', [0.42, 0.5])
def test_the_reserve_lands_it(phase, altitude):
    memory = () if phase is Phase.REST else (0.7,)
    setpoint, mission = go(Mission(phase, memory), altitude=altitude, reserve=True)
    assert mission.phase is Phase.LAND
    assert setpoint == Setpoint(0.3, 1.0 if phase is Phase.REST else 0.7, 0.0)


def test_it_goes_on_landing_when_the_reserve_recovers():
    setpoint, mission = go(Mission(Phase.LAND, (0.7,)), altitude=0.5)
    assert setpoint == Setpoint(0.3, 0.7, 0.0)
    assert mission.phase is Phase.LAND


def test_landing_asks_for_less_than_where_the_gear_stands():
    assert SETTINGS.landing < 0.42


def test_phases_only_go_forward():
    order = list(Phase)
    assert order == ['rest', 'climb', 'seek', 'arrived', 'land']
    inputs = list(itertools.product((SEEN, BLIND), (None, 0.1, 0.42, 0.47, 3.0), (False, True)))
    for phase, (sight, altitude, reserve) in itertools.product(order, inputs):
        memory = () if phase is Phase.REST else (0.7,)
        _, after = go(Mission(phase, memory), sight, altitude, reserve)
        assert order.index(after.phase) >= order.index(phase)
