# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The light of days: sun by hand, clouds by their law, lamps by their timers."""

import dataclasses
import math

from lta_config.schema.mission_file import load_light_day
from lta_config.schema.spectrum_file import luminous_efficacy
from lta_energy.irradiance import (
    lamp_irradiance,
    MINUTES,
    simulate_cloud_transmittance,
    simulate_irradiance,
    solar_elevation_sine,
)
import numpy as np
import pytest

SPRING = load_light_day('greenhouse_spring')
DOCK = load_light_day('warehouse_dock')
LED = luminous_efficacy('white_led')
HOUR = 3600.0


def test_the_sun_stands_where_the_almanac_has_it():
    """At 52 degrees: 38 at noon of the equinox, 61.4 at midsummer's, rising at 6 and 3:45."""
    latitude = math.radians(52.0)
    noon = np.array([12.0 * HOUR])
    assert np.degrees(np.arcsin(solar_elevation_sine(latitude, 81, noon)))[0] == pytest.approx(
        38.0, abs=0.1
    )
    assert np.degrees(np.arcsin(solar_elevation_sine(latitude, 172, noon)))[0] == pytest.approx(
        61.45, abs=0.1
    )
    assert solar_elevation_sine(latitude, 81, np.array([6.0 * HOUR]))[0] == pytest.approx(
        0.0, abs=1e-3
    )
    rise = math.acos(-math.tan(latitude) * math.tan(math.radians(23.45)))
    early = np.array([(12.0 - math.degrees(rise) / 15.0) * HOUR])
    assert solar_elevation_sine(latitude, 172, early)[0] == pytest.approx(0.0, abs=1e-4)


def test_clouds_cover_what_the_file_says_and_let_through_what_it_says():
    chance = np.random.default_rng(4)
    days = np.array([simulate_cloud_transmittance(SPRING.sun.clouds, chance) for _ in range(400)])
    clouded = days < 1.0
    assert clouded.mean() == pytest.approx(0.5, abs=0.03)
    assert days[clouded].min() >= 0.2
    assert days[clouded].max() <= 0.5
    assert days.mean() == pytest.approx(simulate_irradiance(SPRING, 1, 1).mean, abs=0.02)


def test_lamps_burn_by_their_timers_over_midnight_too():
    light = simulate_irradiance(DOCK, 1, 1)
    assert light.at(4.9 * HOUR) == (0.0, 0.0, 0.0, 0.5)
    assert light.at(5.1 * HOUR) == (0.0, 0.0, pytest.approx(80e3 / LED), 0.5)
    assert light.at(12.0 * HOUR).lamps == pytest.approx(300.0 / LED)
    assert light.illuminance()[12 * 60] == pytest.approx(300.0 + 40e3)
    hours = DOCK.lamps['beacon'].hours.model_copy(update={'value': (23.0, 5.0)})
    lamp = DOCK.lamps['beacon'].model_copy(update={'hours': hours})
    night = simulate_irradiance(DOCK.model_copy(update={'lamps': {'beacon': lamp}}), 1, 1)
    assert [night.at(hour * HOUR).beacon > 0.0 for hour in (0.5, 4.9, 5.1, 22.9, 23.1)] == [
        True, True, False, False, True,
    ]  # fmt: skip


@pytest.mark.parametrize(
    ('hours', 'lit'),
    [((5.0, 22.0), [False, True, True, False]), ((22.0, 5.0), [True, False, False, True])],
)
def test_a_timer_switches_at_the_second(hours, lit):
    lamp = DOCK.lamps['beacon']
    told = lamp.hours.model_copy(update={'value': hours})
    lamp = lamp.model_copy(update={'hours': told})
    times = np.array([5.0 * HOUR - 1.0, 5.0 * HOUR, 22.0 * HOUR - 1.0, 22.0 * HOUR])
    assert (lamp_irradiance(lamp, times) > 0.0).tolist() == lit
    assert (lamp_irradiance(lamp, times + 24.0 * HOUR) > 0.0).tolist() == lit


def test_lux_are_watts_by_the_efficacy_of_each_and_a_beacon_counts_by_its_duty():
    light = simulate_irradiance(DOCK, 1, 1)
    ones = np.ones(1440)
    even = dataclasses.replace(
        light, sun=ones, lamps=ones, beacon=ones, duty=0.25, efficacies=(110.0, 300.0, 200.0)
    )
    assert even.illuminance().tolist() == [460.0] * 1440
    assert (light.mean, light.duty, light.efficacies) == (1.0, 0.5, (1.0, LED, LED))
    spring = simulate_irradiance(SPRING, 1, 1)
    # Half of the sky, of which 35 % comes through: 1 - 0.5 * 0.65.
    assert spring.mean == pytest.approx(0.675)
    assert (spring.duty, spring.efficacies) == (1.0, (luminous_efficacy('sun'), 1.0, 1.0))


def test_a_day_without_clouds_is_clear_and_an_overcast_one_has_no_gap():
    clouds = SPRING.sun.clouds
    for cover, clear in (((0.0, 0.0), True), ((100.0, 100.0), False)):
        told = clouds.cover.model_copy(update={'value': cover})
        share = simulate_cloud_transmittance(
            clouds.model_copy(update={'cover': told}), np.random.default_rng(1)
        )
        assert len(share) == MINUTES
        assert (share == 1.0).all() == clear
        assert clear or share.max() <= 0.5


def test_clouds_are_as_long_as_the_file_says_and_may_be_there_at_midnight():
    """Clouds of 12 min over 25 % of the day are 30 a day; one in 24 falls between two samples."""
    cover = SPRING.sun.clouds.cover.model_copy(update={'value': (25.0, 25.0)})
    clouds, chance = (
        SPRING.sun.clouds.model_copy(update={'cover': cover}),
        np.random.default_rng(5),
    )
    days = np.array([simulate_cloud_transmittance(clouds, chance) for _ in range(400)])
    assert (days < 1.0).mean() == pytest.approx(0.25, abs=0.015)
    assert (days[:, 0] < 1.0).mean() == pytest.approx(0.25, abs=0.07)
    assert (days[:, -1] < 1.0).mean() == pytest.approx(0.25, abs=0.07)
    each = [len(np.unique(day[day < 1.0])) for day in days]
    assert np.mean(each) == pytest.approx(30.0 * 23.0 / 24.0, abs=1.0)
