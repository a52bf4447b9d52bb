# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Times, way home and reserve: by hand, and their deviations by chance."""

import math

from geometry_msgs.msg import TwistWithCovarianceStamped
from lta_energy.messages import to_travel_state
from lta_energy.monitoring import outlook
from lta_energy.monitoring.meters import TravelState
from lta_energy.monitoring.outlook import (
    EnergyReserveSettings,
    LoadEstimate,
    ReserveMargin,
    TravelEstimate,
    update_load,
    WayHomeSettings,
)
from lta_energy.monitoring.soc_ekf import CellState
from lta_model.electrical.battery import BatteryModel, open_circuit_voltage, stored_energy
from nav_msgs.msg import Odometry
import numpy as np
import pytest

CELL = BatteryModel(
    capacity=900.0, resistance=0.15, relaxation_resistance=0.094, relaxation_time=33.0
)
NONE = (0.0,) * 5


def known(charge=0.5, inverse=1.0, deviation=0.0, unsure=0.0, together=0.0):
    """Return a belief of some charge and inverse capacity."""
    rows = [list(NONE) for _ in range(5)]
    rows[0][0], rows[3][3] = deviation**2, unsure**2
    rows[0][3] = rows[3][0] = together
    return CellState((charge, 0.0, 1.0, inverse, 0.0), tuple(map(tuple, rows)))


def test_time_to_empty_by_hand():
    # Half of the cell holds 900 C * 37.225 V / 20; 2 W leave it above 3.0 V down to 0 %.
    time = outlook.estimate_discharge_time(CELL, known(), 2.0, 0.0)
    assert time == (pytest.approx(1675.125 / 2.0), 0.0)
    small = outlook.estimate_discharge_time(CELL, known(inverse=1.25), 2.0, 0.0)
    assert small.mean == pytest.approx(0.8 * time.mean)


def test_a_heavy_load_leaves_some_of_the_charge_behind():
    # 9 W at 3.0 V are 3 A: 0.732 V over 0.244 ohm. The cell must rest at 3.732 V, 20 %.
    power = 9.0
    assert outlook.empty_charge(CELL, known(), power) == pytest.approx(0.205, abs=1e-9)
    left = stored_energy(0.5, 900.0) - stored_energy(0.205, 900.0)
    assert outlook.estimate_discharge_time(CELL, known(), power, 0.0).mean == pytest.approx(
        left / power
    )
    assert outlook.estimate_discharge_time(CELL, known(0.1), power, 0.0).mean == 0.0


def test_time_to_full_by_hand():
    missing = stored_energy(1.0, 900.0) - stored_energy(0.5, 900.0)
    assert outlook.estimate_charging_time(CELL, known(), -0.5, 0.0) == (
        pytest.approx(missing / 0.5),
        0.0,
    )
    assert outlook.estimate_charging_time(CELL, known(), 0.5, 0.0) == outlook.NEVER_REACHED
    assert outlook.estimate_discharge_time(CELL, known(), -0.5, 0.0) == outlook.NEVER_REACHED


@pytest.mark.parametrize('charging', [False, True])
def test_the_deviation_of_a_time_is_that_of_a_thousand_cells(charging):
    rng = np.random.default_rng(1)
    covariance = np.array([[0.02**2, 0.3 * 0.02 * 0.05], [0.3 * 0.02 * 0.05, 0.05**2]])
    cells = rng.multivariate_normal([0.5, 1.0], covariance, 2000)
    power = (-1.0 if charging else 1.0) * rng.normal(2.0, 0.1, 2000)
    time = outlook.estimate_charging_time if charging else outlook.estimate_discharge_time
    times = [
        time(CELL, known(charge, inverse), watts, 0.0).mean
        for (charge, inverse), watts in zip(cells.tolist(), power.tolist(), strict=True)
    ]
    belief = known(0.5, 1.0, 0.02, 0.05, covariance[0, 1])
    told = time(CELL, belief, -2.0 if charging else 2.0, 0.1)
    assert told.mean == pytest.approx(np.mean(times), rel=0.01)
    assert told.deviation == pytest.approx(np.std(times), rel=0.06)


def test_a_young_load_is_the_plain_mean_and_an_old_one_forgets():
    now = outlook.initial_load(9.0)
    for watts in (1.0, 3.0, 5.0):
        now = update_load(now, watts, 2.0, 0.0, 120.0)
    assert now.mean == pytest.approx(3.0)
    assert now.quick == 5.0
    for _ in range(114):
        now = update_load(now, 3.0, 1.0, 5.0, 120.0)
    later = update_load(now, 4.0, 12.0, 5.0, 120.0)
    assert later.quick == pytest.approx(4.0 - math.exp(-12.0 / 5.0) * (4.0 - now.quick))
    assert later.mean - now.mean == pytest.approx(-math.expm1(-0.1) * (later.quick - now.mean))


def test_the_deviation_of_a_mean_load_is_what_chance_gives():
    """Ornstein-Uhlenbeck power of 20 s through both filters, beside the spread of its means."""
    rng, quick, slow, dt = np.random.default_rng(2), 20.0, 400.0, 2.0
    kept = math.exp(-dt / quick)
    means, told = [], []
    for _ in range(60):
        power, now = 2.0 + 0.5 * rng.standard_normal(), outlook.initial_load(2.0)
        for _ in range(1500):
            power = (
                2.0 + kept * (power - 2.0) + 0.5 * math.sqrt(1 - kept**2) * rng.standard_normal()
            )
            now = update_load(now, power, dt, 1e-9, slow)
        means.append(now.mean)
        told.append(outlook.mean_load_deviation(now, quick, slow))
    assert np.mean(means) == pytest.approx(2.0, abs=0.05)
    assert np.mean(told) == pytest.approx(np.std(means), rel=0.25)


def test_the_way_home_by_hand():
    settings = WayHomeSettings(head_wind=0.1)
    # 8 m at 0.5 - 0.1 m/s take 20 s at 1.5 W; 60 J bring the drone 40 s, or 16 m.
    travel = TravelEstimate(1.5, 0.5)
    assert outlook.energy_home(settings, travel, 8.0) == pytest.approx(30.0)
    assert outlook.reachable_distance(settings, travel, 60.0) == pytest.approx(16.0)
    assert outlook.reachable_distance(settings, travel, -1.0) == 0.0
    # It never comes to a stand in the books: 0.05 m/s over the ground at least.
    assert outlook.energy_home(settings, TravelEstimate(1.5, 0.1), 1.0) == pytest.approx(30.0)


def test_what_flying_takes_is_learnt_while_the_drone_moves():
    settings = WayHomeSettings(smoothing=10.0)
    travel = outlook.initial_travel(settings)
    assert outlook.update_travel(settings, travel, None, 9.0, 1.0) == travel
    assert outlook.update_travel(settings, travel, TravelState(3.0, 0.05), 9.0, 1.0) == travel
    travel = outlook.update_travel(settings, travel, TravelState(3.0, 1.0), 2.4, 10.0)
    share = 1.0 - math.exp(-1.0)
    assert travel == pytest.approx((1.4 + share * 1.0, 0.5 + share * 0.5))


def test_the_reserve_counts_what_is_sure_and_the_way_home():
    settings = EnergyReserveSettings(reserve=0.25, caution=2.0)
    home = 34.56  # J: 1 % of a cell at 3.84 V and 900 C
    stock = outlook.compute_reserve_margin(settings, CELL, known(0.5, deviation=0.02), home)
    assert stock.sure == pytest.approx(0.46)
    assert stock.home == pytest.approx(0.01)
    spare = stored_energy(0.46, 900.0) - stored_energy(0.25, 900.0) - home
    assert stock.spare == pytest.approx(spare)
    assert open_circuit_voltage(0.5) == 3.84


def test_where_the_power_is_smoothed_by_no_time_the_newest_counts():
    settings = WayHomeSettings(smoothing=0.0)
    travel = outlook.update_travel(
        settings, TravelEstimate(1.4, 0.5), TravelState(3.0, 1.0), 2.4, 0.1
    )
    assert travel == (2.4, 1.0)
    # A charging drone that moves takes nothing; from 0.1 m/s on it moves.
    travel = outlook.update_travel(
        settings, TravelEstimate(1.4, 0.5), TravelState(3.0, 0.1), -2.0, 0.1
    )
    assert travel == pytest.approx((0.0, 0.1))
    assert outlook.reachable_distance(settings, TravelEstimate(0.0, 0.5), 60.0) == math.inf


def test_a_charge_that_is_not_sure_at_all_is_none():
    """
    At 10 +- 20 % the whole reserve is missing; the cell holds 720 C, not the 900 C of its file.
    """
    settings = EnergyReserveSettings(reserve=0.25, caution=1.0)
    told = outlook.compute_reserve_margin(
        settings, CELL, known(0.1, inverse=1.25, deviation=0.2), 10.0
    )
    assert told.sure == pytest.approx(-0.1)
    assert told.home == pytest.approx(10.0 / (3.69 * 720.0))
    assert told.spare == pytest.approx(-stored_energy(0.25, 720.0) - 10.0)


def test_a_load_by_hand():
    """The averages over 5 s and 30 s, after 5 s with 2 W more."""
    before = LoadEstimate(2.0, 1.0, 0.5, 60.0)
    now = update_load(before, 4.0, 5.0, 5.0, 30.0)
    quick = 2.0 + (1.0 - math.exp(-1.0)) * 2.0
    share = 1.0 - math.exp(-1.0 / 6.0)
    off = quick - 1.0
    assert now == pytest.approx(
        (quick, 1.0 + share * off, (1.0 - share) * (0.5 + share * off * off), 65.0)
    )
    # The quick one is as old as 5 s are by its time: over 30 s a seventh of the variance is left.
    assert outlook.mean_load_deviation(
        LoadEstimate(1.0, 1.0, 0.07, 60.0), 5.0, 30.0
    ) == pytest.approx(0.1)
    assert outlook.mean_load_deviation(
        LoadEstimate(1.0, 1.0, 0.04, 15.0), 5.0, 30.0
    ) == pytest.approx(0.1)
    assert outlook.mean_load_deviation(
        LoadEstimate(1.0, 1.0, 0.04, 0.0), 0.0, 30.0
    ) == pytest.approx(0.2)


def test_the_way_home_is_known_without_an_airspeed():
    """A graph with an estimator of one's own may have `odom` alone."""
    odom = Odometry()
    odom.pose.pose.position.x, odom.pose.pose.position.y = 3.0, 4.0
    odom.twist.twist.linear.x = 0.7  # over ground
    odom.pose.covariance[0] = 0.01
    assert to_travel_state(odom, None) == TravelState(5.0, 0.0)
    airspeed = TwistWithCovarianceStamped()
    airspeed.twist.twist.linear.y = 0.3
    assert to_travel_state(odom, airspeed) == TravelState(5.0, 0.3)
    odom.pose.covariance[0] = -1.0
    assert to_travel_state(odom, airspeed) is None


def test_a_reserve_is_reached_at_its_very_edge():
    settings = EnergyReserveSettings(reserve=0.25, hysteresis=0.0625)
    for before, edge in ((False, 0.375), (True, 0.4375)):
        assert outlook.is_reserve_reached(settings, before, ReserveMargin(edge, 0.125, 0.0))
        assert not outlook.is_reserve_reached(
            settings, before, ReserveMargin(edge + 1e-9, 0.125, 0.0)
        )
