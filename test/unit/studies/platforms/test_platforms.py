# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Platforms compared: figures of signals known in closed form, and every platform in flight."""

from functools import cache
import math

from lta_config.errors import BadInput
from lta_config.files import find_file, load_yaml
from lta_config.schema.comparison_file import EntryChange, load_comparison, load_maneuver_file
from lta_control import autopilot
from lta_flight.flight_spec import build_loop, load_spec
from lta_flight.sweep.statistics import student_interval
from lta_model.limits import level_speed
from lta_model.scenario import load_scenario
from lta_model.vehicle import load_vehicle
from lta_sim.readings import FlightOutcome
from lta_studies.platforms.flight import (
    build_entrant,
    compute_lift_margin,
    compute_tracking_metrics,
    fly_maneuver,
)
from lta_studies.reproduce.manoeuvres import build_entry, fly_entries, replace_speeds
import numpy as np
import pytest
import yaml

pytestmark = pytest.mark.usefixtures('plain_laws')
COMPARISON = load_comparison('platforms')
SCENARIO = load_scenario(COMPARISON.scenario)
DENSITY = SCENARIO.air.density
OTHERS = [pytest.param(name, marks=pytest.mark.long) for name in ('beavis', 'skye', 'multirotor')]


def changed(name, **change):
    """Return a contestant with something set."""
    given = EntryChange.model_validate(change) if change else None
    return build_entrant(COMPARISON.contestants[name], DENSITY, given)


def named(name):
    """Return an ablation or a limit of the file."""
    change = COMPARISON.ablations.get(name) or COMPARISON.limits[name]
    return build_entrant(COMPARISON.contestants[change.of], DENSITY, change)


@cache
def flown(name, manoeuvre, speed=None, ablation=False):
    who = named(name) if ablation else changed(name)
    return fly_maneuver(who, SCENARIO, replace_speeds(load_maneuver_file(manoeuvre), speed), 1)


def test_a_second_order_step_has_its_text_book_figures():
    """Overshoot exp(-pi z / sqrt(1 - z^2)); settled where the oscillation last leaves the band."""
    z, w = 0.3, 2.0
    wd, phase = w * math.sqrt(1 - z * z), math.acos(z)
    t = np.arange(0.0, 20.0, 0.001)
    y = 3.0 * (1 - np.exp(-z * w * t) / math.sqrt(1 - z * z) * np.sin(wd * t + phase))
    found = compute_tracking_metrics(t, np.full_like(t, 3.0), y, 0.06, 0.0)
    assert found.overshoot == pytest.approx(math.exp(-math.pi * z / math.sqrt(1 - z * z)), 1e-5)
    # Peaks at k pi / wd have the height exp(-z w t): the last above 2 % is the sixth, at 4.9 s.
    last = math.floor(-math.log(0.02) / (z * w) / (math.pi / wd))
    assert last * math.pi / wd < found.settling_time < (last + 1) * math.pi / wd
    assert found.held
    assert found.steady_error == pytest.approx(0.0, abs=1e-3)


def test_a_first_order_lag_follows_a_ramp_late_by_rate_times_time():
    t = np.arange(0.0, 40.0, 0.01)
    rate, lag = 0.5, 2.0
    y = rate * (t - lag * (1 - np.exp(-t / lag)))
    found = compute_tracking_metrics(t, rate * t, y, 1.1, 0.0)
    assert found.steady_error == pytest.approx(rate * lag, 1e-6)
    assert found.rms < rate * lag
    assert math.isnan(found.overshoot)
    assert found.settling_time == 0.0


def test_a_sine_that_never_dies_does_not_settle():
    t = np.arange(0.0, 40.0 * math.pi, 0.001)
    found = compute_tracking_metrics(t, np.zeros_like(t), 0.2 * np.cos(t), 0.1, 1.0)
    assert math.isnan(found.settling_time)
    assert not found.held
    assert found.rms == pytest.approx(0.2 / math.sqrt(2.0), 1e-4)
    assert found.ripple == pytest.approx(0.2 / math.sqrt(2.0), 1e-4)
    assert found.overshoot == pytest.approx(0.2, 1e-4)  # a step of 1 down to 0


def test_what_settles_in_the_last_quarter_is_not_held():
    t = np.arange(0.0, 100.0)
    late = compute_tracking_metrics(t, np.ones_like(t), np.where(t < 80.0, 0.0, 1.0), 0.1, 0.0)
    assert late.settling_time == 80.0
    assert not late.held


def test_no_number_is_no_success():
    t = np.arange(0.0, 10.0)
    found = compute_tracking_metrics(t, np.zeros_like(t), np.full_like(t, math.nan), 0.1, 0.0)
    assert not found.held


def test_means_have_student_s_interval():
    """Three numbers: t = 4.302653 at 2 degrees of freedom (tables)."""
    found = student_interval([1.0, 2.0, 3.0])
    assert found.value == 2.0
    assert found.high - found.value == pytest.approx(4.302653 / math.sqrt(3.0), 1e-6)
    assert math.isnan(student_interval([1.0]).high)


@pytest.mark.parametrize(
    ('name', 'error', 'overshoot'),
    [
        ('gtmab', 0.02, 0.2),
        ('beavis_paper', 0.02, 0.2),
        ('blimp2b_cascade', 0.02, 0.1),
        ('sblimp', 0.01, 0.05),
        ('skye', 0.1, 0.2),
        ('multirotor', 0.01, 0.05),
    ],
)
def test_every_platform_that_hovers_climbs_and_holds(name, error, overshoot):
    flight = flown(name, 'climb')
    assert flight.is_successful
    assert abs(flight.metrics.steady_error) < error
    assert flight.metrics.overshoot < overshoot


@pytest.mark.parametrize('name', ['gtmab', *OTHERS])
def test_they_turn_and_hold_heading(name):
    flight = flown(name, 'turn')
    assert flight.is_successful
    assert abs(flight.metrics.steady_error) < math.radians(2.0)


@pytest.mark.parametrize(
    'name', ['gtmab', pytest.param('sblimp', marks=pytest.mark.long), *OTHERS]
)
def test_they_cruise_at_half_a_metre_a_second(name):
    flight = flown(name, 'cruise')
    assert flight.is_successful
    assert abs(flight.metrics.steady_error) < 0.05


@pytest.mark.long
def test_a_heading_that_moves_is_followed_late_by_rate_over_gain():
    """GT-MAB: 6 deg/s by 0.6 per second is 10 degrees; it turns back thrice, so a little less."""
    flight = flown('gtmab', 'follow')
    assert flight.is_successful
    assert math.degrees(flight.metrics.rms) == pytest.approx(10.0, abs=1.5)


@pytest.mark.long
def test_the_glider_soars_but_does_not_hover():
    assert flown('rgblimp', 'soar').is_successful
    sunk = flown('rgblimp', 'climb')
    assert not sunk.is_successful
    assert sunk.metrics.steady_error > 1.5  # it has come down from its release


def test_open_loop_overshoots_and_closing_the_loop_reverses_it():
    """The seed paper: fails to follow, overshoots in altitude."""
    opened = flown('blimp2b', 'climb')
    assert not opened.is_successful
    assert opened.metrics.overshoot > 0.3
    assert flown('blimp2b_closed', 'climb', ablation=True).is_successful


@pytest.mark.long
def test_open_loop_comes_near_the_published_steady_surge_and_turns_over():
    """0.76 m/s at full front thrust: sqrt(0.040 / 0.07); the nose rises above 0.747 m/s."""
    full = math.sqrt(0.040 / 0.07)
    neutral = changed('blimp2b', set={'vehicle.trim.heaviness': '0 g'})
    flight = fly_maneuver(neutral, SCENARIO, replace_speeds(load_maneuver_file('cruise'), full), 1)
    late = flight.flown[:, 0] > 55.0
    assert flight.duties[late, 0] == pytest.approx(1.0, abs=1e-6)
    assert flight.flown[:, 3].max() == pytest.approx(full, rel=0.03)
    assert abs(flight.flown[late, 3].mean()) < 0.1


def test_beavis_has_the_published_margin_and_still_fails_by_a_linear_b(plain_laws, monkeypatch):
    """0.05 N up at full command against 2 g; what decides is that the law knows the collision."""
    lift, weight = compute_lift_margin(changed('beavis_paper').vehicle)
    assert lift == pytest.approx(0.050, abs=2e-4)
    assert (lift - weight) / 9.80665 == pytest.approx(3.1e-3, abs=5e-5)
    monkeypatch.setattr(autopilot, 'compile_core', plain_laws)
    stuck = flown('beavis_by_matrix', 'climb', ablation=True)
    assert not stuck.is_successful
    assert stuck.duties.max() == 0.0  # every column of B sinks, so it asks for nothing
    assert flown('beavis_paper', 'climb').is_successful


@pytest.mark.long
def test_beavis_neither_lifts_more_than_its_jets_nor_sinks_without_weight():
    heavy = flown('beavis_too_heavy', 'climb', ablation=True)
    neutral = flown('beavis_neutral', 'climb', ablation=True)
    assert not heavy.is_successful
    assert heavy.metrics.steady_error > 1.4  # on the floor, at full thrust
    assert heavy.duties[-1].min() == pytest.approx(1.0)
    assert not neutral.is_successful
    assert neutral.metrics.steady_error < -1.0  # rises on


@pytest.mark.long
def test_sblimp_pushes_sideways_only_by_what_it_carries():
    """By what it carries it saturates; heavier, it reaches the published 0.8 m/s."""
    light = flown('sblimp', 'cruise', 0.8)
    heavy = flown('sblimp_16g', 'cruise', 0.8, ablation=True)
    assert not light.is_successful
    assert light.flown[-500:, 3].mean() < level_speed(load_vehicle('sblimp'))
    assert heavy.is_successful


@pytest.mark.long
def test_speed_before_height_lifts_sblimp_away_and_swings_it():
    flight = flown('sblimp_speed_first', 'cruise', 0.8, ablation=True)
    assert not flight.is_successful
    assert flight.height.steady_error < -1.0
    assert math.degrees(flight.tilt) > 25.0


def test_a_top_heavy_vehicle_turns_over_and_is_told_so(tmp_path):
    """GT-MAB's frame on its back instead of its belly: it stands, and flips once it has risen."""
    content = load_yaml(find_file('vehicle', 'gtmab'))
    content['trim']['unstable'] = 'allowed'
    frame = content['layers']['propulsion_and_control']['frame']
    frame['position']['value'] = [0.0, 0.0, 120.0]  # cm: 2 cm above balance
    path = tmp_path / 'top_heavy.yaml'
    path.write_text(yaml.safe_dump(content, sort_keys=False), encoding='utf-8')
    made = COMPARISON.contestants['gtmab'].model_copy(update={'vehicle': str(path)})
    climb = load_maneuver_file('climb')
    brief = climb.model_copy(update={'until': climb.until.model_copy(update={'value': 15.0})})
    flight = fly_maneuver(build_entrant(made, DENSITY), SCENARIO, brief, 1)
    assert flight.lost == 'turned over'
    assert not flight.is_successful
    assert math.degrees(flight.tilt) > 150.0
    assert flight.duties[-1].max() == 0.0  # the motors are off for good
    assert flown('gtmab', 'climb').lost == ''


def test_a_parameter_that_is_none_is_refused():
    with pytest.raises(BadInput, match=r'scenario.air.wind'):
        changed('gtmab', set={'scenario.air.wind': '[1, 0, 0] m/s'})


def test_every_entry_can_be_built_and_traces_are_of_the_first_seed():
    for name in (*COMPARISON.contestants, *COMPARISON.ablations):
        assert build_entry(name).vehicle.mass > 0.0
    for name in COMPARISON.limits:
        assert build_entry(name, limited=True).vehicle.file.name == 'sblimp'
    first, second = fly_entries([('gtmab', 'climb')], 2).flights
    assert first.flown.shape == first.asked.shape
    assert first.flown[:, 1].max() > 1.5
    assert second.flown is None


def test_a_vehicle_flies_to_the_lamp_by_the_law_that_its_file_names():
    """BEAVIS by its own sensors, multirotor by the tracker; gains are the files' own."""
    for vehicle in ('beavis', 'multirotor'):
        made_of = load_spec(vehicle, 'lamp_room', 'bag', '')
        assert made_of.names['gains'] == vehicle
        loop = build_loop(made_of, 2)
        while loop.step() is FlightOutcome.FLYING:
            pass
        assert loop.world.outcome is FlightOutcome.REACHED


def test_a_gain_of_another_law_has_its_unit_and_bounds():
    made_of = load_spec('beavis', 'lamp_room', 'bag', '')
    assert made_of.find_unit('gains.yaw_rate_limit') == 'rad/s'
    with pytest.raises(BadInput, match='compensation'):
        build_loop(made_of.with_values({'gains.compensation': 2.0}), 1)


def test_gains_of_another_law_are_refused():
    with pytest.raises(BadInput, match='gtmab'):
        build_loop(load_spec('beavis', 'lamp_room', 'bag', 'gtmab'), 1)
