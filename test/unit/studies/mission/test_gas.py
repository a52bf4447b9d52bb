# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Gas over a day: the lift that light and air change, against a hand calculation."""

import math

from lta_energy.irradiance import IrradianceSeries
from lta_model.vehicle import load_vehicle
from lta_studies.mission.gas import (
    describe_gas,
    draw_slack,
    estimate_gas_over_day,
    find_brightest_light,
)
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
    assert gas.ballast == pytest.approx(gas.slack_gain - 2e-3, abs=1e-5)
    assert f'{1e3 * gas.ballast:.1f} g more ballast' in describe_gas(gas)


def test_a_taut_drone_flies_in_any_light_and_a_slack_one_in_dim_light():
    """2 g of 413 g of air are 1.42 K: 83.5 W/m2 for a slack envelope, twice that for a half."""
    gtmab = load_vehicle('gtmab')
    assert find_brightest_light(gtmab, 0.0) == math.inf
    assert find_brightest_light(gtmab, 1.0) == pytest.approx(83.5, abs=0.1)
    assert find_brightest_light(gtmab, 0.5) == pytest.approx(167.0, abs=0.2)


def test_the_slack_of_seeds_is_even_from_taut_to_slack():
    drawn = np.array([draw_slack(seed) for seed in range(400)])
    assert drawn.tolist() == [draw_slack(seed) for seed in range(400)]
    # Five standard errors of the mean
    assert drawn.mean() == pytest.approx(0.5, abs=5 / 12**0.5 / 20)
    assert 0.0 <= drawn.min() < 0.02
    assert 0.98 < drawn.max() < 1.0
