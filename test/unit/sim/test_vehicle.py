# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""GT-MAB's mass, balance, inertia and hover by hand, and what a vehicle cannot be."""

import math

from lta_config.errors import BadInput
from lta_model.effects import initial_memory
from lta_model.electrical.panel import find_max_power_point
from lta_model.state import pack_state, RIGID
from lta_model.vehicle import load_vehicle
from lta_sim.kernels import kernel
from lta_sim.simulated_vehicle import SIM_LAYOUT
import numpy as np
import pytest

from .changed_vehicle import build, G, given, GTMAB, PARTS, refused, RHO, VOLUME


@pytest.fixture(scope='module')
def gtmab():
    return load_vehicle('gtmab', RHO)


def test_the_mass_budget_by_hand(gtmab):
    grams = [1e3 * part.mass.si for part in gtmab.file.parts.values()]
    assert sum(grams) == pytest.approx(271.0 + 48.8)  # the paper's table and the panels
    assert 1e3 * gtmab.gross_lift == pytest.approx(331.2, abs=0.05)
    assert 1e3 * gtmab.ballast_mass == pytest.approx(331.2 + 2.0 - 319.8, abs=0.05)
    # 0.3432 m3 of 93 % helium (1 / 7.236 of air) and 7 % air.
    assert gtmab.volume == pytest.approx(VOLUME)
    assert gtmab.gas_mass == pytest.approx(VOLUME * (0.93 * 0.1664 + 0.07 * 1.2041), rel=1e-12)
    assert gtmab.mass == pytest.approx(gtmab.gas_mass + 1e-3 * (331.234 + 2.0), rel=1e-5)


def test_it_is_two_grams_heavy_in_any_air():
    for density in (1.0, 1.15, 1.2041):
        try:
            vehicle = load_vehicle('gtmab', density)
        except BadInput:
            assert density < 1.16  # thinner air lifts less than the parts
            continue
        assert vehicle.mass - VOLUME * density == pytest.approx(0.002, rel=1e-9)


def lumps():
    """Return (mass, place, own inertia) of all parts, from the file and the formulas of bodies."""
    for part in PARTS.values():
        mass = 1e-3 * part['mass']['value']
        place = 1e-2 * np.array(part['position']['value'], dtype=float)
        a, b, c = 1e-2 * np.array(part['size']['value'], dtype=float)
        if part['shape'] == 'box':
            inertia = mass / 12 * np.array([b * b + c * c, a * a + c * c, a * a + b * b])
        else:  # a thin shell between similar ellipsoids: 1/3 of the sums of squared half axes
            a, b, c = a / 2, b / 2, c / 2
            inertia = mass / 3 * np.array([b * b + c * c, a * a + c * c, a * a + b * b])
        yield mass, place, inertia
    lift = VOLUME * 0.93 * (RHO - RHO * 0.1664 / 1.2041)
    total = sum(1e-3 * part['mass']['value'] for part in PARTS.values())
    yield lift + 0.002 - total, np.array([0.0, 0.0, -0.395]), np.zeros(3)
    gas = VOLUME * RHO - lift
    # An ideal fluid: it rests about the axis of symmetry, and is displaced about another
    r, h = 0.5, 0.2995
    tumbling = gas / 5 * (r * r - h * h) ** 2 / (r * r + h * h)
    assert 1e3 * tumbling == pytest.approx(1.24, abs=0.005)
    yield gas, np.zeros(3), np.array([tumbling, tumbling, 0.0])


def test_balance_is_the_sum_of_the_parts(gtmab):
    parts = list(lumps())
    mass = sum(m for m, _, _ in parts)
    cg = sum(m * place for m, place, _ in parts) / mass
    assert gtmab.mass == pytest.approx(mass, rel=1e-12)
    np.testing.assert_allclose(gtmab.cg, cg, atol=1e-15)
    assert gtmab.cg[2] == pytest.approx(-0.107, abs=0.02)
    # Steiner, axis by axis.
    inertia = np.zeros(3)
    for m, place, own in parts:
        d = place - cg
        inertia += own + m * np.array([d[1] ** 2 + d[2] ** 2, d[0] ** 2 + d[2] ** 2, d[0] ** 2])
        inertia[2] += m * d[1] ** 2
    np.testing.assert_allclose(np.diag(gtmab.inertia), inertia, rtol=1e-12)
    np.testing.assert_allclose(gtmab.inertia, np.diag(np.diag(gtmab.inertia)), atol=1e-15)


def test_parts_off_the_axis_couple_the_axes():
    """A lump of 7 g at (0.2, 0.1) beside the rest: products of inertia by the point masses."""
    vehicle = build(
        ('layers.propulsion_and_control.battery.position', given([20, 10, -36.5], 'cm'))
    )
    cg = vehicle.cg
    assert cg[0] == pytest.approx(0.007 * 0.2 / vehicle.mass)
    assert cg[1] == pytest.approx(0.007 * 0.1 / vehicle.mass)
    far, rest = np.array([0.2, 0.1]) - cg[:2], -cg[:2]
    product = -0.007 * far[0] * far[1] - (vehicle.mass - 0.007) * rest[0] * rest[1]
    assert vehicle.inertia[0, 1] == pytest.approx(product, rel=1e-9)
    np.testing.assert_array_equal(vehicle.inertia, vehicle.inertia.T)


def test_added_mass_is_lambs(gtmab):
    displaced = RHO * 4 / 3 * math.pi * 0.5 * 0.5 * 0.2995
    added = np.array(gtmab.added_mass)
    np.testing.assert_allclose(added[:3] / displaced, (0.355, 0.355, 0.909), atol=1e-3)
    assert added[3] == added[4] > 0.0
    assert added[5] == 0.0


def test_it_stands_where_its_gear_sinks_under_two_grams(gtmab):
    assert gtmab.hull_height_on_floor == pytest.approx(0.42 - 0.002 * G / 20.0, rel=1e-12)


def test_without_a_gear_it_stands_on_its_hull():
    assert build(('effects.floor_contact', None)).hull_height_on_floor == pytest.approx(0.2995)


def test_lighter_than_air_its_gear_does_not_sink():
    light = build(('trim.heaviness', given(-2, 'g')))
    assert light.hull_height_on_floor == pytest.approx(0.42)
    assert light.hover_duty == 0.0


def test_hover_duty_by_hand(gtmab):
    # 2 g = 19.6 mN by two rotors of 0.961 N/N: 10.2 mN each; 0.0915 u^2 + 0.0677 u = 0.0102.
    u = gtmab.hover_duty
    thrust = 0.002 * G / (2 * 0.961)
    assert thrust == pytest.approx(0.0102, abs=5e-5)
    assert 0.0915 * u * u + 0.0677 * u == pytest.approx(thrust, rel=1e-12)
    assert u == pytest.approx(0.12844, abs=1e-5)


def test_in_the_air_the_hover_duty_hovers(gtmab):
    """The kernel's own acceleration with motors at the hover duty."""
    u = gtmab.hover_duty
    memory = np.array(initial_memory())
    first = SIM_LAYOUT.remembers['motor_lag'] - RIGID
    memory[first : first + 2] = u
    state = pack_state((0.0, 0.0, 1.0), memory=memory)
    rate = kernel.state_derivative(state, gtmab.build_model(), (u, u, 0.0, 0.0))
    np.testing.assert_allclose(rate[7:10], 0.0, atol=1e-12)
    sinking = kernel.state_derivative(
        pack_state((0, 0, 1.0), memory=initial_memory()), gtmab.build_model(), (0,) * 4
    )
    heavy = 0.002 * G / (gtmab.mass + gtmab.added_mass[2])
    assert sinking[9] == pytest.approx(-heavy, rel=1e-9)


def test_what_the_controllers_get(gtmab):
    assert gtmab.rotor_names == ['up_left', 'up_right', 'forward_left', 'forward_right']
    assert gtmab.reversible == (False,) * 4
    assert gtmab.thrust_curve == (0.0915, 0.0677)
    assert gtmab.full_thrust == pytest.approx(0.1592)
    assert gtmab.allocation[2] == (0.981, 0.011, -0.061, -0.002, -0.403, -0.1)
    assert gtmab.battery.capacity == pytest.approx(900.0)
    assert gtmab.battery.resistance == 0.15
    assert (gtmab.loads.idle, gtmab.loads.transmitting) == pytest.approx((0.097, 0.023))
    assert (gtmab.loads.rotor_offset, gtmab.loads.rotor_slope) == pytest.approx((0.027, 23.96))
    voltage, current = find_max_power_point(
        gtmab.panel.model_copy(update={'warming': 0.0}), 1000.0
    )
    assert voltage == pytest.approx(8.92, rel=0.02)  # two in series, and air of 20 degC
    assert voltage * current == pytest.approx(2.4976, rel=0.02)
    ring = gtmab.diodes
    assert (ring.count, ring.depth, ring.radius) == (8, pytest.approx(0.33), pytest.approx(0.07))
    assert ring.feedback_resistance == pytest.approx(1e5)


def test_centre_of_gravity_above_the_hull_centre():
    high = [
        (f'layers.{layer}.{name}.position', given([0, 0, 30], 'cm'))
        for layer, parts in GTMAB['layers'].items()
        for name in parts
        if name not in ('envelope', 'solar_panels')
    ]
    text = refused(*high)
    assert text.startswith('gtmab has its centre of gravity 1')
    assert text.endswith(
        ' cm above the hull centre and would flip over; move mass down, or allow it with '
        '"unstable: allowed" under trim.'
    )
    flown = build(*high, ('trim.unstable', 'allowed'))
    assert flown.cg[2] > 0.0


def test_too_weak_to_hover():
    weak = build(
        ('trim.heaviness', given(20, 'g')),
        ('thrust_curve.a', given(0, 'N')),
        ('thrust_curve.b', given(0.05, 'N')),
    )
    with pytest.raises(BadInput) as caught:
        _ = weak.hover_duty
    # 20 g: 0.19613 N / 1.922 = 0.10205 N each; 0.05205 N too much, 10.2 g of it.
    assert str(caught.value) == (
        'gtmab needs 0.102 N from each lifting rotor to hover, but a rotor has at most 0.050 N; '
        'make the vehicle at least 10.2 g lighter.'
    )


def test_without_a_lifting_rotor_it_cannot_hover():
    columns = [
        (f'aero.thrust_allocation.{name}.force', given([1, 0, 0], '1')) for name in GTMAB['rotors']
    ]
    with pytest.raises(
        BadInput, match=r'^gtmab has no rotor that pushes upwards, so it cannot hover;'
    ):
        _ = build(*columns).hover_duty
