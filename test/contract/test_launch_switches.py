"""Each node can be left out for somebody's own, and the simulator waits for the rest."""

from lta_graph.launches import FLY
import pytest

AWAITED = ['estimator', 'controller', 'demodulator', 'navigator', 'energy_monitor']


def flown(**given):
    """Return the parameters of each process by its name."""
    return {process.name: process.parameters for process in FLY.build_plan(given).processes}


def test_in_real_time_the_simulator_waits_for_what_is_started():
    assert flown()['simulator']['wait_for'].split() == [*AWAITED, 'description']


@pytest.mark.parametrize('name', AWAITED)
def test_what_is_left_out_is_not_waited_for(name):
    plan = flown(**{name: 'false'})
    assert set(flown()) - set(plan) == {name}
    rest = [each for each in AWAITED if each != name]
    assert plan['simulator']['wait_for'].split() == [*rest, 'description']


@pytest.mark.parametrize('name', AWAITED)
def test_in_lockstep_somebody_must_take_its_place(name):
    plan = flown(**{name: 'false', 'time': 'lockstep'})
    assert name not in plan
    assert plan['simulator']['wait_for'] == 'default description'


def test_a_description_that_is_left_out_is_not_waited_for():
    plan = flown(description='false', time='lockstep')
    assert 'description' not in plan
    assert plan['simulator']['wait_for'] == 'default'


def test_the_simulator_can_be_left_out_and_the_rest_stays():
    plan = flown(simulator='false')
    assert set(flown()) - set(plan) == {'simulator'}
    assert set(plan) - {'recorder', 'description'} == set(AWAITED)


@pytest.mark.parametrize('commanded', ['true', 'false'])
def test_a_commanded_flight_brakes_at_its_lamp(commanded):
    assert flown(commanded=commanded)['navigator']['homing.brake'] is (commanded == 'true')
