# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Where light and load break even: by the law of lux, and against the array itself."""

import math

from lta_config.schema.spectrum_file import luminous_efficacy
from lta_config.schema.vehicle_file import load_vehicle_file
from lta_energy.harvest import (
    break_even_illuminance,
    charging_power,
    HarvestCurve,
    irradiance_from_lux,
    LAMPS,
    LightSource,
)
from lta_model.electrical.mppt_charger import ChargerModel
from lta_model.electrical.panel import cell_spectral_factor, find_max_power_point, SolarArrayModel
import pytest

ENERGY = load_vehicle_file('gtmab').energy
CHARGER, HARVEST = (
    ChargerModel.from_energy(ENERGY),
    HarvestCurve.of_energy(ENERGY),
)


def lux(lamp, load):
    return break_even_illuminance(HARVEST, CHARGER, LAMPS[lamp], load)


def test_the_charger_gives_the_load_there_and_less_below():
    for name, lamp in LAMPS.items():
        found = lux(name, 0.097)
        assert charging_power(HARVEST, CHARGER, lamp, found) == pytest.approx(0.097, rel=1e-9)
        assert charging_power(HARVEST, CHARGER, lamp, 0.99 * found) < 0.097


def test_the_same_lux_of_the_sun_go_further_by_their_efficacy():
    # The cells make 1.115 times as much of a watt of the LED
    led, sun = luminous_efficacy('white_led'), luminous_efficacy('sun')
    factor = cell_spectral_factor('anysolar', led)
    assert lux('white LED', 0.12) / lux('sun', 0.12) == pytest.approx(led / sun / factor, rel=1e-6)
    assert 1.9 < lux('flickering LED', 0.12) / lux('white LED', 0.12) < 2.0


def test_idling_by_hand():
    """97 mW behind 85 %, and 22 mW, behind 95 %: 143.3 mW of the array."""
    needed = (0.097 / 0.85 + 0.022) / 0.95
    voltage, current = find_max_power_point(
        SolarArrayModel.from_energy(ENERGY), lux('sun', 0.097) / luminous_efficacy('sun')
    )
    assert voltage * current == pytest.approx(needed, rel=5e-4)


def test_what_no_light_feeds_never_breaks_even():
    assert lux('white LED', 1.333) == math.inf


def test_lamps_have_the_efficacy_of_their_spectrum_and_by_hand_their_light():
    """Lux become watts by the same spectrum that gives the current of the cells."""
    led = luminous_efficacy('white_led')
    assert [lamp.efficacy for lamp in LAMPS.values()] == [led, led, luminous_efficacy('sun')]
    assert irradiance_from_lux(LAMPS['white LED'], 2.0 * led) == (0.0, 2.0, 0.0, 1.0)
    assert irradiance_from_lux(LAMPS['flickering LED'], 2.0 * led) == (0.0, 0.0, 2.0, 0.5)
    # Another LED of 10 % fewer lumens by watt has more watts by lux
    other = LightSource('white_led', efficacy_ratio=0.9)
    assert irradiance_from_lux(other, 1.8 * led).lamps == pytest.approx(2.0)


def test_up_to_a_hundred_thousand_lux_are_looked_at():
    most = charging_power(HARVEST, CHARGER, LAMPS['sun'], 100e3)
    assert lux('sun', most) == pytest.approx(100e3)
    assert lux('sun', math.nextafter(most, 9.0)) == math.inf
