# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The drone's own charge gauge over a day."""

import math

from lta_energy.circuit import ChargeGauge, propagate_gauge, update_gauge
from lta_model.electrical.battery import BatteryModel
import pytest

CELL = BatteryModel(capacity=900.0, resistance=0.15, relaxation_resistance=0.05)


def test_counting_errs_by_two_parts_in_a_thousand_and_four_tenths_of_a_milliampere():
    """0.5 A for 90 s is 5 % of 900 C; the meter errs by 1 mA (scale) and 0.4 mA (offset)."""
    for current, charge in ((-0.5, 0.45), (0.5, 0.55)):
        found = propagate_gauge(CELL, ChargeGauge(0.5, 0.01), current, 90.0)
        assert found == (pytest.approx(charge), pytest.approx(0.01 + 1.4e-3 * 90.0 / 900.0))
        assert (
            update_gauge(CELL, ChargeGauge(0.5, 0.01), 3.0, current, 90.0) == found
        )  # it does not rest


def corrected(deviation, dt, told=0.5, noise=0.02):
    """
    Return the expected gauge after a voltage that stands for charge `told`, with noise in charge.
    """
    counted = 0.52, deviation + 4e-4 * dt / 900.0
    weight = counted[1] ** 2 / (counted[1] ** 2 + noise**2 * max(3600.0 / dt, 1.0))
    return (
        pytest.approx(counted[0] + weight * (told - counted[0])),
        pytest.approx(counted[1] * math.sqrt(1.0 - weight)),
    )


@pytest.mark.parametrize('dt', [30.0, 3600.0, 7200.0])
def test_a_resting_voltage_corrects_by_the_slope_of_the_chart(dt):
    """3.84 V is 50 %; from 48 to 52 % the curve rises 12 mV, so 10 mV is 3.3 % of charge."""
    found = update_gauge(CELL, ChargeGauge(0.52, 0.05), 3.84, 0.0, dt)
    assert found == corrected(0.05, dt, noise=0.01 * 0.04 / 0.012)


def test_a_cell_rests_up_to_a_tenth_of_an_ampere_and_its_drop_is_taken_off():
    """The drop is 0.1 A * 0.2 ohm = 20 mV."""
    for current, voltage in ((-0.1, 3.82), (0.1, 3.86)):
        found = update_gauge(CELL, ChargeGauge(0.52, 0.05), voltage, current, 1e-6)
        assert found.charge == pytest.approx(0.52, abs=1e-6)
        assert found.deviation < 0.05
        found = update_gauge(CELL, ChargeGauge(0.52, 0.5), voltage, current, 1e-6 + 3600.0)
        counted = 0.52 + current * 3600.0 / 900.0
        assert abs(found.charge - 0.5) < 0.05 < abs(counted - 0.5)
        more = math.nextafter(current, math.copysign(1.0, current))
        assert update_gauge(
            CELL, ChargeGauge(0.52, 0.5), voltage, more, 3600.0
        ).charge == pytest.approx(counted)
