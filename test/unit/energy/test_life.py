# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""What a mission remembers and passes to a schedule, step by step under a constant light."""

import math

from lta_config.schema.vehicle_file import load_vehicle_file
from lta_energy.circuit import ChargeGauge, EnergyTotals, NO_ENERGY, step_circuit, update_gauge
from lta_energy.irradiance import IrradianceSeries
from lta_energy.mission import (
    ALOFT,
    ASLEEP,
    AWAY,
    EMPTY,
    Landing,
    MissionFlight,
    MissionSimulation,
    PerchConfig,
    PERCHED,
)
from lta_energy.schedule import ScheduleDecision
from lta_model.electrical.battery import BatteryModel
from lta_model.electrical.mppt_charger import ChargerModel, resting_flow
import numpy as np
import pytest

ENERGY = load_vehicle_file('gtmab').energy
CELL, CHARGER = BatteryModel.from_energy(ENERGY), ChargerModel.from_energy(ENERGY)
UPKEEP = PerchConfig(
    CELL, CHARGER, lambda light: 0.001 * light.sun, 0.097, 0.006, (0.0, 86400.0), 0.25, 0.6,
    3600.0, gain=1.1, offset=0.002,
)  # fmt: skip


def light(minutes=200, sun=0.0, clear=0.0, beacon=0.0):
    day = np.ones(1440)
    return IrradianceSeries(
        sun * day[:minutes],
        0 * day[:minutes],
        beacon * day,
        0.5,
        clear * day,
        0.8,
        (1.0, 1.0, 1.0),
    )


def lived(wishes, fly=None, upkeep=UPKEEP, **of_light):
    """Follow the wishes, then sleep to the end; return the diary, the inputs and each end."""
    seen, left, ends = [], iter(wishes), []

    def schedule(known):
        seen.append(known)
        wish = next(left, None)
        return ScheduleDecision(False, math.inf, True) if wish is None else wish(known)

    life = MissionSimulation(upkeep, light(**of_light), schedule, fly, (180.0, 100.0))
    return life.run(ends.append), seen, ends


def fly(known):
    return ScheduleDecision(True)


def rest(seconds, asleep=True):
    return lambda known: ScheduleDecision(False, known.time + seconds, asleep)


def flights(*rows):
    """Return a pilot whose flights have these energies [J], durations [s] and outcomes."""
    left = iter(rows)

    def fly(departure):
        consumed, duration, ending = next(left)
        spent = EnergyTotals(1.0, 0.0, consumed, 0.5)
        flight = MissionFlight(
            departure.time, duration, 0, 0.0, spent, 0.6, 0.56, 0.7, 3.8, ending
        )
        return Landing(departure.store, flight)

    return fly


def test_what_is_known_before_the_first_flight():
    _, (first, *_), _ = lived([])
    assert first[:2] == (0.0, ChargeGauge(0.6, 0.05))
    assert first.seen == 1.0
    assert first[6:] == (0.097, 0.006, (0.0, 86400.0), 0.25, 180.0, pytest.approx(18.0), 100.0,
                         -math.inf, 0.0)  # fmt: skip


def test_a_flight_is_taken_to_need_what_the_last_twenty_that_came_home_did():
    rows = [(100.0 + 2.0 * k, 100.0 - k, 'home') for k in range(24)]
    rows[2] = (900.0, 300.0, 'lost')
    _, seen, _ = lived([fly] * 24, flights(*rows))
    # One flight tells no spread: a twentieth of what it took, harvest and heat included.
    assert seen[1][10:] == (99.5, pytest.approx(0.05 * 99.5), 100.0, 100.0, 100.0)
    needs = np.array([99.5 + 2.0 * k for k in range(24) if k != 2][-20:])
    told = seen[24]
    assert (told.need, told.spread) == pytest.approx((needs.mean(), needs.std()))
    assert told.flight == 100.0 - 4  # the longest of those twenty
    assert told.lasted == 77.0
    # The third was fetched an hour after it had ended; the newest ends now.
    assert told.landed == told.time == sum(row[1] for row in rows) + 3600.0


def test_a_flight_makes_the_charge_less_sure_by_its_meter():
    _, seen, _ = lived([fly], flights((100.0, 100.0, 'home')))
    assert seen[1].gauge == (0.7, pytest.approx(0.05 + 0.04 * 0.003))


@pytest.mark.parametrize(('asleep', 'watts'), [(True, 0.006), (False, 0.097)])
def test_a_rest_draws_what_it_takes_in_steps_of_half_a_minute(asleep, watts):
    diary, seen, _ = lived([rest(75.0, asleep)], sun=50.0)
    store, gauge, spent = resting_flow(0.6), ChargeGauge(0.6, 0.05), NO_ENERGY
    for dt in (30.0, 30.0, 15.0):
        store, spent = step_circuit(CELL, CHARGER, store, spent, 0.05, watts, dt)
        gauge = update_gauge(CELL, gauge, store.voltage, 1.1 * store.current + 0.002, dt)
    assert seen[1].gauge == pytest.approx(gauge, rel=1e-12)
    assert diary.state[0] == (ASLEEP if asleep else PERCHED)
    assert diary.charge[1] == pytest.approx(store.charge, rel=1e-3)
    assert diary.spent.consumed == pytest.approx(75.0 * watts + (12000.0 - 75.0) * 0.006)
    assert diary.spent.harvested == pytest.approx(0.05 * 0.95 * 12000.0)


@pytest.mark.parametrize(('clear', 'looks'), [(100.0, 1), (1.25, 0), (1.26, 1)])
def test_the_sky_is_compared_with_what_was_to_be_expected_over_an_hour(clear, looks):
    """
    Half of clear-sky light is compared with the expected 0.8; up to 1 W/m2 nothing is learnt.
    """
    _, seen, _ = lived([rest(60.0)], sun=0.5 * clear, clear=clear)
    expected = 1.0
    for _ in range(2 * looks):
        expected += (0.5 / 0.8 - expected) * 30.0 / 3600.0
    assert seen[1].seen == pytest.approx(expected)


def test_the_trace_of_a_rest_and_of_a_flight():
    diary, _, _ = lived(
        [rest(200.0), rest(60.0, asleep=False), fly], flights((1.0, 100.0, 'home'))
    )
    trace = list(zip(diary.time, diary.state, strict=True))
    assert trace[:8] == [
        (0.0, ASLEEP), (60.0, ASLEEP), (120.0, ASLEEP), (180.0, ASLEEP), (200.0, PERCHED),
        (260.0, ALOFT), (360.0, ALOFT), (360.0, ASLEEP),
    ]  # fmt: skip


def test_one_that_did_not_come_home_lies_until_it_is_fetched_or_the_days_are_over():
    diary, seen, _ = lived(
        [fly, fly], flights((1.0, 100.0, 'lost'), (1.0, 100.0, 'lost')), minutes=100
    )
    assert seen[1].time == 3700.0
    trace = zip(diary.time, diary.state, strict=True)
    away = [time for time, state in trace if state == AWAY]
    assert away == [100.0, 3700.0, 3800.0, 6000.0]
    assert len(seen) == 2


def test_a_cell_that_goes_out_is_counted_once_and_draws_nothing_until_light_has_charged_it():
    upkeep = PerchConfig(
        **{name: getattr(UPKEEP, name) for name in UPKEEP.__slots__} | {'charge': 0.002}
    )
    hungry = [rest(600.0, asleep=False)]
    diary, seen, _ = lived(hungry, upkeep=upkeep)
    assert diary.outages == 1
    assert diary.state[-1] == EMPTY
    assert diary.spent.consumed < 0.002 * 900.0 * 4.2
    assert seen[1].time < 600.0  # it did not rest on as it had wished
    diary, seen, _ = lived(hungry * 100, upkeep=upkeep, sun=1000.0)
    assert diary.outages == 0
