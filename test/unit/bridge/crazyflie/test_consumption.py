# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The modelled current, against Bitcraze's own bench table."""

from lta_bridge.crazyflie.messages import CrazyfliePowerModel
from lta_model.electrical.loads import BENCH
from lta_model.vehicle import load_vehicle
import pytest

GTMAB = CrazyfliePowerModel.from_energy(load_vehicle('gtmab').file.energy)


def test_at_rest_it_is_that_of_radio_electronics_and_light_board():
    """97 + 23 + 190 mW (seed paper) at 3.8 V."""
    assert GTMAB.cell_current((0.0,) * 4, 3.8) == pytest.approx(-0.310 / 3.8)


def test_four_motors_take_what_the_bench_measured():
    """Row by row within 0.3 A: what the energy monitor is told to expect of the model."""
    idle = BENCH[0].current
    for row in BENCH[1:]:
        rotors = (
            -GTMAB.cell_current((row.duty,) * 4, row.voltage) - GTMAB.electronics / row.voltage
        )
        assert rotors == pytest.approx(row.current - idle, abs=0.3)


def test_each_load_counts_once_and_one_that_is_not_told_takes_nothing():
    energy = load_vehicle('gtmab').file.energy
    dark = energy.model_copy(update={'loads': energy.loads.model_copy(update={'sensing': None})})
    assert CrazyfliePowerModel.from_energy(dark).electronics == pytest.approx(0.097 + 0.023)
    # 2 W, and two rotors of 1 W and 10 W/N: at 4 V a duty of 0.25 is 1 V, 25.3 mN.
    told = CrazyfliePowerModel(2.0, 1.0, 10.0).cell_current((0.25, 0.0, 0.25), 4.0)
    assert told == pytest.approx(-(2.0 + 2 * 1.2530) / 4.0, rel=1e-4)
