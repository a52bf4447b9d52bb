"""The monitor: charge from meters alone, books, time to empty, reserve, and what it says."""

from itertools import pairwise
import math

from hypothesis import given
from hypothesis import strategies as st
from lta_energy import alarms, battery
from lta_energy.monitor import Estimate, MonitorSettings, Reading, time_to_empty, update
from lta_graph.health import Level
from lta_sim.sensors import power
import numpy as np
import pytest

SETTINGS = MonitorSettings()
CELL = battery.Battery(capacity=900.0, resistance=0.13)
SECOND = 1_000_000_000


def readings(*pairs, harvest=0.0):
    """Return one reading a second from pairs of voltage and current."""
    return [
        Reading((k + 1) * SECOND, voltage, current, harvest)
        for k, (voltage, current) in enumerate(pairs)
    ]


def follow(series, settings=SETTINGS):
    estimate = Estimate()
    for reading in series:
        estimate = update(settings, CELL, estimate, reading)
    return estimate


def test_it_starts_from_the_resting_voltage():
    # 3.84 V is half full; idle electronics of 26 mA drop 3.38 mV over 0.13 ohm.
    estimate = follow(readings((3.84 - 0.13 * 0.026, -0.026)))
    assert estimate.charge == pytest.approx(0.5, abs=1e-9)
    assert estimate.rested
    assert not follow(readings((3.8, -0.3))).rested


def test_then_it_counts_the_current_only():
    # Trapezoids: (0 + 0.4) / 2 * 1 s + 0.4 * 1 s = 0.6 C of 900 C; the voltage plays no part.
    estimate = follow(readings((3.84, 0.0), (3.0, -0.4), (4.2, -0.4)))
    assert estimate.charge == pytest.approx(0.5 - 0.6 / 900.0, rel=1e-12)


def test_the_books_by_hand():
    # Two seconds of 4 V and -0.5 A, and 0.3 W harvested: 1.0 * 2 s out of the cell's 2 W ...
    estimate = follow(readings((3.9, -0.5), (3.9, -0.5), (3.9, -0.5), harvest=0.3))
    books = estimate.books
    assert books.harvested == pytest.approx(0.6)
    assert books.consumed == pytest.approx(0.6 + 2 * 1.95)
    assert books.lost == pytest.approx(2 * 0.13 * 0.25)
    # The cell rests at 3.9 + 0.065 = 3.965 V and gives 1 C from there; 0.6 V a unit of charge.
    assert books.stored == pytest.approx(-(3.965 - 0.6 * 0.5 / 900.0), rel=1e-6)
    assert abs(books.imbalance) < 1e-3


def test_time_to_empty_by_hand():
    estimate = follow(readings((3.84 - 0.13 * 0.4, -0.4)))
    half = battery.stored_energy(0.5, 900.0)
    assert time_to_empty(CELL, estimate) == pytest.approx(half / (3.84 * 0.4), rel=1e-9)
    assert time_to_empty(CELL, follow(readings((3.9, 0.2), harvest=1.0))) == math.inf
    assert math.isnan(time_to_empty(CELL, Estimate()))


def test_the_drain_is_smoothed_over_five_seconds():
    estimate = follow(readings((3.84, 0.0), *[(3.8, -0.4)] * 5))
    expected = battery.open_circuit_voltage(estimate.charge) * 0.4 * -math.expm1(-1.0)
    assert estimate.drain == pytest.approx(expected, rel=1e-3)


def test_the_reserve_has_hysteresis():
    settings = MonitorSettings(reserve=0.5, hysteresis=0.05)
    down = readings((3.842, 0.0), (3.8, -4.5), (3.8, -4.5))
    estimate = follow(down[:1], settings)
    assert estimate.charge == pytest.approx(0.51, abs=1e-9)
    assert not estimate.reserve
    estimate = follow(down, settings)
    assert estimate.charge == pytest.approx(0.5025, abs=1e-9)
    assert not estimate.reserve
    # 4.5 C more and the reserve is reached; 46.8 C back are not yet enough, 8.1 C more are.
    for k, (current, charge, reserve) in enumerate(
        [(-4.5, 0.4975, True), (45.0, 0.52, True), (8.1, 0.5495, True), (8.1, 0.5585, False)]
    ):
        estimate = update(settings, CELL, estimate, Reading((k + 4) * SECOND, 3.8, current))
        assert estimate.charge == pytest.approx(charge, abs=1e-9)
        assert estimate.reserve is reserve


def test_an_unknown_charge_counts_as_reserve_reached():
    unknown = Estimate()
    for reading in readings((math.nan, -0.1), (3.9, math.nan)):
        assert update(SETTINGS, CELL, unknown, reading) is unknown
    assert unknown.reserve
    assert not update(SETTINGS, CELL, unknown, Reading(9 * SECOND, 4.1, 0.0)).reserve


def test_unusable_and_older_readings_change_nothing():
    estimate = follow(readings((3.9, -0.1), (3.9, -0.1)))
    for bad in (Reading(3 * SECOND, math.nan, -0.1), Reading(SECOND, 3.9, -0.1)):
        assert update(SETTINGS, CELL, estimate, bad) is estimate


def test_without_a_panel_the_cell_is_still_counted():
    estimate = follow(readings((3.84, -0.9), (3.84, -0.9), harvest=math.nan))
    assert estimate.charge < follow(readings((3.84, -0.9))).charge
    assert estimate.books.harvested == 0.0


@given(st.lists(st.floats(-2.0, 2.0), min_size=2, max_size=30), st.integers(1, 10 * SECOND))
def test_charge_stays_in_bounds_and_undoing_a_current_restores_it(currents, period):
    there = [Reading((k + 1) * period, 3.9, i) for k, i in enumerate(currents)]
    estimate = follow(there)
    assert 0.0 <= estimate.charge <= 1.0
    start = follow(there[:1]).charge
    drawn = sum(a + b for a, b in pairwise(currents)) / 2 * period * 1e-9
    if sum(abs(i) for i in currents) * period * 1e-9 < 900.0 * min(start, 1 - start):
        assert estimate.charge == pytest.approx(start + drawn / 900.0, abs=1e-9)


def test_a_flight_through_real_meters_is_known_to_two_percent():
    meter = power.PowerMeterSettings()
    for seed in range(20):
        rng = np.random.default_rng(seed)
        errors, charge, estimate = power.draw(meter, rng), 0.8, Estimate()
        for k in range(1200):
            load = 0.12 if k < 20 else 1.4
            charge, _, voltage, current = battery.advance(CELL, charge, 0.0, -load, 0.1)
            volts, amperes = power.measure(meter, errors, voltage, current, rng)
            reading = Reading(SECOND + k * 100_000_000, volts, amperes, 0.0)
            estimate = update(SETTINGS, CELL, estimate, reading)
        # 167 J and 2 J of losses at 4.0 V are 42 C of 900 C.
        assert charge == pytest.approx(0.8 - 0.047, abs=0.001)
        assert estimate.charge == pytest.approx(charge, abs=0.02)
        assert estimate.books.consumed == pytest.approx(118.0 * 1.4 + 2 * 0.12, rel=0.005)


@pytest.mark.parametrize(
    ('series', 'level', 'words'),
    [
        ([], Level.WARN, 'no usable reading'),
        (readings((4.11, -0.1)), Level.OK, '92% left, 128 min at this power'),
        (readings((4.11, 0.1)), Level.OK, '88% left'),
        (readings((3.7, -0.1)), Level.WARN, 'battery low: 16% left, reserve 25%'),
        (readings((3.2, -0.1)), Level.ERROR, 'only 3.20 V: land now'),
    ],
)
def test_what_is_said_of_the_battery(series, level, words):
    found, sentence = alarms.battery(SETTINGS, CELL, follow(series))
    assert (found, words in sentence) == (level, True), sentence


@pytest.mark.parametrize(
    ('series', 'level', 'words'),
    [
        (readings((math.nan, -0.1)), Level.ERROR, 'not a number'),
        (readings((3.9, 0.4)), Level.ERROR, 'takes up 1.56 W but the panel gives 0.00 W'),
        (readings((3.9, 0.1), harvest=0.4), Level.OK, 'plausible'),
        (readings((3.9, -0.02), harvest=math.nan), Level.WARN, 'panel is not measured'),
        (readings((3.8, -0.4)), Level.WARN, 'under load'),
        (
            [Reading(SECOND, 3.9, 0.0, 0.0), Reading(4 * SECOND, 3.9, 0.0, 0.0)],
            Level.WARN,
            '3.0 s',
        ),
    ],
)
def test_what_is_said_of_the_meters(series, level, words):
    found, sentence = alarms.meters(follow(series), series[-1])
    assert (found, words in sentence) == (level, True), sentence
