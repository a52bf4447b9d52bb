# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""A mission over days with flights that cost what the test says: schedules, books, failures."""

from dataclasses import replace
from itertools import pairwise
import math

from lta_config.schema.mission_file import DAY, load_light_day
from lta_config.schema.vehicle_file import load_vehicle_file
from lta_energy import mission
from lta_energy.circuit import ChargeGauge, NO_ENERGY, step_circuit
from lta_energy.harvest import HarvestCurve
from lta_energy.irradiance import simulate_irradiance
from lta_energy.mission import (
    Landing,
    MissionFlight,
    MissionSimulation,
    PerchConfig,
)
from lta_energy.schedule import (
    build_fixed_schedule,
    forecast_charge,
    is_within_working_hours,
    schedule_by_light,
    ScheduleInputs,
)
from lta_model.electrical.battery import BatteryModel
from lta_model.electrical.mppt_charger import charger_output, ChargerModel
import pytest

ENERGY = load_vehicle_file('gtmab').energy
CELL, CHARGER, HARVEST = (
    BatteryModel.from_energy(ENERGY),
    ChargerModel.from_energy(ENERGY),
    HarvestCurve.of_energy(ENERGY),
)
HOUR = 3600.0
SPRING, SUMMER, DOCK = (
    load_light_day(name) for name in ('greenhouse_spring', 'greenhouse_summer', 'warehouse_dock')
)
UPKEEP = PerchConfig(
    CELL, CHARGER, HARVEST, 0.097, 0.006, (7.0 * HOUR, 18.0 * HOUR), 0.25, 0.6, HOUR
)


def flown(departure, watts=1.8, seconds=100.0, ending='home'):
    """Fly at constant power, as a mission never does."""
    store, spent = departure.store, NO_ENERGY
    for _ in range(round(seconds)):
        store, spent = step_circuit(CELL, CHARGER, store, spent, 0.0, watts, 1.0)
    told = departure.told - departure.store.charge + store.charge
    return Landing(
        store,
        MissionFlight(
            departure.time, seconds, 2, 40.0, spent, departure.store.charge, store.charge, told,
            store.voltage, ending,
        ),
    )  # fmt: skip


def lived(day, schedule, *, upkeep=UPKEEP, days=1, seed=1, fly=flown):
    return MissionSimulation(
        upkeep, simulate_irradiance(day, days, seed), schedule, fly, (180.0, 100.0)
    ).run()


def coming(light):
    return charger_output(CHARGER, HARVEST(light))


def known(**change):
    """Return what a schedule sees at noon of a spring day with a cell three quarters full."""
    at_noon = ScheduleInputs(
        12 * HOUR, ChargeGauge(0.75, 0.01), CELL, coming, simulate_irradiance(SPRING, 1, 1), 1.0,
        0.097, 0.006, (7 * HOUR, 18 * HOUR), 0.25, 180.0, 10.0, 100.0, 11.0 * HOUR, 100.0,
    )  # fmt: skip
    return at_noon._replace(**change)


@pytest.mark.parametrize('schedule', [schedule_by_light, build_fixed_schedule(4.0)])
@pytest.mark.parametrize('day', [SPRING, SUMMER, DOCK])
def test_the_books_balance(day, schedule):
    diary = lived(day, schedule, days=2)
    assert len(diary.flights) > 10
    assert abs(diary.imbalance) < 1e-3
    assert diary.spent.harvested > 3e3


def test_the_logged_powers_integrate_to_the_books():
    diary = lived(SPRING, schedule_by_light, days=2)
    lasted = [b - a for a, b in pairwise(diary.time)]
    for name in ('harvested', 'consumed', 'lost'):
        powers = getattr(diary, name)
        assert len(powers) == len(diary.time)
        energy = sum(dt * watts for dt, watts in zip(lasted, powers[1:], strict=True))
        assert energy == pytest.approx(getattr(diary.spent, name), rel=1e-9)


def test_ours_flies_more_of_a_summer_day_and_wastes_less():
    ours, naive = lived(SUMMER, schedule_by_light), lived(SUMMER, build_fixed_schedule(4.0))
    assert len(ours.flights) > 1.2 * len(naive.flights)
    assert ours.spent.curtailed < 0.5 * naive.spent.curtailed
    assert ours.failure_count <= naive.failure_count == 0
    assert min(ours.charge) > 0.2


def test_all_are_home_before_work_ends_and_the_night_leaves_something():
    for schedule in (schedule_by_light, build_fixed_schedule(4.0)):
        diary = lived(SPRING, schedule, days=3)
        for flight in diary.flights:
            begin = flight.start % DAY
            assert begin >= 7 * HOUR
            assert begin + flight.duration <= 18 * HOUR
        assert diary.dark == diary.outages == 0


@pytest.mark.parametrize(
    ('work', 'hours'), [((0, 24), 24), ((6, 5.95), 23.95), ((0, 23.9), 23.9), ((22, 6), 8)]
)
def test_the_forecast_ends_with_work_however_short_the_break(work, hours):
    begin = DAY + work[0] * HOUR  # work that begins now
    shift = known(time=begin, work=(work[0] * HOUR, work[1] * HOUR), flight=120.0)
    looked = []

    def income(light):
        looked.append(light)
        assert len(looked) < 1000, 'it looks on for ever'
        return shift.asleep

    forecast_charge(shift._replace(income=income))
    assert len(looked) * 600.0 == pytest.approx(hours * HOUR, abs=600.0)
    schedule_by_light(shift)


def test_work_round_the_clock_is_flown_by_day_and_by_night():
    upkeep = replace(UPKEEP, work=(0.0, DAY))
    starts = [
        flight.start for flight in lived(DOCK, schedule_by_light, upkeep=upkeep, days=2).flights
    ]
    assert min(starts) < 2 * HOUR
    assert max(starts) > 2 * DAY - 2 * HOUR


def test_a_flight_in_light_that_makes_the_drone_too_light_stays_on_the_perch():
    """The naive schedule of a summer day: it flies while the sun is weak, and counts the rest."""
    light = simulate_irradiance(SUMMER, 1, 1)
    starts, diaries = {}, {}
    for brightest in (math.inf, 100.0):
        upkeep, guess = replace(UPKEEP, brightest=brightest), (180.0, 100.0)
        simulation = MissionSimulation(upkeep, light, build_fixed_schedule(4.0), flown, guess)
        diaries[brightest] = simulation.run()
        starts[brightest] = [each.start for each in diaries[brightest].flights]
    assert diaries[math.inf].grounded == 0
    assert all(light.at(start).sun <= 100.0 for start in starts[100.0])
    assert any(light.at(start).sun > 100.0 for start in starts[math.inf])
    dimmer = [start for start in starts[math.inf] if light.at(start).sun <= 100.0]
    # What is not flown charges the cell, so that more is flown in dim light
    assert len(starts[100.0]) >= len(dimmer)
    assert diaries[100.0].grounded > 0
    assert abs(diaries[100.0].imbalance) < 1e-9


def test_an_idle_drone_that_never_sleeps_goes_out_in_the_night():
    """97 mW for ten hours of night are more than a full cell holds."""
    awake = PerchConfig(CELL, CHARGER, HARVEST, 0.097, 0.097, UPKEEP.work, 0.25, 0.9, HOUR)
    diary = lived(SPRING, schedule_by_light, upkeep=awake, days=2)
    assert diary.outages >= 1
    assert diary.failure_count >= 1
    assert abs(diary.imbalance) < 1e-3


@pytest.mark.long
def test_steps_of_half_a_minute_are_as_good_as_of_a_second(monkeypatch):
    """A day on the perch in the light of clouds, without flights."""
    upkeep = PerchConfig(CELL, CHARGER, HARVEST, 0.097, 0.006, (0.0, 0.0), 0.25, 0.3, HOUR)
    coarse = lived(SPRING, schedule_by_light, upkeep=upkeep)
    monkeypatch.setattr(mission, 'PERCH_STEP', 1.0)
    fine = lived(SPRING, schedule_by_light, upkeep=upkeep)
    assert coarse.charge[-1] == pytest.approx(fine.charge[-1], abs=2e-4)
    assert coarse.spent.harvested == pytest.approx(fine.spent.harvested, rel=1e-3)


def test_the_gauge_stays_near_the_truth_without_seeing_it():
    upkeep = PerchConfig(
        CELL,
        CHARGER,
        HARVEST,
        0.097,
        0.006,
        UPKEEP.work,
        0.25,
        0.6,
        HOUR,
        gain=1.002,
        offset=-4e-4,
    )
    diary = lived(SPRING, build_fixed_schedule(4.0), upkeep=upkeep, days=3)
    off = [abs(a - b) for a, b in zip(diary.charge, diary.told, strict=True)]
    assert max(off) < 0.05
    inside = [o <= 2.0 * d for o, d in zip(off, diary.deviation, strict=True)]
    assert sum(inside) > 0.95 * len(inside)
    assert max(diary.deviation) < 0.1


@pytest.mark.parametrize(
    ('work', 'hours', 'fits'),
    [
        ((7.0, 18.0), (6.99, 7.0, 17.8, 17.84, 24.0 + 12.0), (0, 1, 1, 0, 1)),
        ((22.0, 4.0), (21.99, 22.0, 23.9, 0.0, 3.8, 3.84, 12.0), (0, 1, 1, 1, 1, 0, 0)),
    ],
)
def test_a_flight_is_back_within_the_hours_of_work_with_half_of_it_to_spare(work, hours, fits):
    """400 s take 600 s, a sixth of an hour; work may go on over midnight."""
    hired = known(work=(work[0] * HOUR, work[1] * HOUR), flight=400.0)
    assert [is_within_working_hours(hired._replace(time=hour * HOUR)) for hour in hours] == list(
        map(bool, fits)
    )
