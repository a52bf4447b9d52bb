# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The closed loop with a small cell whose reserve is reached on the way to the lamp."""

from dataclasses import replace
import math

from lta_control.mission import Phase
from lta_flight.flight_spec import build_loop, load_spec
import pytest

SMALL = {
    'vehicle.energy.battery.capacity': '12 mA h',  # a hundredth of it is gone in a second
    'scenario.start.charge': '90 %',
    'scenario.goal.radius': '0.05 m',
    'energy_monitor.reserve': 0.7,
}


def fly(made_of, seconds):
    """Return a flight, its phases, all faults, and how far it was at the last phase [m]."""
    loop, phases, named, there = build_loop(made_of, 3), [], set(), 0.0
    for _ in loop.iterate_steps():
        if loop.mission.phase not in phases:
            phases.append(loop.mission.phase)
            there = away(loop)
        if loop.energy is not None:
            named |= {fault.name for fault in loop.energy.estimate.watch.faults}
        if loop.world.elapsed > seconds:
            break
    return loop, phases, named, there


def small(**values):
    """Return the flight of a small cell with other parameters."""
    changes = {key.replace('__', '.'): value for key, value in values.items()}
    return load_spec('gtmab', 'lamp_room', 'bag', '').with_values(SMALL | changes)


def failing(scenario, **faults):
    """Return a flight in a scene in which the supply fails."""
    made_of = load_spec('gtmab', scenario, 'bag', '')
    scene = {**made_of.contents['scenario'], 'faults': faults}
    return replace(made_of, contents={**made_of.contents, 'scenario': scene})


def away(loop):
    """Return the true distance from where it started [m]."""
    x, y = loop.world.scenario.start.position.vector
    return math.hypot(loop.world.state[0] - x, loop.world.state[1] - y)


def test_it_lands_where_the_reserve_is_reached():
    loop, phases, _, there = fly(small(), 30.0)
    assert phases == [Phase.REST, Phase.CLIMB, Phase.SEEK, Phase.LAND]
    assert 2.0 < there < 5.0
    assert loop.world.state[2] == pytest.approx(loop.world.vehicle.hull_height_on_floor, abs=0.01)


def test_it_returns_to_its_start_and_lands_there():
    _, phases, _, there = fly(small(reserve__action='return'), 60.0)
    assert phases == [Phase.REST, Phase.CLIMB, Phase.SEEK, Phase.HOME, Phase.LAND]
    assert there < 1.0


def test_it_does_not_take_off_with_too_little():
    loop, phases, _, _ = fly(small(scenario__start__charge='60 %'), 8.0)
    assert phases == [Phase.REST]
    assert loop.energy.estimate.reserve
    assert loop.duties == (0.0,) * 4


def test_it_comes_down_when_its_supply_fails():
    """The meter sits behind what cuts off the loads, and reads nothing."""
    _, phases, named, _ = fly(failing('lamp_room', brown_out='8 s'), 10.0)
    assert phases == [Phase.REST, Phase.CLIMB, Phase.SEEK, Phase.LAND]
    assert named == {'dropout'}


def test_a_shorted_panel_is_named_and_ends_no_flight():
    _, phases, named, _ = fly(failing('sunny_field', panel_short='8 s'), 10.0)
    assert phases == [Phase.REST, Phase.CLIMB, Phase.SEEK]
    assert named == {'panel short'}
