# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Where panels sit: against the balance by hand, the linearised rigid body and plane geometry."""

import math

from lta_config.errors import BadInput
from lta_config.files import find_file, load_yaml
from lta_studies.energy.mounting import mounted_vehicle, straight_flight
from lta_studies.energy.mounting.mounted_vehicle import (
    build_mounted_vehicle,
    lift_deficit,
    LightDirection,
    required_volume_factor,
)
from lta_studies.energy.mounting.run import MountTrial
from lta_studies.energy.mounting.straight_flight import simulate_release
from lta_vehicle.figures.stability import compute_pendulum_mode
import numpy as np
import pytest

GTMAB = load_yaml(find_file('vehicle', 'gtmab'))
MOUNTS = ('side', 'bottom', 'top')
LIFT = 331.233061725  # g: 0.93 of the pure helium of 2.7458 r^3 at 20 degC
REST = 271.0  # g: every part of the seed paper's table without panels
FULLER = required_volume_factor(GTMAB, MOUNTS)
DEGREE = math.radians(1.0)


@pytest.mark.parametrize(('mount', 'frame'), [('side', 0.0), ('bottom', 45.5), ('top', 0.0)])
def test_lift_that_is_lacking_by_hand(mount, frame):
    grams = REST + 48.8 + frame - LIFT - 2.0
    assert 1e3 * lift_deficit(GTMAB, mount) == pytest.approx(grams, abs=1e-6)


def test_the_bottom_mount_is_refused_in_its_own_hull_and_carried_by_one_9_7_percent_fuller():
    with pytest.raises(BadInput, match=r'32\.1 g too heavy'):
        build_mounted_vehicle(GTMAB, 'bottom')
    assert pytest.approx((REST + 48.8 + 45.5 - 2.0) / LIFT, abs=1e-3) == FULLER
    assert (
        0.0
        <= build_mounted_vehicle(GTMAB, 'bottom', fuller=FULLER).vehicle.ballast_mass
        < 1e-3 * LIFT * 1e-3
    )


def test_moving_the_panels_from_top_to_side_moves_the_centre_of_gravity_by_their_share():
    top, side = (
        build_mounted_vehicle(GTMAB, 'top').vehicle,
        build_mounted_vehicle(GTMAB, 'side').vehicle,
    )
    assert side.mass == pytest.approx(top.mass, rel=1e-12)
    by_hand = 0.302 * 0.0488 / top.mass
    assert top.cg[2] - side.cg[2] == pytest.approx(by_hand, rel=1e-9)


def test_lean_of_misplaced_panels_by_hand():
    made = build_mounted_vehicle(GTMAB, 'side', ahead=0.03)
    ahead = 0.03 * 0.0488 / made.vehicle.mass
    assert made.nose_down_pitch == pytest.approx(math.atan(ahead / -made.vehicle.cg[2]), rel=1e-9)
    assert build_mounted_vehicle(GTMAB, 'side').nose_down_pitch == 0.0


def test_arms_are_the_only_drag_that_a_mount_adds():
    plain = build_mounted_vehicle(GTMAB, 'top', fuller=FULLER).vehicle.collect_effects()[
        'quadratic_drag'
    ]
    armed = build_mounted_vehicle(GTMAB, 'bottom', fuller=FULLER).vehicle.collect_effects()[
        'quadratic_drag'
    ]
    added = 0.5 * build_mounted_vehicle(GTMAB, 'top').vehicle.air_density * 1.98 * 2 * 0.40 * 0.013
    assert armed['surge'] - plain['surge'] == pytest.approx(added, rel=1e-9)
    assert armed['sway'] - plain['sway'] == pytest.approx(added * 0.013 / 0.40, rel=1e-9)


def linearised(vehicle, amplitude):
    """Return period and damping of pitch and surge as one linear system, by eigenvalues."""
    mass, (ax, _, _, _, aq, _) = vehicle.mass, vehicle.added_mass
    height = float(vehicle.cg[2])
    effects = vehicle.collect_effects()
    turning_gas = effects['gas_rotation']['share'] * effects['gas_rotation']['pitch']
    about = vehicle.inertia[1, 1] + turning_gas + mass * height**2 + aq
    inertia = np.array([[mass + ax, mass * height], [mass * height, about]])
    found = compute_pendulum_mode(vehicle, 'pitch')
    rate = amplitude * math.sqrt(found.stiffness / found.inertia)
    surge = abs(mass * height / (mass + ax)) * rate
    turning = effects['rotational_drag']
    strips = effects['strip_damping']
    frame = strips['surge_1'] * abs(strips['z_1']) ** 3
    bars = [strips[f'surge_{i}'] * abs(strips[f'z_{i}']) ** 3 for i in (2, 3) if strips[f'z_{i}']]
    mean = 8.0 / (3.0 * math.pi)
    drag = np.diag([
        mean * effects['quadratic_drag']['surge'] * surge,
        turning['pitch'] + mean * rate * (turning['pitch_2'] + frame + sum(bars)),
    ])  # fmt: skip
    righting = np.array([[0.0], [-mass * 9.80665 * height]])
    solved = np.linalg.inv(inertia)
    system = np.zeros((3, 3))
    system[:2, :2], system[:2, 2:], system[2, 1] = -solved @ drag, -solved @ righting, 1.0
    root = next(root for root in np.linalg.eigvals(system) if root.imag > 1e-6)
    return 2.0 * math.pi / root.imag, -root.real / abs(root)


@pytest.mark.parametrize('mount', MOUNTS)
def test_a_released_vehicle_swings_as_the_linearised_rigid_body(mount):
    vehicle = build_mounted_vehicle(GTMAB, mount, fuller=FULLER).vehicle
    period, damping = linearised(vehicle, 4.8 * DEGREE)  # mean amplitude of the first three
    free = simulate_release(vehicle, 5.0 * DEGREE, 8.0)
    assert free.period == pytest.approx(period, rel=2e-3)
    assert free.damping_ratio == pytest.approx(damping, rel=0.03)
    by_formula = compute_pendulum_mode(vehicle, 'pitch')
    assert by_formula.period == pytest.approx(period, rel=1e-3)


def test_weight_above_buoyancy_turns_over_as_fast_as_its_growth_says():
    vehicle = build_mounted_vehicle(GTMAB, 'top').vehicle
    depth = -float(vehicle.cg[2])
    flipped = simulate_release(vehicle, 0.1 * DEGREE, 4.0, depth)
    inertia = compute_pendulum_mode(vehicle, 'pitch').inertia
    # Inverted pendulum: J x'' = m g h x
    rate = math.sqrt(vehicle.mass * 9.80665 * depth / inertia)
    small = (flipped.tilt > 0.5 * DEGREE) & (flipped.tilt < 5.0 * DEGREE)
    slope = np.polyfit(flipped.time[small], np.log(flipped.tilt[small]), 1)[0]
    assert slope == pytest.approx(rate, rel=0.02)
    assert flipped.overturn_time is not None


def test_coinciding_centres_neither_right_nor_turn_over():
    still = simulate_release(build_mounted_vehicle(GTMAB, 'top').vehicle, 5.0 * DEGREE, 4.0, 0.0)
    np.testing.assert_allclose(still.tilt, 5.0 * DEGREE, atol=1e-9)
    assert still.period is None
    assert still.overturn_time is None


@pytest.mark.parametrize('mount', ['top', 'bottom'])
def test_level_panels_get_the_light_from_above(mount):
    made = build_mounted_vehicle(GTMAB, mount, fuller=FULLER)
    found = mounted_vehicle.compute_light_shares(
        made.vehicle, made.mount, LightDirection('overhead', 0.5 * math.pi)
    )
    assert (found.series, found.apart) == pytest.approx((1.0, 1.0))


@pytest.mark.parametrize('height', [15.0, 40.0, 75.0])
def test_nothing_shades_the_top_so_that_it_gets_the_sine_of_the_height(height):
    made = build_mounted_vehicle(GTMAB, 'top')
    found = mounted_vehicle.compute_light_shares(
        made.vehicle, made.mount, LightDirection('somewhere', math.radians(height))
    )
    assert found.series == found.apart == pytest.approx(math.sin(math.radians(height)))


def test_upright_panels_get_half_of_an_overcast_sky_and_one_of_two_sees_a_low_lamp():
    made = build_mounted_vehicle(GTMAB, 'side')
    sky = mounted_vehicle.compute_light_shares(
        made.vehicle, made.mount, LightDirection('sky', None)
    )
    assert sky.series == pytest.approx(0.5, abs=2e-3)  # form factor of a wall
    low = mounted_vehicle.compute_light_shares(
        made.vehicle, made.mount, LightDirection('low', 0.0)
    )
    assert low.series == 0.0
    assert low.apart == pytest.approx(1.0 / math.pi, abs=2e-3)  # mean clipped cosine


def test_the_balloon_shades_the_far_panel_of_the_bottom_mount_by_the_tangent():
    # Seen in its own plane across the flight, the hull is an ellipse of 50 by 29.95 cm.
    made = build_mounted_vehicle(GTMAB, 'bottom', fuller=FULLER)
    y, z = -0.56, -0.358  # the right panel's face
    a, c = 0.50, 0.2995
    # Rays towards a lamp on the left meet that ellipse where a quadratic has real roots.
    heights = np.radians(np.linspace(1.0, 89.0, 4401))
    p, q = np.cos(heights) / a, np.sin(heights) / c
    inner = (y / a * p + z / c * q) ** 2 - (p * p + q * q) * ((y / a) ** 2 + (z / c) ** 2 - 1.0)
    hidden = heights[inner > 0.0]
    low, high = float(hidden.min()), float(hidden.max())
    for height, seen in ((0.5 * (low + high), 0.0), (high - 0.12, 0.0), (high + 0.12, 1.0)):
        towards = (0.0, math.cos(height), math.sin(height))
        got = mounted_vehicle.panel_light_share(made.vehicle, made.mount, 'panel_right', towards)
        assert got == pytest.approx(seen * math.sin(height), abs=1e-9)


def test_a_flight_leans_as_its_balance_says(monkeypatch):
    monkeypatch.setattr(straight_flight, 'MOUNTING_DEPARTURE', 14.0)
    monkeypatch.setattr(straight_flight, 'FLIGHT_END', 30.0)
    made = build_mounted_vehicle(GTMAB, 'side', ahead=0.03)
    flown = straight_flight.fly_straight(made, 'gtmab', 1)
    lean = -flown.track.crop(14.0, 30.0).pitch.mean()
    assert lean == pytest.approx(made.nose_down_pitch, abs=0.15 * DEGREE)
    hover = 0.120 + 2 * (0.027 + 23.96 * 2e-3 * 9.80665 / (2 * 0.961))
    assert hover < flown.power < 2.0 * hover
    tried = MountTrial(
        made,
        compute_pendulum_mode(made.vehicle, 'pitch'),
        simulate_release(made.vehicle, 0.1, 1.0),
        [flown],
    )
    needed = -made.vehicle.mass * made.vehicle.cg[2] * math.tan(math.radians(2.5)) / 0.0488
    assert tried.misplacement == pytest.approx(needed, rel=1e-12)
