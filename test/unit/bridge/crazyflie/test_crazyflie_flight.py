# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The simulated drone aboard the emulated Crazyflie, in both ways to command it."""

from lta_emulation.crazyflie.commander import BodyCommand, HoverSetpoint
from lta_emulation.emulated_hardware import build_simulated_body
import pytest


def fly(drone, begin, end, wish):
    for turn in range(round(100 * begin) + 1, round(100 * end) + 1):
        drone.advance(0.01 * turn, wish)
    return drone.world.state


def test_the_motors_of_gtmab_turn_its_own_rotors_and_it_senses_that():
    drone = build_simulated_body('gtmab', 'lamp_room', 1)
    assert drone.read_log_values()['acc.z'] == pytest.approx(1.0, abs=0.05)
    height = drone.world.state[2]
    state = fly(drone, 0.0, 3.0, BodyCommand(duties=(0.5, 0.5, 0.0, 0.0)))
    assert drone.duties == (0.5, 0.5, 0.0, 0.0)
    assert state[2] > height + 0.1
    assert drone.read_log_values()['range.zrange'] > 100.0
    assert 98_000 < 100.0 * drone.read_log_values()['baro.pressure'] < 104_000
    assert 3.0 < drone.read_log_values()['pm.vbat'] < 4.3


def test_a_late_look_is_let_go():
    drone = build_simulated_body('gtmab', 'lamp_room', 1)
    drone.advance(10.0, BodyCommand())
    assert drone.world.elapsed == pytest.approx(0.01)
    drone.advance(10.1, BodyCommand())
    assert drone.world.elapsed == pytest.approx(0.1, abs=0.02)


def test_the_multirotor_hovers_by_setpoint_and_lands():
    drone = build_simulated_body('multirotor', 'lamp_room', 1)
    state = fly(drone, 0.0, 5.0, BodyCommand(hover=HoverSetpoint(height=0.8)))
    assert state[2] == pytest.approx(0.8, abs=0.05)
    state = fly(drone, 5.0, 11.0, BodyCommand(land=True))
    assert state[2] < 0.05
    assert drone.duties == (0.0,) * 4
    fly(drone, 11.0, 20.0, BodyCommand())  # and stands
    assert drone.read_log_values()['acc.z'] == pytest.approx(1.0, abs=0.1)


def test_motors_turn_at_idle_and_by_eight_bits_of_duty():
    drone = build_simulated_body('gtmab', 'lamp_room', 1)
    fly(drone, 0.0, 0.1, BodyCommand(duties=(0.5, 0.0, 0.0, 0.0), idle=0.107))
    assert drone.duties == (0.5, 0.107, 0.107, 0.107)
    still, stepped = (
        build_simulated_body('gtmab', 'lamp_room', 1),
        build_simulated_body('gtmab', 'lamp_room', 1),
    )
    fly(still, 0.0, 3.0, BodyCommand(duties=(0.0,) * 4))
    fly(stepped, 0.0, 3.0, BodyCommand(duties=(1.0 / 65535, 0.0, 0.0, 0.0)))
    assert stepped.duties[0] > 0.0
    assert (stepped.world.state == still.world.state).all()
