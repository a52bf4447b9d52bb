"""Where light and load break even: by the law of lux, and against the array itself."""

import math

from lta_config.schema.vehicle_file import load_vehicle_file
from lta_energy.harvest import (
    break_even_illuminance,
    charging_power,
    HarvestCurve,
    irradiance_from_lux,
    LAMPS,
    LightSource,
)
from lta_energy.irradiance import PanelIrradiance
from lta_model.electrical.charger import ChargerModel
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
    factor = cell_spectral_factor('anysolar', 300.0)
    assert lux('white LED', 0.12) / lux('sun', 0.12) == pytest.approx(
        300.0 / 110.0 / factor, rel=1e-6
    )
    assert 1.9 < lux('flickering LED', 0.12) / lux('white LED', 0.12) < 2.0


def test_idling_by_hand():
    """97 mW behind 85 %, and 22 mW, behind 95 %: 143.3 mW of the array."""
    needed = (0.097 / 0.85 + 0.022) / 0.95
    voltage, current = find_max_power_point(
        SolarArrayModel.from_energy(ENERGY), lux('sun', 0.097) / 110.0
    )
    assert voltage * current == pytest.approx(needed, rel=5e-4)


def test_what_no_light_feeds_never_breaks_even():
    assert lux('white LED', 1.333) == math.inf


def test_the_lamps_and_their_light_by_hand():
    assert {
        'white LED': LightSource(300.0, 1.0),
        'flickering LED': LightSource(300.0, 0.5),
        'sun': LightSource(110.0, 1.0, sun=True),
    } == LAMPS
    assert irradiance_from_lux(LightSource(300.0, 1.0), 600.0) == PanelIrradiance(
        0.0, 2.0, 0.0, 1.0
    )
    assert irradiance_from_lux(LightSource(300.0, 0.5), 600.0) == PanelIrradiance(
        0.0, 0.0, 2.0, 0.5
    )


def test_up_to_a_hundred_thousand_lux_are_looked_at():
    most = charging_power(HARVEST, CHARGER, LAMPS['sun'], 100e3)
    assert lux('sun', most) == pytest.approx(100e3)
    assert lux('sun', math.nextafter(most, 9.0)) == math.inf
