"""The static limit in wind, by hand and against the paper."""

import math

from lta_sim import limits
from lta_sim.vehicle import load_vehicle
from lta_sim.wind_limits import air_wrench, share_at_hull, static_limit, thrust_speed
import pytest


def test_gtmab_by_hand():
    """Two forward rotors at full against its drag: F = D1 v + D2 v^2."""
    vehicle = load_vehicle('gtmab')
    effects = vehicle.effects()
    linear, quadratic = effects['linear_drag']['surge'], effects['quadratic_drag']['surge']
    force = limits.level_force(vehicle)
    assert 0.30 < force <= 2 * (0.0915 + 0.0677)
    root = math.sqrt(linear**2 + 4.0 * quadratic * force)
    speed = (root - linear) / (2.0 * quadratic)
    assert thrust_speed(vehicle) == pytest.approx(speed, abs=2e-4)
    # The seed paper's thrust allows 1.5 (a sphere's drag) to 1.9 m/s.
    assert 1.5 < speed < 1.9
    assert static_limit(vehicle) == pytest.approx(limits.tumble_speed(vehicle))


def test_8_metres_a_second_aloft_are_within_and_14_beyond_what_the_platform_can():
    vehicle = load_vehicle('gtmab')
    share = share_at_hull(vehicle, 0.5, 10.0, 0.3)
    assert 8.0 * share == pytest.approx(1.083, abs=2e-3)
    assert 8.0 * share < static_limit(vehicle) < 14.0 * share
    # Over smoother ground 8 m/s are too much as well.
    assert 8.0 * share_at_hull(vehicle, 0.5, 10.0, 0.1) > static_limit(vehicle)


def test_published_speeds():
    """Skye is told to stand less than 3.5 m/s, SBlimp to fly 0.8, Blimp2b 0.76 straight ahead."""
    assert thrust_speed(load_vehicle('skye')) == pytest.approx(3.7, abs=0.1)
    assert thrust_speed(load_vehicle('sblimp')) == pytest.approx(0.733, abs=1e-3)
    assert thrust_speed(load_vehicle('blimp2b')) >= limits.level_speed(load_vehicle('blimp2b'))


def test_the_air_turns_with_the_pitch():
    """Pitched by 90 degrees nose down, surge drag meets a vertical axis: the drag is heave's."""
    model = load_vehicle('gtmab').model()
    effects = load_vehicle('gtmab').effects()
    drag = effects['linear_drag']['heave'] + effects['quadratic_drag']['heave']
    wrench = air_wrench(model, 1.0, 0.0, math.pi / 2)
    assert wrench[0] == pytest.approx(-drag, rel=1e-9)
    assert wrench[2] == pytest.approx(0.0, abs=1e-12)


def test_a_drone_without_a_known_limit_has_none():
    """Linear rotor drag alone: 0.0064 N s/m never meets the 0.58 N that a tilt leaves."""
    assert thrust_speed(load_vehicle('multirotor')) == math.inf
    assert static_limit(load_vehicle('multirotor')) == math.inf


def test_a_glider_flies_pitched():
    assert 0.5 < thrust_speed(load_vehicle('rgblimp')) < 1.5
