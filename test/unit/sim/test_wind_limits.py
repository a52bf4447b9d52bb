# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The static limit in wind, by hand and against the paper."""

from functools import cache
import math

from lta_config.constants import STANDARD_GRAVITY
from lta_config.files import find_file, load_yaml, validate_content
from lta_config.schema.vehicle_file import VehicleFile
from lta_flight.flight_spec import load_spec
from lta_model import limits
from lta_model.vehicle import load_vehicle, Vehicle
from lta_sim import wind_limits
from lta_sim.wind_limits import (
    air_wrench,
    rise_speed,
    static_wind_limit,
    thrust_speed,
    wind_share_at_hull,
)
import pytest
from scipy.optimize import brentq


@cache
def rises(name: str) -> float:
    """Return where a shipped hull rises: seconds of balances, which several tests ask for."""
    return rise_speed(load_vehicle(name))


@pytest.fixture
def once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let `static_wind_limit` of a shipped vehicle take its rise speed as found before."""
    monkeypatch.setattr(wind_limits, 'rise_speed', lambda vehicle: rises(vehicle.file.name))


def test_gtmab_by_hand(once):
    """Two forward rotors at full against its drag: F = D1 v + D2 v^2."""
    vehicle = load_vehicle('gtmab')
    effects = vehicle.collect_effects()
    linear, quadratic = effects['linear_drag']['surge'], effects['quadratic_drag']['surge']
    force = limits.level_force(vehicle)
    assert 0.30 < force <= 2 * (0.0915 + 0.0677)
    root = math.sqrt(linear**2 + 4.0 * quadratic * force)
    speed = (root - linear) / (2.0 * quadratic)
    assert thrust_speed(vehicle) == pytest.approx(speed, abs=2e-4)
    # The seed paper's thrust allows 1.5 (a sphere's drag) to 1.9 m/s.
    assert 1.5 < speed < 1.9
    assert static_wind_limit(vehicle) == rises('gtmab') < speed < limits.tumble_speed(vehicle)


def test_gtmab_rises_where_the_balance_by_hand_says():
    """Balance the moments of pitch, and then thrust, drag, lift and weight in height."""
    vehicle = load_vehicle('gtmab')
    along, _, upright, *_ = vehicle.added_mass
    righting = -vehicle.mass * STANDARD_GRAVITY * float(vehicle.cg[2])
    left, right = (rotor.column for rotor in vehicle.rotors[2:])
    kept = 1.0 - 0.48
    push, down, arm = left[0] + right[0], left[2] + right[2], left[4] + right[4]

    def excess(speed: float) -> float:
        def lean(force: float) -> float:
            return math.asin(-arm * force / (righting - kept * (upright - along) * speed**2))

        def lacking(force: float) -> float:
            c, s = math.cos(lean(force)), math.sin(lean(force))
            return (push * c - down * s) * force - 0.092 * (speed * c) ** 2 * c - rest(s, c)

        def rest(s: float, c: float) -> float:
            return normal(s, c) * s

        def normal(s: float, c: float) -> float:
            return 0.359 * (speed * s) ** 2 + 0.63 * speed**2 * s * c / (1.0 + 4.5 * s * s)

        force = brentq(lacking, 0.0, 0.12)
        c, s = math.cos(lean(force)), math.sin(lean(force))
        hull = normal(s, c) * c - 0.092 * (speed * c) ** 2 * s
        return (push * s + down * c) * force + hull - vehicle.heaviness * STANDARD_GRAVITY

    assert rises('gtmab') == pytest.approx(brentq(excess, 0.5, 1.0), abs=0.01)


def test_weight_holds_it_down():
    told = load_spec('gtmab', 'hall', 'bag', '')
    heavy = told.with_values({'vehicle.trim.heaviness': {'value': 10, 'unit': 'g'}})
    vehicle = Vehicle(validate_content(VehicleFile, heavy.contents['vehicle'], 'heavy'))
    assert rise_speed(vehicle) > rises('gtmab') + 0.1


def test_8_metres_a_second_aloft_are_beyond_what_the_platform_can(once):
    vehicle = load_vehicle('gtmab')
    share = wind_share_at_hull(vehicle, 0.5, 10.0, 0.3)
    assert 8.0 * share == pytest.approx(1.083, abs=2e-3)
    # Its hull rises at 0.76 m/s
    assert 0.6 * 8.0 * share < static_wind_limit(vehicle) < 0.8 * 8.0 * share
    # Over smoother ground more of the wind is left.
    assert 8.0 * wind_share_at_hull(vehicle, 0.5, 10.0, 0.1) > static_wind_limit(vehicle)


def test_published_speeds():
    """Skye is told to stand less than 3.5 m/s, SBlimp to fly 0.8, Blimp2b 0.76 straight ahead."""
    assert thrust_speed(load_vehicle('skye')) == pytest.approx(3.7, abs=0.1)
    assert thrust_speed(load_vehicle('sblimp')) == pytest.approx(0.758, abs=1e-3)
    assert thrust_speed(load_vehicle('blimp2b')) >= limits.level_speed(load_vehicle('blimp2b'))


def test_the_air_turns_with_the_pitch():
    """Pitched by 90 degrees nose down, surge drag meets a vertical axis: the drag is heave's."""
    model = load_vehicle('gtmab').build_model()
    effects = load_vehicle('gtmab').collect_effects()
    drag = effects['linear_drag']['heave'] + effects['quadratic_drag']['heave']
    wrench = air_wrench(model, 1.0, 0.0, math.pi / 2)
    assert wrench[0] == pytest.approx(-drag, rel=1e-9)
    assert wrench[2] == pytest.approx(0.0, abs=1e-12)


def test_a_multirotor_leans_as_far_as_its_thrust_carries_it():
    """Held up, its level drag is 0.0064 N s/m at any pitch; 0.48 N carry 0.265 N up to 51 deg."""
    weight, pitch = 0.027 * STANDARD_GRAVITY, math.radians(51.0)  # of a grid of 3 degrees
    assert static_wind_limit(load_vehicle('multirotor')) == pytest.approx(
        weight * math.tan(pitch) / 0.0064, abs=0.01
    )


def test_a_drone_without_a_known_limit_has_none():
    """Half of that drag never meets the 0.40 N that a tilt leaves."""
    drag = {'value': [3.2e-3, 3.2e-3, 3.6e-3], 'unit': 'N s/m', 'source': 'test'}
    slippery = load_yaml(find_file('vehicle', 'multirotor'))
    slippery['aero']['linear_drag']['force'] = drag
    vehicle = Vehicle(VehicleFile.model_validate(slippery))
    assert static_wind_limit(vehicle) == math.inf  # and so is the thrust's


@pytest.mark.long
def test_a_glider_flies_pitched():
    assert 0.5 < thrust_speed(load_vehicle('rgblimp')) < 1.5
