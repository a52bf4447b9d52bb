# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""What follows from a vehicle file, against sums by hand and against the kernel in free flight."""

import math

from lta_config.files import list_shipped_names
from lta_config.schema.vehicle_body import HullBlock
from lta_model.effects import initial_memory
from lta_model.limits import level_force
from lta_model.state import pack_state
from lta_model.vehicle import load_vehicle
from lta_sim.kernels import kernel
from lta_vehicle.figures.helium_leak import film_area
from lta_vehicle.figures.sheet import build_sheet, list_entries, list_numbers
from lta_vehicle.figures.stability import compute_pendulum_mode
from lta_vehicle.figures.wrench_limit import solve_wrench_limit, time_to_climb
from lta_vehicle.views.sheet_summary import describe_vehicle, format_headline
import numpy as np
import pytest

from ..sim.changed_vehicle import build, given  # noqa: TID252 - `test` is Python's own

G = 9.80665
FULL = 0.0915 + 0.0677  # N of one rotor
VEHICLES = list_shipped_names('vehicles')


@pytest.fixture(scope='module')
def gtmab():
    return build_sheet(load_vehicle('gtmab'))


def value(sheet, key):
    return sheet.by_key[key].value


def test_weight_and_lift_of_gtmab_by_hand(gtmab):
    """Parts 319.8 g; 0.34323 m3 of air at 1.2041 kg/m3, helium at 0.1664, 93 % pure."""
    volume = 2.7458 * 0.5**3
    lift = volume * 0.93 * (1.2041 - 0.1664)
    assert value(gtmab, 'lift') == pytest.approx(1e3 * lift, rel=2e-4)
    assert value(gtmab, 'ballast') == pytest.approx(1e3 * lift + 2.0 - 319.8, abs=0.05)
    assert value(gtmab, 'heaviness') == 2.0
    assert value(gtmab, 'mass') == pytest.approx(1e3 * volume * 1.2041 + 2.0, abs=0.05)


def test_the_budget_adds_up_to_the_mass(gtmab):
    assert sum(share.mass for share in gtmab.budget) == pytest.approx(gtmab.vehicle.mass)
    layers = dict.fromkeys(share.layer for share in gtmab.budget)
    assert list(layers) == [*gtmab.vehicle.file.layers, 'gas']


@pytest.mark.parametrize('name', VEHICLES)
def test_every_budget_adds_up(name):
    sheet = build_sheet(load_vehicle(name))
    assert sum(share.mass for share in sheet.budget) == pytest.approx(sheet.vehicle.mass)


def test_pushes_of_gtmab_by_hand(gtmab):
    weight = 0.002 * G
    assert value(gtmab, 'push_up') == pytest.approx(1e3 * (2 * 0.961 * FULL - weight))
    assert value(gtmab, 'push_forward') == pytest.approx(1e3 * 2 * 0.981 * FULL)
    assert value(gtmab, 'push_backward') == pytest.approx(0.0, abs=1e-9)
    # One forward rotor alone: a moment of 0.1 m, and a push forward that nothing balances.
    assert value(gtmab, 'push_turn_left') == pytest.approx(1e3 * 0.1 * FULL)
    assert (
        'cannot turn on the spot: a horizontal force of 156 mN'
        in gtmab.by_key['push_turn_left'].note
    )


def test_hover_of_gtmab_by_hand(gtmab):
    thrust = 0.002 * G / (2 * 0.961)
    duty = (-0.0677 + math.sqrt(0.0677**2 + 4 * 0.0915 * thrust)) / (2 * 0.0915)
    power = 0.097 + 2 * (0.027 + 23.96 * thrust)
    assert value(gtmab, 'hover_duty') == pytest.approx(100 * duty)
    assert value(gtmab, 'hover_power') == pytest.approx(power)
    assert value(gtmab, 'hover_time') == pytest.approx(0.25 * 3.7 * 60 / power)


def test_speeds_of_gtmab_by_hand(gtmab):
    up = 2 * 0.961 * FULL - 0.002 * G
    thrust = math.sqrt(2 * 0.981 * FULL / 0.092)
    level = next(figure for figure in gtmab.figures if figure.key == 'level_speed')
    assert value(gtmab, 'level_speed') < thrust
    assert f'thrust would do for {thrust:.2f} m/s' in level.note
    assert value(gtmab, 'climb_speed') == pytest.approx(math.sqrt(up / 0.359))
    assert value(gtmab, 'sink_speed') == pytest.approx(math.sqrt(0.002 * G / 0.359))
    rate = math.radians(value(gtmab, 'yaw_rate'))
    assert 3.2e-4 * rate + 6.4e-4 * rate**2 == pytest.approx(0.1 * FULL)


def test_climb_against_the_closed_form():
    force, mass, drag = 0.2864, 0.7588, 0.359
    exact = mass / math.sqrt(force * drag) * math.acosh(math.exp(drag * 1.0 / mass))
    assert time_to_climb(1.0, force, mass, 0.0, drag) == pytest.approx(exact, rel=1e-6)
    assert time_to_climb(1.0, 0.5, 1.0, 0.0, 0.0) == pytest.approx(2.0, rel=1e-3)
    assert time_to_climb(1.0, -0.1, mass, 0.0, drag) is None


@pytest.mark.parametrize('name', [name for name in VEHICLES if name != 'rgblimp'])
def test_pushes_forward_and_left_are_the_limits_of_level_flight(name):
    """`lta_model.limits` asks the same of a heading with a programme of its own."""
    vehicle = load_vehicle(name)
    for direction, heading in (('forward', 0.0), ('left', math.pi / 2), ('right', -math.pi / 2)):
        assert solve_wrench_limit(vehicle, direction).most == pytest.approx(
            level_force(vehicle, heading), abs=1e-9
        )


def test_a_glider_cannot_hold_altitude_and_says_so():
    sheet = build_sheet(load_vehicle('rgblimp'))
    assert solve_wrench_limit(sheet.vehicle, 'forward') is None
    assert value(sheet, 'push_forward') == pytest.approx(120.0)
    assert 'the rotors cannot hold altitude' in sheet.by_key['push_forward'].note
    assert value(sheet, 'hover_duty') is None
    # Moment over force by angle of attack, as published: 0.0933 m over 2.9375.
    assert value(sheet, 'cp_x') == pytest.approx(100 * 0.0933 / 2.9375)


def tilted(vehicle, angle):
    """Return the state of a vehicle pitched by an angle."""
    state = pack_state((0.0, 0.0, 100.0), memory=initial_memory())
    state[3:7] = (0.0, math.sin(angle / 2), 0.0, math.cos(angle / 2))
    return state


def pitches(vehicle, angle, step, count):
    """Let a vehicle go and return sin(pitch) at even steps [1]."""
    model, state, found = vehicle.build_model(), tilted(vehicle, angle), []
    for _ in range(count):
        x, y, z, w = state[3:7]
        found.append(2.0 * (w * y - z * x))
        state = kernel.advance(state, model, vehicle.pack_command([0.0] * 4), (), step / 4, 4)
    return np.array(found)


def crossings(values, step):
    """Return when a swing passes the vertical [s]."""
    before = np.nonzero(values[:-1] * values[1:] < 0.0)[0]
    return step * (before + values[before] / (values[before] - values[before + 1]))


NEUTRAL = ('trim.heaviness', given(0, 'g'))
STILL = (
    ('aero.linear_drag.moment', given([0, 0, 0], 'N m s')),
    ('aero.quadratic_drag.moment', given([0, 0, 0], 'N m s2')),
    ('aero.quadratic_drag.force', given([0, 0, 0], 'N s2/m2')),
)


def test_the_period_is_that_of_the_kernel_in_free_air():
    vehicle = build(NEUTRAL, *STILL)
    times = crossings(pitches(vehicle, math.radians(1.0), 0.01, 1500), 0.01)
    assert len(times) > 10
    period = 2.0 * np.diff(times).mean()
    assert compute_pendulum_mode(vehicle, 'pitch').period == pytest.approx(period, rel=2e-4)


def test_the_damping_is_that_of_the_kernel_at_five_degrees():
    """What a swing loses in one period at 5 degrees; the surge that goes with it is damped too."""
    vehicle = build(NEUTRAL)
    found = compute_pendulum_mode(vehicle, 'pitch')
    step = 0.005
    values = pitches(vehicle, math.radians(5.0), step, round(1.2 * found.period / step))
    back = values[round(0.8 * found.period / step) :].max()
    lost = math.log(math.sin(math.radians(5.0)) / back)
    assert lost == pytest.approx(2.0 * math.pi * found.damping_ratio, rel=0.03)


def test_helium_of_gtmab_by_hand(gtmab):
    """pi^2 r^2 of film, 0.2 to 0.9 l/(m2 day), 1.0377 g of lift a litre."""
    film = math.pi**2 * 0.25
    assert value(gtmab, 'leak_low') == pytest.approx(0.2 * film * 1.0377, rel=2e-4)
    assert value(gtmab, 'leak_high') == pytest.approx(0.9 * film * 1.0377, rel=2e-4)
    assert value(gtmab, 'hover_loss') == pytest.approx(1e3 * 2 * 0.961 * FULL / G - 2.0)
    assert gtmab.by_key['hover_loss'].note == 'after 13 to 57 days of leakage'


def area(half):
    """Return the surface of a spheroid about z by the sum of narrow cones [m2]."""
    turns = np.linspace(0.0, math.pi, 20001)
    across, along = half[0] * np.sin(turns), half[1] * np.cos(turns)
    slant = np.hypot(np.diff(across), np.diff(along))
    return float(np.sum(math.pi * (across[1:] + across[:-1]) * slant))


@pytest.mark.parametrize('length', [0.52, 1.092, 0.3])
def test_surface_of_a_spheroid_against_narrow_cones(length):
    hull = HullBlock.model_validate({
        'shape': 'spheroid', 'axis': 'x', 'diameter': given(0.52, 'm'),
        'length': given(length, 'm'), 'purity': given(93, '%'),
    })  # fmt: skip
    assert film_area(hull) == pytest.approx(area((0.26, length / 2)), rel=1e-6)


def test_every_number_has_its_place_and_source(gtmab):
    file = gtmab.vehicle.file
    by_place = {entry.place: entry for entry in list_numbers(file)}
    battery = by_place['layers.propulsion_and_control.battery.mass']
    assert (battery.value, battery.source) == ('7 g', 'seed paper, 1S 250 mAh')
    assert by_place['trim.ballast_position'].value == '[0, 0, -39.5] cm'
    assert by_place['trim.ballast_position'].is_assumed
    assert all(entry.source for entry in by_place.values())
    assert any(entry.place == 'hull.shape' for entry in list_entries(file))


def test_what_is_assumed_is_counted_where_it_is_used(gtmab):
    # Of what carries it: five places of rotors and the ballast's; the heaviness is from the paper.
    used, assumed = gtmab.count_inputs(gtmab.by_key['hover_duty'])
    assert (used, assumed) == (24, 5)
    assert gtmab.assumed_count == sum('assumed' in entry.source for entry in gtmab.numbers)


def test_the_headline_says_what_matters(gtmab):
    assert format_headline(gtmab) == (
        'gtmab weighs 415.3 g, gas included, and is 2.00 g heavier than air; it hovers at 12.8 % '
        'duty'
    )
    assert format_headline(build_sheet(load_vehicle('blimp2b'))).endswith(
        'gas included, and is neutrally buoyant'
    )
    assert 'cannot lift it' in format_headline(build_sheet(load_vehicle('rgblimp')))
    assert any(
        'It can hover until 29.2 g of lift are lost' in line for line in describe_vehicle(gtmab)
    )


@pytest.mark.parametrize('name', VEHICLES)
def test_every_figure_says_what_it_follows_from_and_why_it_is_missing(name):
    sheet = build_sheet(load_vehicle(name))
    assert len(sheet.by_key) == len(sheet.figures)
    for figure in sheet.figures:
        assert figure.source, figure
        assert figure.value is not None or figure.note, figure
        assert 'nan' not in figure.value_with_unit


def test_a_vehicle_that_leans_over_at_full_push_says_so():
    """Its centre of gravity only millimetres below the hull centre."""
    vehicle = build(('trim.ballast_position', given([0, 0, 30], 'cm')),
                    ('layers.top.solar_panels.mass', given(62, 'g')),
                    ('layers.sensors.light_board.position', given([0, 0, 20], 'cm')))  # fmt: skip
    sheet = build_sheet(vehicle)
    assert value(sheet, 'push_lean') is None
    assert 'the moment of the rotors is' in sheet.by_key['push_lean'].note
