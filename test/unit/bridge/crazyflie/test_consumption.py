"""The modelled current, against Bitcraze's own bench table."""

from lta_bridge.crazyflie.consumption import Consumption
from lta_energy.rotor import BENCH
from lta_sim.vehicle import load_vehicle
import pytest

GTMAB = Consumption.of(load_vehicle('gtmab').file.energy)


def test_at_rest_it_is_that_of_radio_electronics_and_light_board():
    """97 + 23 + 190 mW (seed paper) at 3.8 V."""
    assert GTMAB.current((0.0,) * 4, 3.8) == pytest.approx(-0.310 / 3.8)


def test_four_motors_take_what_the_bench_measured():
    """Row by row within 0.3 A: what the energy monitor is told to expect of the model."""
    idle = BENCH[0].current
    for row in BENCH[1:]:
        rotors = -GTMAB.current((row.duty,) * 4, row.voltage) - GTMAB.electronics / row.voltage
        assert rotors == pytest.approx(row.current - idle, abs=0.3)
