"""The texts of energy alarms, and the initial values."""

from dataclasses import replace
import math

from lta_config.schema.vehicle_file import load_vehicle_file
from lta_energy.faults.protocol import Seen
from lta_energy.faults.watch import watched
from lta_energy.monitoring import alarms
from lta_energy.monitoring.aboard import Aboard
from lta_energy.monitoring.belief import Belief
from lta_energy.monitoring.books import Books, enter
from lta_energy.monitoring.estimate import Estimate
from lta_energy.monitoring.latch import Latch
from lta_energy.monitoring.load import Load
from lta_energy.monitoring.monitor import MonitorSettings
from lta_energy.monitoring.reading import Reading, Whereabouts
from lta_energy.monitoring.reserve import Stock
from lta_graph.health import Level
from lta_model.electrical.battery import Battery
from lta_model.electrical.power_path import Charger
import pytest

SETTINGS = MonitorSettings()
CELL = Battery(capacity=900.0, resistance=0.15)
NONE = (0.0,) * 5
HALF = Belief((0.5, 0.0, 1.0, 1.0, 0.0), ((0.0004, 0.0, 0.0, 0.0, 0.0), NONE, NONE, NONE, NONE))
READ = Reading(0, 3.8, -0.5, 4.4, 0.0, 200.0, Whereabouts(12.34, 0.5))
WELL = Estimate(
    belief=HALF, load=Load(1.0, 1.0, 0.02, 5.0), stock=Stock(0.48, 0.012, 700.4), reserve=False,
    last=READ,
)  # fmt: skip


def said(**changed):
    return alarms.battery(SETTINGS, CELL, WELL._replace(**changed))


def test_how_long_it_lasts_and_how_sure_that_is():
    """
    Half of 900 C holds 1675.1 J, 28 minutes of 1 W.

    Its deviation is that of 2 % of the charge at 3.84 V, 69.1 s, and of the power, 0.1 W as half
    of the variance is left: 167.5 s. Together 181.2 s, which are told as four minutes.
    """
    assert said() == (Level.OK, '50% +- 2% left, 28 +- 4 min at this power')
    full = WELL._replace(load=Load(-1.0, -1.0, 0.0, 5.0))
    # 1797.3 J are missing; 69.1 s are told as two minutes.
    assert alarms.battery(SETTINGS, CELL, full) == (
        Level.OK, '50% +- 2% left, full in 30 +- 2 min',
    )  # fmt: skip
    for watts, words in ((0.0047, 'min at this power'), (0.0046, ''), (-0.0049, '')):
        told = said(load=Load(watts, watts, 0.0, 5.0))[1]
        assert told.endswith(words or '2% left')


def test_what_is_worst_is_said_first():
    low = {'low': True, 'reserve': True}
    assert said(**low) == (
        Level.WARN, 'reserve reached: 50% +- 2% left, reserve 25%, way home 1.2%',
    )  # fmt: skip
    assert said(reserve=True) == (
        Level.WARN, 'the charge is doubtful: 50% +- 2%; the reserve counts as reached',
    )  # fmt: skip
    critical = {'critical': Latch(True, 0.0), **low}
    assert said(**critical) == (Level.ERROR, 'the battery gives only 3.80 V: land now')
    dead = watched(WELL.watch, Seen(replace(READ, voltage=0.0), READ, 0.1, CELL))
    assert said(watch=dead, **critical)[1].startswith('the cell reads 0.00 V: a brown-out')
    gap = watched(WELL.watch, Seen(READ, READ, 2.0, CELL))
    assert said(watch=gap)[0] is Level.OK  # a warning about meters is not one about the battery
    assert alarms.meters(WELL._replace(watch=gap)) == (
        Level.WARN, 'gap: more than 1 s passed without a reading: the charge is less certain',
    )  # fmt: skip
    for missing in ('belief', 'last', 'stock'):
        assert said(**{missing: None})[0] is Level.ERROR


def test_the_way_home_is_told_with_what_is_to_spare():
    told = alarms.way(WELL)
    assert told == (Level.OK, 'home is 12.3 m away, 700 J to spare')
    even = WELL._replace(stock=Stock(0.48, 0.012, 0.0))
    assert alarms.way(even) == (Level.WARN, 'home is 12.3 m away, 0 J to spare')
    for unknown in (
        {'stock': None}, {'last': None}, {'last': replace(READ, where=None)},
    ):  # fmt: skip
        assert alarms.way(WELL._replace(**unknown)) == (
            Level.OK, 'where the drone is, is not known; the way home counts as none',
        )  # fmt: skip


def test_at_first_nothing_is_known_and_the_reserve_counts_as_reached():
    none = Estimate()
    assert (none.reserve, none.urgent, none.low, none.critical) == (True, True, False, (False, 0))
    assert (none.gap, none.behind, none.books) == (0.0, (), Books(0.0, 0.0, 0.0, 0.0))
    assert math.isnan(none.charge)
    assert math.isnan(none.deviation)
    assert not none.watch.faults
    assert WELL.urgent is False
    assert (WELL.charge, WELL.deviation) == (0.5, pytest.approx(0.02))


def test_what_is_aboard_is_what_the_file_says():
    energy = load_vehicle_file('gtmab').energy
    assert Aboard.of(energy) == (Battery.of(energy), Charger.of(energy))


def test_the_charger_takes_its_own_and_gives_nothing_in_the_dark():
    """The charger gives 1 W * 0.85 - 22 mW, measured behind the MPPT."""
    aboard = Aboard(CELL, Charger(tracking=0.95, conversion=0.85, idle=0.022))
    given = [aboard.given(watts) for watts in (1.0, 0.02, -1.0, math.nan, math.inf)]
    assert given == [pytest.approx(0.828), 0.0, 0.0, 0.0, 0.0]


def test_the_books_entry_by_entry():
    books = enter(Books(1.0, 2.0, 3.0, 4.0), 0.5, 1.5, 0.25, -6.0, 10.0)
    assert books == Books(6.0, 17.0, 5.5, -2.0)
    assert books.imbalance == pytest.approx(6.0 - 17.0 - 5.5 + 2.0)


def test_what_a_meter_can_read_ends_at_a_hundred():
    assert Reading(0, 100.0, -100.0).usable
    assert Reading(0, -100.0, 100.0).usable
    for volts, amperes in ((100.1, 0.0), (0.0, 100.1), (math.nan, 0.0), (0.0, -math.inf)):
        assert not Reading(0, volts, amperes).usable
        assert Reading(0, 3.8, 0.1, volts, amperes).income == 0.0
    assert Reading(0, 3.8, 0.1, 100.0, 100.0).income == 10_000.0
    told = Reading(0, 3.8, -0.5, 4.0, 0.25)
    assert (told.power, told.harvest, told.income) == (pytest.approx(-1.9), 1.0, 1.0)
    assert math.isnan(Reading(0, 3.8, -0.5).harvest)
