# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Legs of a mission: gone on with they are one flight, and they cost what the full loop costs."""

from leg_validation import compare_leg_with_loop
from lta_config.schema.mission_file import load_mission
from lta_energy.irradiance import NO_IRRADIANCE
from lta_model.electrical.mppt_charger import resting_flow, total_stored_energy
from lta_model.light.reflected_light import LAMP_ROWS, scratch_size
from lta_sim import light_link as heard
from lta_studies.mission.leg_state import (
    DONE,
    DWELL,
    EMPTY,
    FLYING,
    GO,
    LAND,
    LegPlan,
    RESERVE,
)
from lta_studies.mission.legs import LegPilot
from lta_studies.mission.scene import lamp_brightness, MissionScene
import numpy as np
import pytest

pytestmark = pytest.mark.long  # a minute, most of it to compile a pilot

LEG = LegPlan(GO, 120.0, 0.1, 0.0, 1.0, 0.0)


@pytest.fixture(scope='module')
def scenes():
    return MissionScene(load_mission('warehouse'))


@pytest.fixture(scope='module')
def made(scenes):
    return scenes.build_beacon_flight('aisle', NO_IRRADIANCE, 1.0)


@pytest.fixture(scope='module')
def pilot(made):
    return LegPilot(made, LEG)


def begun(pilot, scenes, charge=0.8):
    place = (-3.2, -2.0, scenes.vehicle.hull_height_on_floor)
    return pilot.ground_state(place, 0.4, resting_flow(charge), charge, 3)


def go_on(pilot, made, leg, memory):
    memory = memory._replace(outcome=FLYING, first_step=memory.flight.step)
    return pilot.fly_leg(pilot.pack_constants(made), leg, memory, 3)


def test_a_dwell_in_two_pieces_is_one_dwell(pilot, made, scenes):
    """But for the echo of the room, which each leg gathers when it begins."""
    arrived = go_on(pilot, made, LEG, begun(pilot, scenes))
    assert arrived.outcome == DONE
    whole = go_on(pilot, made, LEG._replace(kind=DWELL, limit=8.0), arrived).flight
    memory = arrived
    for part in (3.0, 5.0):
        memory = go_on(pilot, made, LEG._replace(kind=DWELL, limit=part), memory)
    np.testing.assert_allclose(whole.state, memory.flight.state, atol=1e-3)
    assert memory.flight.step == whole.step
    assert memory.flight.supply.consumed == pytest.approx(whole.supply.consumed, rel=1e-4)


def test_a_track_has_a_pose_each_half_second(pilot, made, scenes):
    track = np.full((12, 8), np.nan)
    first, leg = begun(pilot, scenes), LEG._replace(limit=8.0)
    after = pilot.fly_leg(pilot.pack_constants(made), leg, first, 3, track)
    assert track[1:, 0] == pytest.approx(np.arange(0.5, 5.6, 0.5))
    assert np.linalg.norm(track[1:, 4:], axis=1) == pytest.approx(1.0, abs=1e-6)
    # It climbs from where it stood, and flies as without a track
    assert track[1, 1:3] == pytest.approx(first.flight.state[:2], abs=0.05)
    assert track[-1, 3] > first.flight.state[2] + 0.1
    assert pilot.fly_leg(pilot.pack_constants(made), leg, first, 3) == after


def test_a_leg_ends_by_its_reserve_and_by_an_empty_cell(pilot, made, scenes):
    memory = go_on(pilot, made, LEG._replace(reserve=0.795), begun(pilot, scenes))
    assert memory.outcome == RESERVE
    assert 0.79 < memory.charge <= 0.795
    memory = go_on(pilot, made, LEG._replace(reserve=0.0), begun(pilot, scenes, 0.004))
    assert memory.outcome == EMPTY
    assert memory.lowest < 3.4


def test_it_lands_where_it_is_told_to(pilot, made, scenes):
    memory = go_on(pilot, made, LEG, begun(pilot, scenes))
    memory = go_on(pilot, made, LEG._replace(kind=LAND, limit=60.0), memory)
    assert memory.outcome == DONE
    assert memory.flight.state[2] == pytest.approx(scenes.vehicle.hull_height_on_floor, abs=0.02)


def test_the_books_of_a_flight_balance(pilot, made, scenes):
    cell = scenes.vehicle.battery
    memory = begun(pilot, scenes)
    before = total_stored_energy(cell, memory.flight.supply.flow)
    books = go_on(pilot, made, LEG._replace(payload=0.05), memory).flight.supply
    now = books.flow
    rest = (
        books.harvested - books.consumed - books.lost - (total_stored_energy(cell, now) - before)
    )
    assert abs(rest) < 1e-6 * books.consumed


def test_a_payload_draws_what_it_draws_while_it_dwells(pilot, made, scenes):
    arrived = go_on(pilot, made, LEG, begun(pilot, scenes))
    spent = []
    for watts in (0.0, 0.073):
        leg = LEG._replace(kind=DWELL, limit=10.0, payload=watts)
        memory = go_on(pilot, made, leg, arrived)
        spent.append(memory.flight.supply.consumed - arrived.flight.supply.consumed)
    assert spent[1] - spent[0] == pytest.approx(0.73, rel=0.05)


def test_a_payload_is_carried_and_not_trimmed_away(scenes):
    mission = load_mission('greenhouse_inspection')
    bare = MissionScene(mission.model_copy(update={'payload': None}))
    full = MissionScene(mission)
    assert 'inspection' in full.vehicle.file.layers
    assert full.vehicle.mass == pytest.approx(bare.vehicle.mass, rel=1e-3)  # ballast gave way


def test_the_brightness_that_homing_is_told_is_that_of_its_own_settings(scenes):
    """In the shipped room homing's default of 2100 counts is that of its lamp at 0.8 off axis."""
    mission = load_mission('warehouse')
    # 2 kohm; the vehicle has 100 kohm
    small = mission.model_copy(update={'feedback': load_mission('greenhouse').feedback})
    own, other = (
        each.build_beacon_flight('aisle', NO_IRRADIANCE, 1.0).craft
        for each in (scenes, MissionScene(small))
    )
    lamp = scenes.lamp('aisle')
    assert own.mission.homing.brightness == pytest.approx(lamp_brightness(own.listening, lamp))
    ratio = own.listening.signals[0].counts / other.listening.signals[0].counts
    assert ratio == pytest.approx(100.0 / 2.0)
    assert other.mission.homing.brightness == pytest.approx(own.mission.homing.brightness / ratio)


def test_flights_cost_what_the_full_loop_says(scenes):
    rows = [
        (np.median(leg[:, 0]), np.median(loop[:, 0]))
        for _, leg, loop in compare_leg_with_loop(scenes, 'aisle', 3, 5)
    ]
    ours, full = np.array(rows).T
    assert ours.sum() == pytest.approx(full.sum(), rel=0.02)
    np.testing.assert_allclose(ours, full, rtol=0.03)


def test_what_a_room_throws_back_of_a_lantern_is_a_number(scenes, made):
    """Its light falls off slower than by the cosine: half power at 85 degrees."""
    listening = made.craft.listening
    out, scratch = np.zeros((LAMP_ROWS + 1, 8)), np.zeros(scratch_size(1))
    heard.write_ring_light(listening, (0.0, -2.0, 1.3), (0.0, 0.0, 0.0, 1.0), out, scratch)
    assert scenes.lamp('aisle').order < 0.3
    assert np.isfinite(out).all()
    assert out[LAMP_ROWS].max() == pytest.approx(out[LAMP_ROWS, 0])  # the diode that faces it
    assert 30.0 < out[LAMP_ROWS, 0] < 300.0
