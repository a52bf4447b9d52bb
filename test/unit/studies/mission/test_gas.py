"""Gas over a day: the lift that light and air change, against a hand calculation."""

from lta_energy.irradiance import IrradianceSeries
from lta_model.vehicle import load_vehicle
from lta_studies.mission.gas import describe_gas, describe_too_light, estimate_gas_over_day
import numpy as np
import pytest


def day(sun, lamps=0.0):
    flat = np.full(1440, lamps)
    light = np.linspace(0.0, sun, 1440)
    return IrradianceSeries(light, flat, 0.0 * flat, 0.5, light, 1.0, (105.0, 300.0, 300.0))


def test_lift_follows_from_the_strongest_light():
    gas = estimate_gas_over_day(load_vehicle('gtmab'), day(300.0, 50.0))
    assert gas.irradiance == pytest.approx(350.0)
    assert gas.warmer == pytest.approx(0.017 * 350.0)
    # 2.7458 x (0.5 m)^3 of air of 1.204 kg/m3, 5.95 K of 293.15 K
    displaced = 2.7458 * 0.5**3 * 1.204
    assert gas.slack_gain == pytest.approx(displaced * 5.95 / 293.15, rel=1e-3)
    # 1.4 g for 1 K, as the docstring of `air_state` says
    assert gas.taut_loss == pytest.approx(13.6e-3, abs=0.4e-3)
    # No rotor pushes down: its 2 g of weight alone
    assert gas.held == pytest.approx(2e-3, abs=1e-5)
    assert not gas.is_held
    assert 'it rises' in describe_gas(gas)
    assert gas.ballast == pytest.approx(gas.slack_gain - 2e-3, abs=1e-5)


def test_flights_while_the_gas_lifts_more_than_the_drone_holds_are_counted():
    """2 g of 413 g of air are 1.42 K, from 83.5 W/m2 of 300 on: after 401 of 1440 minutes."""
    gas = estimate_gas_over_day(load_vehicle('gtmab'), day(300.0))
    assert gas.too_light == pytest.approx((60 * 401, 60 * 1439), abs=180)
    starts = [0.0, 300 * 60.0, 600 * 60.0, 86400.0 + 1000 * 60.0]
    assert gas.count_too_light(starts) == 2
    assert 'by up to 5.2 g: 2 of 4 flights' in describe_too_light(gas, starts)
    dim = estimate_gas_over_day(load_vehicle('gtmab'), day(80.0))
    assert dim.too_light is None
    assert describe_too_light(dim, starts) == ''
