# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Bad readings: each fault is put into a clean series and must be named; no other may be."""

from dataclasses import replace
import math

from hypothesis import given
from hypothesis import strategies as st
from lta_energy.monitoring.faults import Latch, STAMP_ROUNDING, update_latch
from lta_energy.monitoring.monitor import EnergyEstimate, update_estimate
from lta_energy.monitoring.report import report_energy
from lta_graph.health import HealthLevel
import pytest

from .metered import ABOARD, CELL, follow, Metered, SETTINGS

BEFORE, AFTER = 400, 100  # readings: 40 s of clean flight, and 10 s of the fault


def series(seed=1, charge=(0.6, 0.9), lit=False):
    """Return a function that gives clean readings, in the dark or in bright light."""
    cell = Metered(seed, charge)

    def clean(n, change=lambda reading: reading):
        return [
            change(cell.reading(panel_current=cell.rng.normal(0.2, 1e-3), illuminance=4e4))
            if lit
            else change(cell.reading(illuminance=200.0))
            for _ in range(n)
        ]

    return cell, clean


def names(estimate):
    return {fault.name for fault in estimate.watch.faults}


def flown(change, lit=False):
    """Return what was named at any time of a fault, and the last estimate."""
    _, clean = series(lit=lit)
    estimate = follow(clean(BEFORE))
    assert names(estimate) == set()
    named = set()
    for reading in clean(AFTER, change):
        estimate = update_estimate(SETTINGS, ABOARD, estimate, reading)
        named |= names(estimate)
    return named, estimate


def frozen(attribute):
    held = {}

    def change(reading):
        held.setdefault('value', getattr(reading, attribute))
        return replace(reading, **{attribute: held['value']})

    return change


NUMBER = {
    'not a number': lambda r: replace(r, voltage=math.nan),
    'dropout': lambda r: replace(r, voltage=0.0, current=0.0),
    'implausible': lambda r: replace(r, voltage=10.0 * r.voltage),
    'reversed current': lambda r: replace(r, current=-r.current),
    'frozen': frozen('current'),
    'brown-out': lambda r: replace(r, voltage=r.voltage - 1.0),
}


@pytest.mark.parametrize('name', NUMBER)
def test_a_fault_of_the_battery_is_named_and_ends_the_flight(name):
    named, estimate = flown(NUMBER[name])
    assert name in named
    assert named == {name}
    assert estimate.reserve
    assert estimate.is_landing_urgent
    level, sentence = report_energy(SETTINGS, CELL, estimate).meters
    assert level is HealthLevel.ERROR
    assert sentence.startswith(name)
    assert report_energy(SETTINGS, CELL, estimate).battery[0] is HealthLevel.ERROR


PANEL = {
    'panel short': lambda r: replace(r, panel_voltage=0.02),
    'panel not measured': lambda r: replace(r, panel_voltage=math.nan),
    'panel frozen': frozen('panel_current'),
}


@pytest.mark.parametrize('name', PANEL)
def test_a_fault_of_the_panel_is_named_and_the_flight_goes_on(name):
    named, estimate = flown(PANEL[name], lit=True)
    assert named == {name}
    assert not estimate.reserve
    assert not estimate.is_landing_urgent
    assert report_energy(SETTINGS, CELL, estimate).meters[0] is HealthLevel.WARN


def test_a_reversed_current_is_seen_in_bright_light_by_the_resistance():
    """The panel gives more than the motors take, so that power alone tells nothing."""

    _, clean = series(lit=True)

    def change(reading):
        return replace(reading, panel_current=5 * reading.panel_current, current=-reading.current)

    estimate = follow(clean(200, change))
    assert 'reversed current' in names(estimate)
    assert (
        'the battery voltage falls while the current charges it'
        in report_energy(SETTINGS, CELL, estimate).meters[1]
    )


@pytest.mark.parametrize('back', [0.5, 60.0, 3600.0])
def test_a_clock_that_is_set_back_is_told_and_the_energy_stays_known(back):
    cell, clean = series()
    estimate, last = follow(clean(BEFORE)), None

    def earlier(reading):
        return replace(reading, stamp_ns=reading.stamp_ns - round(back * 1e9))

    named, stored, told = set(), estimate.books.stored, set()
    for reading in clean(550, earlier):
        last, estimate = estimate, update_estimate(SETTINGS, ABOARD, estimate, reading)
        named |= names(estimate)
        told |= {fault.sentence for fault in estimate.watch.faults}
        assert not estimate.is_landing_urgent
        assert not estimate.reserve
        assert abs(estimate.books.stored - last.books.stored) < 2.0  # J; of 0.2 s, not of the leap
    assert named == {'set back'}
    # The first reading after the clock change came 0.1 s after the last one.
    (sentence,) = told
    assert sentence.startswith(
        f'the clock of the battery readings was set back by {back - 0.1:.1f} s: '
    )
    assert names(estimate) == set()
    assert estimate.charge == pytest.approx(cell.charge, abs=2.0 * estimate.deviation)
    assert estimate.books.stored < stored


def test_what_is_overtaken_or_told_late_sets_no_clock_back():
    """Old messages between good ones, in their own order or not: they are left, as ever."""
    _, clean = series()
    estimate = follow(clean(BEFORE))
    fresh = clean(20)
    old = [replace(reading, stamp_ns=reading.stamp_ns - 60 * 10**9) for reading in fresh]
    for late, good in zip(old, fresh, strict=True):
        estimate = follow([late, good], estimate=estimate)
        assert (names(estimate), estimate.last) == (set(), good)
    estimate = follow([old[7], old[3], old[7], old[3]], estimate=estimate)
    assert (names(estimate), estimate.last) == ({'clock'}, good)


# Eight seeds are flown every time, the others by the long tests.
@pytest.mark.parametrize(
    'seed', [*range(8), *(pytest.param(k, marks=pytest.mark.long) for k in range(8, 20))]
)
@pytest.mark.parametrize('lit', [False, True])
def test_clean_flights_raise_no_alarm(seed, lit):
    """A minute each of a cell that differs from its file, from the middle of some flight."""
    cell, estimate = Metered(seed, (0.35, 1.0), off=True), EnergyEstimate()
    for _ in range(600):
        light = abs(cell.rng.normal(0.2, 1e-3)) if lit else 0.0
        reading = cell.reading(panel_current=light, illuminance=5e4 * lit)
        estimate = update_estimate(SETTINGS, ABOARD, estimate, reading)
        assert names(estimate) == set(), seed


@given(st.lists(st.booleans(), max_size=60), st.floats(0.0, 1.0), st.floats(0.0, 1.0))
def test_a_latch_changes_only_when_its_condition_has_lasted(conditions, rise, fall):
    latch, lasted = Latch(), 0.0
    for condition in conditions:
        before = latch
        latch = update_latch(latch, condition, 0.1, rise, fall)
        lasted = lasted + 0.1 if condition != before.on else 0.0
        assert (latch.on != before.on) == (
            lasted > 0.0 and lasted + STAMP_ROUNDING >= (rise if condition else fall)
        )
        if latch.on != before.on:
            assert latch.on is condition
            lasted = 0.0


@pytest.mark.parametrize(
    'impossible', [{'current': 1e30}, {'voltage': -1e30}, {'voltage': 1e5, 'panel_voltage': 1e30}]
)
def test_what_no_meter_reads_is_named_and_leaves_nothing_behind(impossible):
    _, clean = series(lit=True)
    before = follow(clean(BEFORE))
    struck = follow([replace(one, **impossible) for one in clean(10)], estimate=before)
    assert 'not a number' in names(struck)
    assert 'the battery readings of ' in report_energy(SETTINGS, CELL, struck).battery[1]
    after = follow(clean(AFTER), estimate=struck)
    assert after.charge == pytest.approx(before.charge, abs=0.02)
    assert after.belief.deviation < 1.1 * before.belief.deviation
    assert after.books.harvested < before.books.harvested + 10.0  # J in 11 s of bright light


def test_another_cell_is_noticed_and_its_charge_estimated_anew():
    cell, clean = series(charge=(0.85, 0.9))
    estimate = follow(clean(BEFORE))
    cell.charge, cell.relaxation = 0.35, 0.0
    estimate = follow(clean(3), estimate=estimate)
    assert 'swapped' in names(estimate)
    assert estimate.is_landing_urgent
    estimate = follow(clean(600), estimate=estimate)
    assert names(estimate) == set()
    assert estimate.charge == pytest.approx(cell.charge, abs=0.05)
