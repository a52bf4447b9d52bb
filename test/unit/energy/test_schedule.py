# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The inputs of the schedules under constant light."""

import math

from lta_energy.circuit import ChargeGauge
from lta_energy.irradiance import NO_IRRADIANCE
from lta_energy.schedule import (
    build_fixed_schedule,
    estimate_cell_energy,
    forecast_charge,
    is_flight_safe,
    next_work_end,
    next_work_start,
    night_energy,
    reserve_energy,
    schedule_by_light,
    ScheduleDecision,
    ScheduleInputs,
)
from lta_model.electrical.battery import BatteryModel, stored_energy
import pytest

HOUR = 3600.0
CELL = BatteryModel(capacity=9000.0, resistance=0.15)  # large: nothing fills it


class Lit:
    """Light of so many W/m2 of sun between two times, which the charger takes as watts."""

    def __init__(self, sun, begin=0.0, end=math.inf):
        self.sun, self.begin, self.end = sun, begin, end

    def forecast_irradiance(self, time):
        return NO_IRRADIANCE._replace(sun=self.sun if self.begin <= time < self.end else 0.0)


def known(**change):
    at_nine = ScheduleInputs(
        9 * HOUR, ChargeGauge(0.5, 0.01), CELL, lambda light: light.sun, Lit(1.0), 1.0, 0.1, 0.25,
        (7 * HOUR, 18 * HOUR), 0.25, 200.0, 10.0, 400.0, 8.5 * HOUR, 300.0,
    )  # fmt: skip
    return at_nine._replace(**change)


@pytest.mark.parametrize(
    ('hour', 'begin', 'end'),
    [(6, 7, 18), (7, 31, 18), (8, 31, 18), (18, 31, 18), (19, 31, 42), (30, 31, 42), (31, 55, 42)],
)
def test_when_work_begins_and_ends_next(hour, begin, end):
    at = known(time=hour * HOUR)
    assert (next_work_start(at), next_work_end(at)) == (begin * HOUR, end * HOUR)


def test_a_flight_leaves_the_reserve_and_twice_what_is_not_sure():
    assert reserve_energy(known()) == pytest.approx(stored_energy(0.25 + 0.02, 9000.0))
    assert reserve_energy(known(gauge=ChargeGauge(0.5, 0.9))) == stored_energy(1.0, 9000.0)
    assert estimate_cell_energy(known()) == stored_energy(0.5, 9000.0)
    spare = stored_energy(0.5, 9000.0) - stored_energy(0.27, 9000.0)
    assert is_flight_safe(known(need=spare - 20.1))
    assert not is_flight_safe(known(need=spare - 19.9))
    all_of_it = known(
        gauge=ChargeGauge(0.5, 0.0), reserve=0.0, need=estimate_cell_energy(known()), spread=0.0
    )
    assert is_flight_safe(all_of_it)


@pytest.mark.parametrize('asleep', [False, True])
def test_the_naive_schedule_to_the_second(asleep):
    schedule = build_fixed_schedule(4.0, asleep=asleep)
    ready = 8.5 * HOUR + 4.0 * 300.0
    assert schedule(known(time=ready)) == ScheduleDecision(True, 0.0, False)
    assert schedule(known(time=ready - 1.0)) == ScheduleDecision(False, ready, asleep)
    assert schedule(known(need=1e6)) == ScheduleDecision(False, 9 * HOUR + 300.0, asleep)
    assert schedule(known(time=6 * HOUR)) == ScheduleDecision(False, 7 * HOUR, True)
    assert build_fixed_schedule(4.0)(known(need=1e6)).asleep is False
    with pytest.raises(TypeError):
        build_fixed_schedule(4.0, asleep)  # by its name alone: a bare True says nothing


def test_the_light_aware_schedule_to_the_second():
    assert schedule_by_light(known()) == ScheduleDecision(True, 0.0, False)
    assert schedule_by_light(known(need=1e6)) == ScheduleDecision(False, 9 * HOUR + 300.0, True)
    assert schedule_by_light(known(time=6 * HOUR)) == ScheduleDecision(False, 7 * HOUR, True)
    # Light for nothing but the sleep: what the flight takes must not be missed at dusk.
    even = known(light=Lit(0.25), gauge=ChargeGauge(0.5, 0.0), spread=0.0)
    spare = estimate_cell_energy(even) - reserve_energy(even)
    assert schedule_by_light(even._replace(need=spare - 1.0)).fly
    dark = even._replace(light=Lit(0.0), need=100.0)
    assert night_energy(dark) == pytest.approx(reserve_energy(dark) + 1.3 * DAY_ASLEEP)
    assert schedule_by_light(dark) == ScheduleDecision(False, 9 * HOUR + 300.0, True)


DAY_ASLEEP = 24 * HOUR * 0.25  # J


@pytest.mark.parametrize(('flight', 'steps'), [(0.0, 55), (400.0, 54), (399.0, 54), (401.0, 53)])
def test_the_forecast_goes_on_until_the_last_flight_of_the_day(flight, steps):
    """Steps of 600 s from nine to six, each of 0.5 W less 0.25 W; one and a half flights less."""
    full, energy = forecast_charge(known(flight=flight, light=Lit(0.5)))
    assert not full
    assert energy == pytest.approx(estimate_cell_energy(known()) + steps * 150.0)


def test_the_night_ends_with_the_light_that_feeds_the_sleep():
    """Dark from six to midnight: 36 steps of 150 J, and three tenths more."""
    dusk = known(light=Lit(0.25, begin=24 * HOUR))
    assert night_energy(dusk) == pytest.approx(reserve_energy(dusk) + 1.3 * 36 * 150.0)
    dim = known(light=Lit(0.24))
    assert night_energy(dim) == pytest.approx(reserve_energy(dim) + 1.3 * 144 * 6.0)
    assert night_energy(known(light=Lit(0.25))) == reserve_energy(known())
