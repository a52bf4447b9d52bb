# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""A mission along a route: it hands over when the next lamp is heard, and stays when it is not."""

from lta_config.errors import BadInput
from lta_control.guidance import ReserveResponseSettings
from lta_control.mission import (
    FlightPermission,
    Mission,
    mission_step,
    MissionSettings,
    Phase,
    SWITCHING,
)
from lta_control.strategies import check_route, find_navigation_strategy
from lta_control.strategies.protocol import LightMeasurement, NavigationStrategy, SteeringCommand
import pytest

SETTINGS = MissionSettings()
LAND = ReserveResponseSettings().rule
SEEN = LightMeasurement(True, 0.4, 1.0, (0.0,), 0.1, 0.05, 800.0)
BLIND = SEEN._replace(seen=False)


def steer(settings, memory, sight):
    """A strategy that is always at its lamp and counts the lights that it is shown."""
    return SteeringCommand(memory[0], 0.1, True), (
        memory[0],
        memory[1] + (1.0 if sight.seen else 0.0),
    )


THERE = NavigationStrategy(
    'there', lambda h: (h, 0.0), steer, onward=lambda m: (m[0], 100.0 + m[1])
)


def fly(sights, mission=None, lamps=2):
    """Return the missions after each sight."""
    mission = mission or Mission(Phase.SEEK, (0.0, 0.0))
    rows = []
    for sight in sights:
        _, mission = mission_step(
            SETTINGS, THERE, mission, sight, 0.5, FlightPermission.FLY, lamps, LAND
        )
        rows.append(mission)
    return rows


def test_it_listens_for_the_next_lamp_where_it_has_arrived():
    first, *_ = fly([SEEN])
    assert (first.phase, first.leg, first.target) == (Phase.ARRIVED, 0, 1)


def test_it_hands_over_when_the_next_lamp_is_heard_for_a_while():
    rows = fly([SEEN] * 12)
    handed = next(k for k, row in enumerate(rows) if row.leg == 1)
    assert handed == SWITCHING + round(SETTINGS.reception_time / 0.1)
    assert (rows[handed].phase, rows[handed].target) == (Phase.SEEK, 1)
    assert rows[handed].memory == (0.0, 101.0)  # one light of its own lamp, then onward
    assert rows[-1].phase is Phase.ARRIVED  # the last lamp: it stays
    assert rows[-1].leg == rows[-1].target == 1


def test_light_of_another_lamp_is_not_steered_by():
    rows = fly([SEEN] * (SWITCHING + 3))
    assert rows[-1].memory[1] == 1.0


def test_a_gap_in_the_light_begins_the_count_anew():
    heard = round(SETTINGS.reception_time / 0.1)
    rows = fly([SEEN] * (SWITCHING + heard) + [BLIND] + [SEEN] * (heard - 1))
    assert rows[-1].leg == 0
    assert fly([SEEN], rows[-1])[0].leg == 1


def test_it_stays_where_the_next_lamp_is_not_heard_and_asks_again_later():
    patience, again = round(10 * SETTINGS.patience), round(10 * SETTINGS.again)
    rows = fly([SEEN] + [BLIND] * patience)
    last = rows[-1]
    assert (last.phase, last.leg, last.target, last.refused) == (Phase.ARRIVED, 0, 0, True)
    rows = fly([SEEN] * again, last)
    assert [row.target for row in rows] == [0] * (again - 1) + [1]
    assert rows[SWITCHING - 1].memory[1] == last.memory[1]  # still the other lamp's light
    assert rows[-1].memory[1] > last.memory[1]
    assert fly([SEEN] * 10, rows[-1])[-1].leg == 1
    assert not fly([SEEN] * 10, rows[-1])[-1].refused


def test_a_single_lamp_is_never_left():
    rows = fly([SEEN] * 50, lamps=1)
    assert {(row.leg, row.target, row.phase) for row in rows} == {(0, 0, Phase.ARRIVED)}


def test_who_never_arrives_is_refused_on_a_route():
    check_route(find_navigation_strategy('homing'), 3)
    check_route(find_navigation_strategy('bag'), 1)
    with pytest.raises(BadInput) as caught:
        check_route(find_navigation_strategy('bag'), 3)
    assert str(caught.value) == (
        'The strategy bag never reports an arrival at a lamp, so it cannot fly a route of 3 '
        'lamps; choose the strategy homing.'
    )
