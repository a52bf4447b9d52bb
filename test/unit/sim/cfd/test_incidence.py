"""Flows with the nose up, by hand and as the effects of the library."""

import math

from lta_config.files import find_file, load_yaml, share_folder, validate_content
from lta_config.schema.vehicle_file import VehicleFile
from lta_model.limits import tumble_speed
from lta_model.vehicle import load_vehicle, Vehicle
from lta_sim.cfd.incidence import compare_inclined_flows, find_inclined_flows
from lta_sim.cfd.sweep_table import read_sweep
from lta_sim.wind_limits import air_wrench, rise_speed
from lta_studies.wind.limits import draw_incidence
import pytest

SWEEP = read_sweep(share_folder() / 'aero' / 'gtmab_reference.sweep.json')


def with_effects(effects, density=1.2):
    content = load_yaml(find_file('vehicle', 'gtmab'))
    content = {**content, 'effects': {**content['effects'], **effects}}
    return Vehicle(validate_content(VehicleFile, content, 'test'), density)


def test_the_flow_at_10_degrees_by_hand():
    flow = compare_inclined_flows(SWEEP)[0]
    assert flow.incidence == 10.0
    x, _, z = flow.point.force
    c, s = math.cos(math.radians(10)), math.sin(math.radians(10))
    # Drag of the three directions at 1 m/s: 0.0943 ahead and 0.323 up, at their parts of the speed
    x, z = x + 0.0943 * c**2, z - 0.323 * s**2
    lift = x * s + z * c
    assert flow.lift == pytest.approx(lift, rel=0.01)
    assert flow.lift_slope == pytest.approx(
        lift / (0.6 * math.pi / 4) / math.radians(10), rel=0.01
    )
    # Lamb: 0.134 and 0.342 kg
    munk = -(0.3423 - 0.1335) * s * c
    assert flow.lost == pytest.approx(1.0 - flow.point.moment[1] / munk, abs=0.01)


def test_the_two_angles_agree_with_each_other():
    """Half of the Munk moment is lost at both, and the lift grows less than the incidence."""
    ten, twenty = find_inclined_flows('gtmab')
    assert ten.lost == pytest.approx(twenty.lost, abs=0.05)
    assert ten.lift < twenty.lift < 2.0 * ten.lift


def test_a_vehicle_without_such_flows_has_none():
    assert find_inclined_flows('skye') == []


def test_the_effects_of_a_draw_give_the_force_and_moment_of_the_flow():
    (flow, *_) = find_inclined_flows('gtmab')
    effects = draw_incidence([flow], 1)
    without, with_ = (
        air_wrench(with_effects(each).build_model(), 1.0, 0.0, -math.radians(10))
        for each in ({}, effects)
    )
    # Level axes: lift is up, and the lost part of a moment that raises the nose lowers it
    assert with_[2] - without[2] == pytest.approx(flow.lift, rel=1e-3)
    assert with_[4] - without[4] == pytest.approx(-flow.lost * flow.munk, rel=0.01)


def test_a_lost_moment_lets_it_fly_faster_before_it_tumbles():
    half = with_effects({'munk_moment': {'lost': {'value': 0.5, 'unit': '1', 'source': 'test'}}})
    assert tumble_speed(half) == pytest.approx(math.sqrt(2) * tumble_speed(with_effects({})))


def test_where_it_rises_does_not_depend_on_whether_it_balances_when_it_has_tumbled():
    """At this density it balances again at the speed of its thrust, on its way over."""
    assert rise_speed(with_effects({})) == pytest.approx(
        rise_speed(load_vehicle('gtmab')), abs=0.02
    )
