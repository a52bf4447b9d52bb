"""The world's electricity: what loads draw from the cell, and what light brings."""

import math

from lta_energy.battery import open_circuit_voltage
import pytest

from .lamp_room import build, fly, OFF

RATED = 2 * 4.46 * 0.28 / 1000.0  # W of two ANYSOLAR panels per W/m2


def consumed(duty, steps):
    world = build(seed=2, scene={'ambient/steady': '0 lx', 'ambient/mains_amplitude': '0 lx'})
    fly(world, 100, (duty,) * 4)  # the motors have reached their duty: 14 time constants
    before = world.charge
    fly(world, steps, (duty,) * 4)
    return world, before - world.charge


@pytest.mark.parametrize('duty', [0.0, 0.5])
def test_the_battery_drains_by_what_the_loads_draw(duty):
    world, used = consumed(duty, 500)
    # By hand: 97 + 23 mW, and of each turning rotor 27 mW + 23.96 W/N of 0.0915 u^2 + 0.0677 u.
    thrust = 0.0915 * duty**2 + 0.0677 * duty
    power = 0.120 + 4 * (0.027 + 23.96 * thrust) * (duty > 0)
    harvest = RATED * world.sense().illuminance / 300.0
    assert harvest < 0.01 * power
    resting = open_circuit_voltage(world.charge)
    # (E - 0.15 I) I = P for 5 s of 900 C.
    current = (resting - math.sqrt(resting**2 - 4 * 0.15 * (power - harvest))) / (2 * 0.15)
    assert used == pytest.approx(current * 5.0 / 900.0, rel=2e-3)
    voltage, metered = world.sense().battery
    assert metered == pytest.approx(-current, abs=0.002 * current + 4e-4 + 3e-4)
    assert voltage == pytest.approx(resting - 0.15 * current, rel=0.004)


def test_light_on_the_panel_charges():
    bright = build(seed=2, scene={'ambient/steady': '100000 lx'})
    before = bright.charge
    readings = fly(bright, 200)
    # 100 klx / 300 lm/W * 2.4976 W / 1000 W/m2 = 0.83 W, less 0.12 W drawn.
    lux = readings[10].illuminance
    assert lux == pytest.approx(1e5, rel=0.05)
    harvest = lux / 300.0 * RATED
    assert readings[10].panel[1] == pytest.approx(harvest / 8.92, abs=0.002)
    assert readings[10].panel[0] == pytest.approx(8.92, abs=0.04)
    gained = (harvest - 0.12) / (open_circuit_voltage(before) + 0.03) * 2.0 / 900.0
    assert bright.charge - before == pytest.approx(gained, rel=0.02)


def test_the_panel_gives_more_of_the_sun_than_of_leds():
    def harvest(efficacy):
        scene = {
            'lamp/flux': '0 lm',
            'ambient/steady': '50000 lx',
            'ambient/efficacy': efficacy,
        }
        world = build(scene=scene)
        world.advance(OFF)
        return world.supply.harvested

    # 50 klx / 105 lm/W * 2.4976 W / 1000 W/m2.
    assert harvest('105 lm/W') == pytest.approx(1.18933, rel=1e-5)
    assert harvest('105 lm/W') / harvest('300 lm/W') == pytest.approx(300 / 105, rel=1e-12)


def test_the_panel_looks_up():
    """Lambertian lamp, half of the time on, 0.2 m aside: 0.5 flux / pi cos^2 / distance^2."""
    scene = {
        'lamp/position': {'value': [-3.5, 0, 2.5], 'unit': 'm'},
        'lamp/facing': {'value': [0, 0, -1], 'unit': '1'},
        'ambient/steady': '0 lx',
        'ambient/mains_amplitude': '0 lx',
        'room/albedo': 0.0,
        'goal/radius': '0.1 m',
        'start/position': {'value': [-3.5, 0.2], 'unit': 'm'},
    }
    below = 2.5 - (0.41902 + 0.302)
    expected = 0.5 * 10000.0 / math.pi * below**2 / (below**2 + 0.2**2) ** 2
    assert build(scene=scene).sense().illuminance == pytest.approx(expected, rel=1e-4)
    scene |= {
        'lamp/position': {'value': [-3.5, 0, 0.1], 'unit': 'm'},
        'lamp/facing': {'value': [0, 0, 1], 'unit': '1'},
    }
    assert build(scene=scene).sense().illuminance == 0.0
