# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Each detector of bad readings by itself: its limits, and how long it must see and not see.

The figures are those of docs/energy.md and of each file's own words.
"""

import math

from lta_energy.monitoring.faults import (
    DETECTORS,
    DetectorStates,
    MeterObservation,
    update_detectors,
)
from lta_energy.monitoring.meters import MeterReading
from lta_model.electrical.battery import BatteryModel
import pytest

CELL = BatteryModel(
    capacity=900.0, resistance=0.15, relaxation_resistance=0.094, relaxation_time=33.0
)
BY_NAME = {detector.name: detector for detector in DETECTORS}
WELL = MeterReading(0, 3.8, -0.5, panel_voltage=4.4, panel_current=0.0, illuminance=200.0)


def reading(**changed):
    return MeterReading(**{**{name: getattr(WELL, name) for name in (
        'stamp_ns', 'voltage', 'current', 'panel_voltage', 'panel_current', 'illuminance',
    )}, **changed})  # fmt: skip


def sees(name, now, before=WELL, dt=0.1, memory=None, **other):
    detector = BY_NAME[name]
    memory = detector.start if memory is None else memory
    message, after = detector.find(memory, MeterObservation(now, before, dt, CELL, **other))
    return bool(message), after


@pytest.mark.parametrize(
    ('name', 'well', 'ill'),
    [
        ('not a number', {'voltage': 3.8}, {'voltage': math.nan}),
        ('not a number', {'current': 0.0}, {'current': math.inf}),
        ('dropout', {'voltage': 0.1}, {'voltage': 0.099}),
        ('dropout', {'voltage': -0.1}, {'voltage': -0.099}),
        ('implausible', {'voltage': 2.0}, {'voltage': 1.99}),
        ('implausible', {'voltage': 4.45}, {'voltage': 4.451}),
        ('implausible', {'voltage': 0.09}, {'voltage': 0.1}),  # less is a dropout
        ('brown-out', {'voltage': 3.001}, {'voltage': 3.0}),
        ('brown-out', {'voltage': 0.09}, {'voltage': 0.1}),
        ('panel not measured', {'panel_current': 0.0}, {'panel_current': math.nan}),
    ],
)
def test_the_limits_of_a_single_reading(name, well, ill):
    assert not sees(name, reading(**well))[0]
    assert sees(name, reading(**ill))[0]


@pytest.mark.parametrize(
    ('lux', 'volts', 'short'),
    [(501.0, 0.29, True), (500.0, 0.29, False), (501.0, 0.3, False), (math.nan, 0.0, False)],
)
def test_a_panel_is_short_below_three_tenths_of_a_volt_in_more_than_500_lx(lux, volts, short):
    assert sees('panel short', reading(illuminance=lux, panel_voltage=volts))[0] is short


def test_a_gap_is_longer_than_a_second():
    assert not sees('gap', WELL, dt=1.0)[0]
    assert sees('gap', WELL, dt=1.001)[0]


def test_stamps_stand_still_at_the_third_repeat_and_one_that_moves_begins_anew():
    memory, told = (0.0,), []
    for dt in (0.0, 0.0, 0.1, 0.0, 0.0, 0.0, -1.0):
        condition, memory = sees('clock', WELL, dt=dt, memory=memory)
        told.append(condition)
    assert told == [False, False, False, False, False, True, True]
    assert sees('clock', WELL, before=None, dt=0.0) == (False, (0.0,))


def test_another_cell_is_five_deviations_off_and_its_current_is_not_the_last_one():
    other = reading(current=-0.6)
    assert not sees('swapped', other, surprise=5.0)[0]
    assert sees('swapped', other, surprise=5.1)[0]
    assert not sees('swapped', reading(), surprise=5.1)[0]  # a meter that hangs
    assert sees('swapped', reading(), before=None, surprise=5.1)[0]


@pytest.mark.parametrize('held', ['voltage', 'current'])
def test_a_meter_hangs_that_repeats_one_number_for_five_seconds(held):
    """Of 0.25 s each: no step is rounded."""
    memory, told = (0.0, 0.0), []
    for turn in range(21):
        now = reading(voltage=3.8 + 0.01 * turn, current=-0.01 * turn)
        before = reading(voltage=3.7 + 0.01 * turn, current=-0.5)
        now, before = (
            reading(**{**{'voltage': one.voltage, 'current': one.current}, held: 1.0})
            for one in (now, before)
        )
        condition, memory = sees('frozen', now, before, dt=0.25, memory=memory)
        told.append(condition)
    assert told == [False] * 19 + [True] * 2
    assert sorted(memory) == [0.0, 5.25]
    assert sees('frozen', WELL, before=None, memory=memory) == (False, memory)
    assert sees('frozen', WELL, dt=0.0, memory=memory) == (False, memory)
    dropped = reading(voltage=0.05)
    assert sees('frozen', dropped, dropped, memory=memory) == (False, (0.0, 0.0))


def test_the_panel_s_meter_hangs_after_five_seconds_in_light_and_never_in_the_dark():
    bright = reading(panel_current=0.2)
    assert sees('panel frozen', bright, bright, dt=0.5, memory=(4.25,)) == (False, (4.75,))
    assert sees('panel frozen', bright, bright, dt=0.5, memory=(4.5,)) == (True, (5.0,))
    assert sees('panel frozen', bright, WELL, dt=0.5, memory=(4.5,)) == (False, (0.0,))
    assert sees('panel frozen', bright, None, dt=0.5, memory=(4.5,)) == (False, (4.5,))
    assert sees('panel frozen', bright, bright, dt=0.0, memory=(4.5,)) == (False, (4.5,))
    dark = reading(panel_current=0.01)
    assert sees('panel frozen', dark, dark, dt=0.5, memory=(4.5,)) == (False, (0.0,))


@pytest.mark.parametrize(
    ('current', 'panel_current', 'wrong'),
    [(0.25, 0.0, True), (0.0125, 0.0, False), (0.25, 0.25, False), (0.28, 0.25, True)],
)
def test_a_cell_takes_no_more_than_the_panel_gives_and_a_twentieth_of_a_watt(
    current, panel_current, wrong
):
    """4 V times each: 1 W, 0.05 W, 1 W of 1 W, and 1.12 W of 1 W."""
    now = reading(voltage=4.0, current=current, panel_voltage=4.0, panel_current=panel_current)
    assert sees('reversed current', now, before=None)[0] is wrong
    unknown = reading(voltage=4.0, current=1.0, panel_current=math.nan)
    assert not sees('reversed current', unknown, before=None)[0]


def test_the_changes_of_current_and_voltage_are_summed_and_fade_in_ten_seconds():
    """A step of 0.2 A down and 0.03 V up, 0.5 s after: -0.15 ohm, the cell's with its sign."""
    now, before = reading(current=-0.7, voltage=3.83), reading(current=-0.5, voltage=3.8)
    condition, memory = sees('reversed current', now, before, dt=0.5, memory=(0.01, 0.001))
    kept = math.exp(-0.05)
    squares, products = kept * 0.01 + 0.04, kept * 0.001 - 0.2 * 0.03
    assert memory == (pytest.approx(squares), pytest.approx(products))
    assert condition  # the slope is about -0.1 ohm, below half of -0.15
    assert products / squares < -0.075


@pytest.mark.parametrize(
    ('squares', 'products', 'wrong'),
    [(0.1, -0.0076, True), (0.1, -0.0074, False), (0.02, -0.01, False), (0.021, -0.01, True)],
)
def test_a_slope_below_half_of_the_resistance_is_wrong_where_enough_has_changed(
    squares, products, wrong
):
    memory = (squares, products)
    assert sees('reversed current', WELL, before=None, memory=memory) == (wrong, memory)


def test_a_reading_in_which_a_grave_fault_is_found_is_no_other_cell():
    jump = MeterObservation(reading(voltage=5.0, current=-0.6), WELL, 0.1, CELL, surprise=20.0)
    watch = update_detectors(DetectorStates(), jump)
    seen = dict(zip(BY_NAME, watch.seen, strict=True))
    assert (seen['implausible'], seen['swapped']) == (True, False)
    assert watch.is_unusable
    assert not watch.is_doubtful  # it must last 0.3 s
    other = update_detectors(
        DetectorStates(), jump._replace(reading=reading(voltage=4.0, current=-0.6))
    )
    assert dict(zip(BY_NAME, other.seen, strict=True))['swapped']
