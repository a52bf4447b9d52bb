"""Readings in order after their clock was set back."""

from lta_energy.monitoring.meters import MeterReading
from lta_energy.monitoring.monitor import (
    append_stamp,
    EnergyEstimate,
    NEW_CLOCK_READINGS,
    shift_stamps,
)
import pytest


@pytest.mark.parametrize(
    ('before', 'stamp', 'after'),
    [
        ((), 5, (5,)),
        ((5,), 6, (5, 6)),
        ((5,), 5, (5,)),
        ((5, 6), 4, (4,)),
        ((3, 9), 7, (7,)),
        ((3, 6), 7, (3, 6, 7)),
    ],
)
def test_stamps_are_in_order_while_each_is_later(before, stamp, after):
    assert append_stamp(before, stamp) == after
    assert NEW_CLOCK_READINGS == 3


def test_what_was_read_is_moved_to_the_new_clock_and_stays_one_reading():
    last, good = MeterReading(1000, 3.8, -0.5), MeterReading(900, 3.8, -0.4)
    both = shift_stamps(EnergyEstimate(last=last, good=last), 700)
    assert (both.last.stamp_ns, both.last.current) == (300, -0.5)
    assert both.good is both.last
    apart = shift_stamps(EnergyEstimate(last=last, good=good), 700)
    assert (apart.last.stamp_ns, apart.good.stamp_ns) == (300, 200)
    assert (apart.last.current, apart.good.current) == (-0.5, -0.4)
    assert shift_stamps(EnergyEstimate(), 700) == EnergyEstimate()
