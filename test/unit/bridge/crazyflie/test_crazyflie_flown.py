"""The simulated drone aboard the emulated Crazyflie, in both ways to command it."""

from lta_emulation.crazyflie.commander import Hover, Wish
from lta_emulation.emulated_hardware import flown
import pytest


def fly(drone, begin, end, wish):
    for turn in range(round(100 * begin) + 1, round(100 * end) + 1):
        drone.fly(0.01 * turn, wish)
    return drone.world.state


def test_the_motors_of_gtmab_turn_its_own_rotors_and_it_senses_that():
    drone = flown('gtmab', 'lamp_room', 1)
    assert drone.read()['acc.z'] == pytest.approx(1.0, abs=0.05)
    height = drone.world.state[2]
    state = fly(drone, 0.0, 3.0, Wish(duties=(0.5, 0.5, 0.0, 0.0)))
    assert drone.duties == (0.5, 0.5, 0.0, 0.0)
    assert state[2] > height + 0.1
    assert drone.read()['range.zrange'] > 100.0
    assert 98_000 < 100.0 * drone.read()['baro.pressure'] < 104_000
    assert 3.0 < drone.read()['pm.vbat'] < 4.3


def test_a_late_look_is_let_go():
    drone = flown('gtmab', 'lamp_room', 1)
    drone.fly(10.0, Wish())
    assert drone.world.elapsed == pytest.approx(0.01)
    drone.fly(10.1, Wish())
    assert drone.world.elapsed == pytest.approx(0.1, abs=0.02)


def test_the_multirotor_hovers_by_setpoint_and_lands():
    drone = flown('multirotor', 'lamp_room', 1)
    state = fly(drone, 0.0, 5.0, Wish(hover=Hover(height=0.8)))
    assert state[2] == pytest.approx(0.8, abs=0.05)
    state = fly(drone, 5.0, 11.0, Wish(land=True))
    assert state[2] < 0.05
    assert drone.duties == (0.0,) * 4
    fly(drone, 11.0, 20.0, Wish())  # and stands
    assert drone.read()['acc.z'] == pytest.approx(1.0, abs=0.1)


def test_motors_turn_at_idle_and_by_eight_bits_of_duty():
    drone = flown('gtmab', 'lamp_room', 1)
    fly(drone, 0.0, 0.1, Wish(duties=(0.5, 0.0, 0.0, 0.0), idle=0.107))
    assert drone.duties == (0.5, 0.107, 0.107, 0.107)
    still, stepped = flown('gtmab', 'lamp_room', 1), flown('gtmab', 'lamp_room', 1)
    fly(still, 0.0, 3.0, Wish(duties=(0.0,) * 4))
    fly(stepped, 0.0, 3.0, Wish(duties=(1.0 / 65535, 0.0, 0.0, 0.0)))
    assert stepped.duties[0] > 0.0
    assert (stepped.world.state == still.world.state).all()
