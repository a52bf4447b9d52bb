# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The energy of a world: light, panel, cell and meters."""

import math

from hypothesis import given
from hypothesis import strategies as st
from lta_config.files import list_shipped_names
from lta_config.schema.spectrum_file import luminous_efficacy
from lta_config.topics import load_topic_table
from lta_model.electrical.battery import open_circuit_voltage
from lta_model.electrical.panel import cell_spectral_factor, find_max_power_point, SolarArrayModel
from lta_model.light.readings import build_panel_plane
from lta_model.mass_properties import half_axes
from lta_model.scenario import load_scenario
from lta_model.vehicle import load_vehicle
from lta_sim import supply
from lta_sim.world import World
import numpy as np
import pytest
from scipy.stats import chi2, kstest

from .lamp_room import build, fly, OFF

PANEL = SolarArrayModel.from_cells('anysolar', 2, 1)
TRACKED, CONVERTED, OWN = 0.95, 0.85, 0.022
SPECTRAL = cell_spectral_factor('anysolar', 300.0)  # 1.115, of a white LED
BRIGHT = {'lamp/flux': '0 lm', 'ambient/steady': '100000 lx', 'ambient/mains_amplitude': '0 lx'}


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
    assert world.supply.energy_totals.harvested == 0.0  # too dim for the charger
    resting = open_circuit_voltage(world.charge)
    # (E - 0.15 I) I = P for 5 s of 900 C; the RC pair adds 0.094 ohm of 6 s / 33 s.
    current = (resting - math.sqrt(resting**2 - 4 * 0.15 * power)) / (2 * 0.15)
    assert used == pytest.approx(current * 5.0 / 900.0, rel=3e-3)
    relaxed = resting - 0.094 * -math.expm1(-6.0 / 33.0) * current
    current = (relaxed - math.sqrt(relaxed**2 - 4 * 0.15 * power)) / (2 * 0.15)
    voltage, metered = world.sense().battery
    assert metered == pytest.approx(-current, abs=0.003 * current + 4e-4 + 3e-4)
    assert voltage == pytest.approx(relaxed - 0.15 * current, rel=0.003)


def test_light_on_the_panel_charges():
    bright = build(seed=2, scene=BRIGHT)
    before = bright.charge
    readings = fly(bright, 200)
    lux = readings[10].illuminance
    assert lux == pytest.approx(1e5, rel=1e-9)
    voltage, current = find_max_power_point(PANEL, SPECTRAL * 1e5 / luminous_efficacy('white_led'))
    assert readings[10].panel[0] == pytest.approx(voltage, abs=0.04)
    assert readings[10].panel[1] == pytest.approx(TRACKED * current, abs=0.002)
    net = (TRACKED * voltage * current - OWN) * CONVERTED - 0.12
    gained = net / (open_circuit_voltage(before) + 0.02) * 2.0 / 900.0
    assert bright.charge - before == pytest.approx(gained, rel=0.01)


def test_the_panel_gives_more_of_the_sun_than_of_leds():
    def harvest(efficacy):
        scene = BRIGHT | {'ambient/steady': '50000 lx', 'ambient/efficacy': efficacy}
        world = build(scene=scene)
        world.advance(OFF)
        return world.supply.flow.harvested

    # 50 klx: 476 W/m2 of sunlight or 167 W/m2 of LEDs, worth 186: 2.56; warmth takes 3 %.
    assert harvest('105 lm/W') == pytest.approx(
        TRACKED * math.prod(find_max_power_point(PANEL, 5e4 / 105.0)), rel=1e-9
    )
    assert harvest('105 lm/W') / harvest('300 lm/W') == pytest.approx(2.56, rel=0.03)


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


def test_a_shorted_panel_gives_current_without_voltage():
    world = build(seed=2, scene=BRIGHT | {'faults': {'panel_short': '1 s'}})
    readings = fly(world, 221)
    assert readings[90].panel[0] > 8.0
    assert readings[210].panel[0] == pytest.approx(0.0, abs=0.01)
    # 0.297 A in 1000 W/m2
    shorted = SPECTRAL * 0.297 * 100.0 / luminous_efficacy('white_led')
    assert readings[210].panel[1] == pytest.approx(shorted, rel=0.02)
    assert world.supply.flow.harvested == 0.0


def test_a_brown_out_stops_the_motors():
    scene = {'faults': {'brown_out': '1 s'}}
    world = build(seed=2, scene=scene)
    readings = fly(world, 221, (0.5, 0.5, 0.0, 0.0))
    assert readings[90].battery[0] > 3.7
    assert readings[220].battery[0] == pytest.approx(0.0, abs=0.01)
    assert world.duties.tolist() == [0.0] * 4
    assert not world.supply.flow.fed
    lit = build(seed=2, scene=scene | BRIGHT)
    fly(lit, 221)
    assert lit.supply.flow.fed  # light brings it back


def test_the_panels_place_and_side_decide_its_light():
    hull = half_axes(load_vehicle('gtmab').file.hull)
    top = build_panel_plane(hull, (0.0, 0.0, 0.302), (0.0, 0.0, 1.0))
    assert top.share == pytest.approx(1.0)
    # 1 cm under a hull with a radius of 0.83 m there, it ends 9 deg above the horizon.
    under = build_panel_plane(hull, (0.0, 0.0, -0.31), (0.0, 0.0, 1.0))
    assert under.share == pytest.approx(math.sin(math.radians(9.1)) ** 2, abs=0.004)
    # A ball of radius r hides (r / d)^2 of what a plane sees that faces its middle from d.
    ball = build_panel_plane((0.5, 0.5, 0.5), (0.0, 0.0, -1.0), (0.0, 0.0, 1.0))
    assert ball.share == pytest.approx(1.0 - 0.5**2, abs=0.01)

    def below(normal):
        vehicle = {
            'energy/array/part': 'ballast_box',
            'energy/array/normal': {'value': normal, 'unit': '1', 'source': 'test'},
            'layers/ballast': {
                'ballast_box': {
                    'shape': 'box',
                    'mass': {'value': 0.1, 'unit': 'g', 'source': 'test'},
                    'position': {'value': [0, 0, -0.4], 'unit': 'm', 'source': 'test'},
                    'size': {'value': [0.1, 0.1, 0.1], 'unit': 'm', 'source': 'test'},
                }
            },
        }
        scene = BRIGHT | {
            'lamp/flux': '10000 lm',
            'lamp/position': {'value': [-3.5, 0, 2.5], 'unit': 'm'},
            'lamp/facing': {'value': [0, 0, -1], 'unit': '1'},
            'start/position': {'value': [-3.5, 0.1], 'unit': 'm'},
            'goal/radius': '0.05 m',
            'ambient/steady': '0 lx',
            'room/albedo': 0.0,
        }
        return build(scene=scene, vehicle=vehicle).sense().illuminance

    assert below([0, 0, 1]) == 0.0  # the lamp is right above the hull
    assert below([0, 0, -1]) == 0.0


@pytest.mark.parametrize('name', list_shipped_names('scenarios'))
def test_the_books_balance_in_every_scenario(name):
    scenario = load_scenario(name)
    world = World(load_vehicle('gtmab', scenario.air.density), scenario, load_topic_table(), 1)
    for step in range(300):
        world.advance((0.4, 0.4, 0.002 * step, 0.0))
    books = world.supply.energy_totals
    assert books.consumed > 3 * 0.12
    assert abs(books.imbalance) < 1e-9 * books.consumed


def test_a_relaxing_cell_weakens_the_rotors():
    """The RC pair feeds the sag: half a minute costs more voltage than the charge."""
    sag = {
        'voltage': {'value': 3.7, 'unit': 'V', 'source': 'test'},
        'sensitivity': {'value': 1.0, 'unit': '1', 'source': 'test'},
    }
    world = build(seed=2, vehicle={'effects/battery_sag': sag}, scene={'start/held': '60 s'})
    duties = (0.4, 0.4, 0.0, 0.0)
    for _ in range(100):
        world.advance(duties)
    first, charge = world.supply.flow, world.charge
    thrust = world.thrusts[0]
    for _ in range(3000):
        world.advance(duties)
    last = world.supply.flow
    # 0.094 ohm of the mean current, 60 % of the way after 30 s of 33 s.
    relaxed = 0.094 * 0.5 * (first.current + last.current) * 0.6
    assert last.relaxation == pytest.approx(relaxed, rel=0.05)
    empties = open_circuit_voltage(world.charge) - open_circuit_voltage(charge)
    drop = last.voltage - first.voltage
    assert drop == pytest.approx(empties + last.relaxation - first.relaxation, abs=0.003)
    # T = a u^2 + b u of the duty that the voltage leaves.
    duty = 0.4 * last.voltage / 3.7
    assert world.thrusts[0] == pytest.approx(0.0915 * duty**2 + 0.0677 * duty, rel=1e-3)
    assert world.thrusts[0] < thrust


SETTINGS = supply.PowerMeterSettings()
SILENT = supply.PowerMeterSettings(voltage_noise=0.0, current_noise=0.0)
EXACT = supply.PowerMeterErrors(voltage_gain=1.0, current_gain=1.0, current_offset=0.0)


def read(voltage, current, settings=SILENT, errors=EXACT):
    return supply.measure_voltage_and_current(
        settings, errors, voltage, current, np.random.default_rng(1)
    )


def test_steps_are_the_data_sheets():
    assert read(3.7031, -0.40026) == pytest.approx((3.704, -0.4003), abs=1e-12)
    assert read(3.7019, -0.40024) == pytest.approx((3.700, -0.4002), abs=1e-12)


@pytest.mark.parametrize(('true', 'expected'), [(-4.4, -3.2), (4.4, 3.2), (-3.19, -3.19)])
def test_the_current_is_clipped_at_320_millivolts_over_the_shunt(true, expected):
    assert read(3.7, true)[1] == pytest.approx(expected, abs=1e-12)


def test_a_dead_cell_reads_zero_and_never_less():
    readings = {
        supply.measure_voltage_and_current(SETTINGS, EXACT, 0.0, 0.0, np.random.default_rng(seed))[
            0
        ]
        for seed in range(200)
    }
    assert min(readings) == 0.0
    assert max(readings) > 0.0


def test_gain_and_offset():
    errors = supply.PowerMeterErrors(voltage_gain=1.002, current_gain=0.998, current_offset=4e-4)
    assert read(4.0, -1.0, errors=errors) == pytest.approx((4.008, -0.9976), abs=1e-12)


def test_noise_is_half_a_step_before_rounding():
    rng = np.random.default_rng(2)
    size = 20000
    # Away from a step's middle the rounding is not uniform noise: spread the truth over steps.
    truth = rng.uniform(3.0, 4.2, size), rng.uniform(-1.0, 0.0, size)
    sample = np.array(
        [
            supply.measure_voltage_and_current(SETTINGS, EXACT, v, i, rng)
            for v, i in zip(*truth, strict=True)
        ]
    )
    low, high = chi2.ppf([1e-6, 1 - 1e-6], size - 1) / (size - 1)
    assert 0.95**2 < low < high < 1.05**2
    for error, step in zip((sample - np.array(truth).T).T, (4e-3, 1e-4), strict=True):
        assert low < np.var(error, ddof=1) / (step**2 / 4 + step**2 / 12) < high


def test_errors_are_drawn_uniformly():
    rng = np.random.default_rng(3)
    drawn = [supply.draw_meter_errors(SETTINGS, rng) for _ in range(3000)]
    assert kstest([e.voltage_gain for e in drawn], 'uniform', (0.998, 0.004)).pvalue > 1e-4
    assert kstest([e.current_gain for e in drawn], 'uniform', (0.998, 0.004)).pvalue > 1e-4
    assert kstest([e.current_offset for e in drawn], 'uniform', (-4e-4, 8e-4)).pvalue > 1e-4


@given(st.floats(0.0, 5.0), st.floats(-3.0, 3.0))
def test_a_silent_meter_is_right_to_half_a_step(voltage, current):
    volts, amperes = read(voltage, current)
    assert abs(volts - voltage) <= 2e-3 + 1e-12
    assert abs(amperes - current) <= 5e-5 + 1e-12
