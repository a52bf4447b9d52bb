# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The texts of energy alarms, and the initial values."""

from dataclasses import replace
import math

from lta_energy.monitoring.faults import Latch, MeterObservation, update_detectors
from lta_energy.monitoring.meters import (
    MeterReading,
    PowerSystem,
    TravelState,
)
from lta_energy.monitoring.monitor import EnergyEstimate, MonitorSettings
from lta_energy.monitoring.outlook import LoadEstimate, ReserveMargin
from lta_energy.monitoring.report import report_energy
from lta_energy.monitoring.soc_ekf import CellState
from lta_graph.health import HealthLevel
from lta_model.electrical.battery import BatteryModel
from lta_model.electrical.mppt_charger import ChargerModel
import pytest

SETTINGS = MonitorSettings()
CELL = BatteryModel(capacity=900.0, resistance=0.15)
NONE = (0.0,) * 5
HALF = CellState((0.5, 0.0, 1.0, 1.0, 0.0), ((0.0004, 0.0, 0.0, 0.0, 0.0), NONE, NONE, NONE, NONE))
READ = MeterReading(0, 3.8, -0.5, 4.4, 0.0, 200.0, TravelState(12.34, 0.5))
WELL = EnergyEstimate(
    belief=HALF, load=LoadEstimate(1.0, 1.0, 0.02, 5.0), stock=ReserveMargin(0.48, 0.012, 700.4),
    reserve=False, last=READ,
)  # fmt: skip


def said(**changed):
    return report_energy(SETTINGS, CELL, WELL._replace(**changed)).battery


def test_how_long_it_lasts_and_how_sure_that_is():
    """
    Half of 900 C holds 1675.1 J, 28 minutes of 1 W.

    Its deviation is that of 2 % of the charge at 3.84 V, 69.1 s, and of the power, 0.1 W as half
    of the variance is left: 167.5 s. Together 181.2 s, which are told as four minutes.
    """
    assert said() == (HealthLevel.OK, '50% +- 2% left, 28 +- 4 min at this power')
    full = WELL._replace(load=LoadEstimate(-1.0, -1.0, 0.0, 5.0))
    # 1797.3 J are missing; 69.1 s are told as two minutes.
    assert report_energy(SETTINGS, CELL, full).battery == (
        HealthLevel.OK, '50% +- 2% left, full in 30 +- 2 min',
    )  # fmt: skip
    for watts, words in ((0.0047, 'min at this power'), (0.0046, ''), (-0.0049, '')):
        told = said(load=LoadEstimate(watts, watts, 0.0, 5.0))[1]
        assert told.endswith(words or '2% left')


def test_what_is_worst_is_said_first():
    low = {'low': True, 'reserve': True}
    assert said(**low) == (
        HealthLevel.WARN,
        'energy reserve reached: 50% +- 2% of the charge left; reserve 25%, flight home 1.2%',
    )
    assert said(reserve=True) == (
        HealthLevel.WARN,
        'the estimated charge of 50% +- 2% is too uncertain, so the energy reserve counts as '
        'reached',
    )
    critical = {'critical': Latch(True, 0.0), **low}
    assert said(**critical) == (HealthLevel.ERROR, 'the battery voltage is only 3.80 V: land now')
    dead = update_detectors(
        WELL.watch, MeterObservation(replace(READ, voltage=0.0), READ, 0.1, CELL)
    )
    assert said(watch=dead, **critical)[1].startswith('the power meter reads 0.00 V')
    gap = update_detectors(WELL.watch, MeterObservation(READ, READ, 2.0, CELL))
    assert (
        said(watch=gap)[0] is HealthLevel.OK
    )  # a warning about meters is not one about the battery
    assert report_energy(SETTINGS, CELL, WELL._replace(watch=gap)).meters == (
        HealthLevel.WARN,
        'gap: no battery reading for more than 1 s: the estimate of the charge is less certain',
    )
    for missing in ('belief', 'last', 'stock'):
        assert said(**{missing: None})[0] is HealthLevel.ERROR


def test_the_way_home_is_told_with_what_is_to_spare():
    told = report_energy(SETTINGS, CELL, WELL).way
    assert told == (
        HealthLevel.OK,
        'the start is 12.3 m away; energy beyond the flight home and the reserve: 700 J',
    )
    even = WELL._replace(stock=ReserveMargin(0.48, 0.012, 0.0))
    assert report_energy(SETTINGS, CELL, even).way == (
        HealthLevel.WARN,
        'the start is 12.3 m away; energy beyond the flight home and the reserve: 0 J',
    )
    for unknown in (
        {'stock': None}, {'last': None}, {'last': replace(READ, where=None)},
    ):  # fmt: skip
        assert report_energy(SETTINGS, CELL, WELL._replace(**unknown)).way == (
            HealthLevel.OK,
            'the position of the drone is unknown, so no energy is reserved for the flight home',
        )


def test_the_charger_takes_its_own_and_gives_nothing_in_the_dark():
    """The charger gives (1 W - 22 mW) * 0.85, measured behind the MPPT."""
    aboard = PowerSystem(CELL, ChargerModel(tracking=0.95, conversion=0.85, idle=0.022))
    given = [aboard.charger_output(watts) for watts in (1.0, 0.02, -1.0, math.nan, math.inf)]
    assert given == [pytest.approx(0.8313), 0.0, 0.0, 0.0, 0.0]


def test_what_a_meter_can_read_ends_at_a_hundred():
    assert MeterReading(0, 100.0, -100.0).is_usable
    assert MeterReading(0, -100.0, 100.0).is_usable
    for volts, amperes in ((100.1, 0.0), (0.0, 100.1), (math.nan, 0.0), (0.0, -math.inf)):
        assert not MeterReading(0, volts, amperes).is_usable
        assert MeterReading(0, 3.8, 0.1, volts, amperes).plausible_panel_power == 0.0
    assert MeterReading(0, 3.8, 0.1, 100.0, 100.0).plausible_panel_power == 10_000.0
    told = MeterReading(0, 3.8, -0.5, 4.0, 0.25)
    assert (told.cell_power, told.panel_power, told.plausible_panel_power) == (
        pytest.approx(-1.9),
        1.0,
        1.0,
    )
    assert math.isnan(MeterReading(0, 3.8, -0.5).panel_power)
