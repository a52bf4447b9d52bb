# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Flows with the nose up, by hand and as the effects of the library."""

import math

from lta_config.files import find_file, load_yaml, share_folder, validate_content
from lta_config.schema.vehicle_file import VehicleFile
from lta_model.limits import tumble_speed
from lta_model.vehicle import load_vehicle, Vehicle
from lta_sim.wind_limits import air_wrench, rise_speed
from lta_windtunnel.aero_fit import compare_inclined_flows
from lta_windtunnel.sweep_table import read_sweep
import pytest

SWEEP = read_sweep(share_folder() / 'aero' / 'gtmab_reference.sweep.json')


def with_effects(effects, density=1.2):
    content = load_yaml(find_file('vehicle', 'gtmab'))
    content = {**content, 'effects': {**content['effects'], **effects}}
    return Vehicle(validate_content(VehicleFile, content, 'test'), density)


def test_the_flow_at_10_degrees_by_hand():
    flow = compare_inclined_flows(SWEEP)[0]
    assert flow.incidence == 10.0
    z = flow.point.force[2]
    c, s = math.cos(math.radians(10)), math.sin(math.radians(10))
    # Drag of the three directions at 1 m/s: 0.323 N up, at its part of the speed
    normal = z - 0.323 * s**2
    assert flow.normal == pytest.approx(normal, rel=0.01)
    assert flow.lift_slope == pytest.approx(
        normal / (0.6 * math.pi / 4) / math.radians(10), rel=0.01
    )
    # Lamb: 0.134 and 0.342 kg
    munk = -(0.3423 - 0.1335) * s * c
    assert flow.lost == pytest.approx(1.0 - flow.point.moment[1] / munk, abs=0.01)


def test_gtmab_has_the_force_and_moment_of_the_flows():
    """Four flows, three numbers: within 10 % of the lift and 5 % of the moment."""
    vehicle = load_vehicle('gtmab', 1.2)
    lost = vehicle.collect_effects()['munk_moment']['lost']
    for flow in compare_inclined_flows(SWEEP):
        angle = math.radians(flow.incidence)
        c, s = math.cos(angle), math.sin(angle)
        wrench = air_wrench(vehicle.build_model(), flow.point.speed, 0.0, -angle)
        x, _, z = flow.point.force
        # From the body's axes to level ones: the nose is up
        assert wrench[2] == pytest.approx(z * c + x * s, rel=0.1)
        assert (1.0 - lost) * flow.munk == pytest.approx(flow.point.moment[1], rel=0.05)


def test_a_lost_moment_lets_it_fly_faster_before_it_tumbles():
    half, none = (
        with_effects({'munk_moment': {'lost': {'value': lost, 'unit': '1', 'source': 'test'}}})
        for lost in (0.5, 0.0)
    )
    assert tumble_speed(half) == pytest.approx(math.sqrt(2) * tumble_speed(none))


def test_where_it_rises_does_not_depend_on_whether_it_balances_when_it_has_tumbled():
    """At this density it balances again at the speed of its thrust, on its way over."""
    assert rise_speed(with_effects({})) == pytest.approx(
        rise_speed(load_vehicle('gtmab')), abs=0.02
    )
