# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The monitor: one reading through filter, books, way home and reserve; what it says of it."""

from dataclasses import replace
import math

from lta_energy.monitoring.meters import MeterReading, PowerSystem, TravelState
from lta_energy.monitoring.monitor import EnergyEstimate, MonitorSettings, update_estimate
from lta_energy.monitoring.report import report_energy
from lta_energy.monitoring.soc_ekf import (
    CellState,
    correct_state,
    initialize_from_reading,
    predict_state,
)
from lta_graph.health import HealthLevel
from lta_model.electrical import battery
from lta_model.electrical.mppt_charger import ChargerModel
import pytest

from .metered import ABOARD, CELL

SETTINGS = MonitorSettings()
TENTH = 100_000_000


def readings(*pairs, harvest=0.0, where=None):
    """Return a reading every 0.1 s from pairs of voltage and current; the last bits vary."""
    return [
        MeterReading(
            (k + 10) * TENTH, voltage + 1e-9 * (k % 2), current + 1e-9 * (k % 2),
            4.4, harvest / 4.4, 200.0, where,
        )
        for k, (voltage, current) in enumerate(pairs)
    ]  # fmt: skip


def follow(series, settings=SETTINGS):
    estimate = EnergyEstimate()
    for reading in series:
        estimate = update_estimate(settings, ABOARD, estimate, reading)
    return estimate


def resting(charge, current=-0.03):
    """Return voltage and current of a cell that has given a small current for long."""
    return battery.open_circuit_voltage(charge) + (0.15 + 0.094) * current, current


def test_the_times_follow_the_power():
    estimate = follow(readings(*[resting(0.5, -0.4)] * 100))
    power = 0.4 * battery.open_circuit_voltage(estimate.charge)
    capacity = 900.0 / estimate.belief.mean[3]
    left = battery.stored_energy(estimate.charge, capacity) / power
    told = report_energy(SETTINGS, CELL, estimate).empty
    assert told.mean == pytest.approx(left, rel=5e-3)  # the mean of ten seconds
    assert told.deviation > 0.0
    assert report_energy(SETTINGS, CELL, estimate).full.mean == math.inf
    charged = follow(readings(*[resting(0.5, 0.2)] * 100, harvest=1.0))
    assert report_energy(SETTINGS, CELL, charged).empty.mean == math.inf
    missing = battery.stored_energy(1.0, 900.0) - battery.stored_energy(0.5, 900.0)
    assert report_energy(SETTINGS, CELL, charged).full.mean == pytest.approx(
        missing / 0.77, rel=0.15
    )
    assert math.isnan(report_energy(SETTINGS, CELL, EnergyEstimate()).empty.mean)


def test_an_unknown_charge_counts_as_reserve_reached():
    unknown = EnergyEstimate()
    for reading in readings((math.nan, -0.1), (3.9, math.nan), (0.0, 0.0)):
        unknown = update_estimate(SETTINGS, ABOARD, unknown, reading)
        assert (unknown.reserve, unknown.is_landing_urgent) == (True, True)
        assert math.isnan(unknown.charge)
    known = follow(readings(*[resting(0.9)] * 50))
    assert (known.reserve, known.is_landing_urgent) == (False, False)


def test_a_doubtful_charge_counts_as_reserve_reached():
    strict = MonitorSettings(doubt=0.01)
    estimate = follow(readings(*[resting(0.9)] * 50), strict)
    assert estimate.reserve
    assert not estimate.is_landing_urgent
    assert 'too uncertain' in report_energy(strict, CELL, estimate).battery[1]
    edge = MonitorSettings(doubt=estimate.deviation)
    assert not follow(readings(*[resting(0.9)] * 50), edge).reserve


def test_the_way_home_brings_the_reserve_nearer():
    settings = MonitorSettings(reserve=0.5)
    series = [resting(0.62)] * 50
    near = follow(readings(*series, where=TravelState(1.0, 0.0)), settings)
    far = follow(readings(*series, where=TravelState(100.0, 0.0)), settings)
    assert not near.reserve
    assert far.reserve
    # 100 m at 0.4 m/s over the ground and 1.4 W are 350 J of some 3400 J.
    assert far.stock.home == pytest.approx(350.0 / (900.0 * 3.88), rel=0.02)
    assert report_energy(SETTINGS, CELL, far).way[0] is HealthLevel.WARN
    assert 'the start is 100.0 m away' in report_energy(SETTINGS, CELL, far).way[1]
    assert report_energy(SETTINGS, CELL, near).way[0] is HealthLevel.OK


def test_a_reading_of_the_past_changes_nothing():
    estimate = follow(readings(*[(3.9, -0.1)] * 10))
    after = update_estimate(SETTINGS, ABOARD, estimate, replace(estimate.last, stamp_ns=TENTH))
    assert (after.belief, after.books, after.last) == (
        estimate.belief, estimate.books, estimate.last,
    )  # fmt: skip


def two(dt, second=-0.9, **before):
    """Return the estimates after a reading of -0.5 A and after the next one."""
    one = update_estimate(
        SETTINGS, ABOARD, EnergyEstimate(), MeterReading(TENTH, 3.8, -0.5, 4.4, 0.0)
    )
    one = one._replace(**before)
    reading = MeterReading(TENTH + round(dt * 1e9), 3.75, second, 4.4, 0.0)
    return one, update_estimate(SETTINGS, ABOARD, one, reading)


@pytest.mark.parametrize('dt', [0.5, 1.0])
def test_up_to_a_second_the_mean_of_two_readings_has_flowed_between_them(dt):
    """The mean is 0.7 A; its deviation is 0.3 of the 0.4 A change, plus 1 mA."""
    one, after = two(dt)
    assert one.belief == initialize_from_reading(SETTINGS.belief, CELL, 3.8, -0.5)
    ahead = predict_state(SETTINGS.belief, CELL, one.belief, -0.7, 0.3 * 0.4 + 1e-3, dt)
    belief, surprise = correct_state(SETTINGS.belief, CELL, ahead, 3.75, -0.9)
    assert after.belief.mean == pytest.approx(belief.mean, rel=1e-12)
    for row, expected in zip(after.belief.spread, belief.spread, strict=True):
        assert row == pytest.approx(expected, rel=1e-9, abs=1e-18)
    assert after.surprise == pytest.approx(surprise)
    assert after.gap == pytest.approx(dt)


@pytest.mark.parametrize(('dt', 'second'), [(1.5, -0.9), (0.5, math.nan)])
def test_through_a_gap_the_load_of_before_is_believed_and_may_be_as_wrong(dt, second):
    one, after = two(dt, second)
    current = one.load.quick / battery.open_circuit_voltage(one.charge)
    assert current == pytest.approx(0.5)
    ahead = predict_state(SETTINGS.belief, CELL, one.belief, -current, current + 1e-3, dt)
    expected = (
        ahead
        if math.isnan(second)
        else correct_state(SETTINGS.belief, CELL, ahead, 3.75, second)[0]
    )
    assert after.belief.mean == pytest.approx(expected.mean, rel=1e-12)
    assert after.deviation == pytest.approx(expected.deviation, rel=1e-9)


def test_the_books_between_two_readings_by_hand_with_a_charger():
    """Of 0.5 and 0.3 W of the array, less 22 mW, 85 % passes the charger."""
    aboard = PowerSystem(CELL, ChargerModel(tracking=0.95, conversion=0.85, idle=0.022))
    one = update_estimate(
        SETTINGS, aboard, EnergyEstimate(), MeterReading(TENTH, 3.8, -0.5, 5.0, 0.1)
    )
    books = update_estimate(
        SETTINGS, aboard, one, MeterReading(6 * TENTH, 3.7, -0.9, 5.0, 0.06)
    ).books
    after = update_estimate(SETTINGS, aboard, one, MeterReading(6 * TENTH, 3.7, -0.9, 5.0, 0.06))
    given = (0.478 + 0.278) * 0.85 / 2.0
    assert books.harvested == pytest.approx(0.5 * 0.4)
    assert books.consumed == pytest.approx(0.5 * (given + (1.9 + 3.33) / 2.0))
    mean, volts = after.belief.mean, battery.open_circuit_voltage(after.charge)
    resistance = mean[2] * 0.15 * (0.25 + 0.81) / 2.0
    assert books.lost == pytest.approx(0.5 * (0.4 - given + resistance - 0.7 * mean[1]))
    assert books.stored == pytest.approx(-0.5 * 0.7 * volts)


@pytest.mark.parametrize(
    ('charge', 'jump', 'swapped'),
    [(0.5, 0.3, True), (0.5, -0.3, True), (0.985, 0.2, False), (0.015, -0.2, False),
     (0.975, 0.2, True), (0.025, -0.3, True)],
)  # fmt: skip
def test_beyond_two_percent_from_either_end_no_voltage_is_another_cell(charge, jump, swapped):
    """Near empty and full, cells deviate from the voltage curve by themselves."""
    rows = [[0.0] * 5 for _ in range(5)]
    rows[0][0] = 1e-8
    known = CellState((charge, 0.0, 1.0, 1.0, 0.0), tuple(map(tuple, rows)))
    one = update_estimate(
        SETTINGS, ABOARD, EnergyEstimate(), MeterReading(TENTH, 3.8, -0.01, 4.4, 0.0)
    )
    one = one._replace(belief=known)
    volts = battery.open_circuit_voltage(charge) + jump
    for k in range(1, 6):
        reading = MeterReading(TENTH * (1 + k), volts, -0.01 - 1e-6 * k, 4.4, 0.0)
        one = update_estimate(SETTINGS, ABOARD, one, reading)
    assert ('swapped' in {fault.name for fault in one.watch.faults}) is swapped


def test_a_voltage_is_critical_at_3_2_and_well_again_above_3_3():
    """The limits hold to 10 mV, and must persist for 0.3 s and 5 s."""
    estimate = follow(readings(*[(3.5, -0.1)] * 20))
    stamp = estimate.last.stamp_ns
    for k, volts in enumerate([3.201] * 10 + [3.2] * 3 + [3.3] * 60 + [3.301] * 49 + [3.299]):
        reading = MeterReading(stamp + (k + 1) * TENTH, volts, -0.1 - 1e-6 * k, 4.4, 0.0)
        estimate = update_estimate(SETTINGS, ABOARD, estimate, reading)
        assert estimate.critical.on is (k >= 12)
    spoilt = MeterReading(stamp + 200 * TENTH, math.nan, -0.1)
    assert update_estimate(SETTINGS, ABOARD, estimate, spoilt).critical == estimate.critical
