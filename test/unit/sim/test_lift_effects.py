"""Values of the lift effects by hand and by the gas law, and that their nulls are nothing."""

from lta_model.effects.protocol import RigidBody
from lta_model.effects.weight import (
    air_state,
    ballast,
    gas_purity,
    gas_state,
    helium_leak,
    net_lift,
    payload,
    superheat,
)
import numpy as np
import pytest

from . import still_air as air
from .point_cloud import of_points

G = 9.80665
THRUST = (0.0,) * 8
# The mylar shape of 1 m: 0.343225 m3 of air at 20 C, and what R = 2077.1 J/(kg K) makes of helium.
VOLUME, AIR = 0.343225, 1.2041
HELIUM = 101325.0 / (2077.1 * 293.15)
VEHICLE = RigidBody(
    0.413, (0.001, -0.002, -0.03), (0.03, 0.031, 0.032, 1e-4, 2e-4, 3e-4), VOLUME * AIR
)
TILTED = air.turned((0.4, 0.3, -0.2))

LIFT = [net_lift, helium_leak, superheat]
BODY = [air_state, ballast, gas_purity, gas_state, payload]


def named(module):
    return module.EFFECT.name


def null(module):
    return tuple(parameter.null for parameter in module.PARAMETERS)


@pytest.mark.parametrize('module', LIFT, ids=named)
def test_null_is_no_force_and_no_rate_whatever_the_memory(module):
    seen = air.motion(TILTED, displaced=0.4, irradiance=300.0)
    memory = (0.7,) * len(module.EFFECT.memory)
    assert module.compute_wrench(null(module), memory, seen, THRUST) == (0.0,) * 6
    fresh = tuple(value for _, value in module.EFFECT.memory)
    assert not any(module.EFFECT.rate(null(module), fresh, seen))


@pytest.mark.parametrize('module', BODY, ids=named)
def test_null_leaves_the_vehicle_to_the_bit(module):
    assert module.change_body(null(module), VEHICLE) == VEHICLE


def test_net_lift_is_up_in_the_map_at_the_hull_centre():
    wrench = net_lift.compute_wrench((0.05,), (), air.motion(TILTED), THRUST)
    np.testing.assert_allclose(wrench[:3], 0.05 * air.up(TILTED), rtol=1e-14)
    assert wrench[3:] == (0.0, 0.0, 0.0)


def test_leak_pulls_down_by_what_is_lost():
    seen = air.motion(TILTED)
    assert helium_leak.EFFECT.memory == (('lost', 0.0),)
    assert helium_leak.EFFECT.rate((1e-4,), (0.3,), seen) == (1e-4,)
    wrench = helium_leak.compute_wrench((1e-4,), (0.3,), seen, THRUST)
    np.testing.assert_allclose(wrench[:3], -0.3 * air.up(TILTED), rtol=1e-14)
    assert wrench[3:] == (0.0, 0.0, 0.0)


def test_the_leaks_that_its_text_names():
    lift = (AIR - HELIUM) * G
    day = [liters * 1e-3 * np.pi**2 * 0.25 * lift / 86400.0 for liters in (0.2, 0.9)]
    np.testing.assert_allclose(day, (0.58e-7, 2.6e-7), rtol=0.01)
    hole = 0.6 * 1e-6 * np.sqrt(2.0 * 30.0 / HELIUM) * lift
    assert hole == pytest.approx(1.2e-4, rel=0.04)


def test_superheat_is_the_weight_of_the_air_that_slack_gas_displaces():
    """A mass of helium at the pressure of the air, 293.15 K and then 9 K warmer."""
    gas = HELIUM * VOLUME
    cold, warm = (gas * 2077.1 * kelvin / 101325.0 for kelvin in (293.15, 302.15))
    seen = air.motion(TILTED, displaced=VOLUME * AIR)
    wrench = superheat.compute_wrench((0.02, 70.0, 1.0), (9.0,), seen, THRUST)
    np.testing.assert_allclose(wrench[:3], (warm - cold) * AIR * G * air.up(TILTED), rtol=1e-12)
    assert superheat.compute_wrench((0.02, 70.0, 0.0), (9.0,), seen, THRUST) == (0.0,) * 6
    half = superheat.compute_wrench((0.02, 70.0, 0.5), (9.0,), seen, THRUST)
    np.testing.assert_allclose(half, 0.5 * np.array(wrench), rtol=1e-14)


def test_superheat_warms_with_its_lag():
    p, lit = (0.02, 70.0, 1.0), air.motion(irradiance=300.0, displaced=0.4)
    assert superheat.compute_memory_rate(p, (0.0,), lit)[0] == pytest.approx(6.0 / 70.0, rel=1e-14)
    assert superheat.compute_memory_rate(p, (6.0,), lit)[0] == pytest.approx(0.0, abs=1e-15)
    assert superheat.compute_memory_rate(p, (6.0,), air.motion())[0] == pytest.approx(
        -6.0 / 70.0, rel=1e-14
    )


def test_superheat_without_lag_is_steady_at_once():
    lit = air.motion(irradiance=300.0, displaced=0.4)
    at_once = superheat.compute_wrench((0.02, 0.0, 0.8), (0.0,), lit, THRUST)
    settled = superheat.compute_wrench((0.02, 70.0, 0.8), (6.0,), lit, THRUST)
    assert at_once == pytest.approx(settled, rel=1e-14)
    assert superheat.compute_memory_rate((0.02, 0.0, 0.8), (0.0,), lit) == (0.0,)


def test_the_heat_balance_that_its_text_names():
    shed = 2.6 * np.pi**2 * 0.25
    assert 0.14 * np.pi / 4.0 / shed == pytest.approx(0.017, rel=0.02)
    capacity = HELIUM * VOLUME * 5193.0 + 0.1168 * 1300.0
    assert capacity / shed == pytest.approx(70.0, rel=0.01)


def density(pascal, kelvin):
    return pascal / (287.05 * kelvin)


@pytest.mark.parametrize(('pascal', 'kelvin'), [(1500.0, 0.0), (0.0, 8.0), (-3e3, -12.0)])
def test_a_taut_hull_displaces_air_of_the_new_density(pascal, kelvin):
    changed = air_state.change_body((pascal, kelvin, 0.0), VEHICLE)
    ratio = density(101325.0 + pascal, 293.15 + kelvin) / density(101325.0, 293.15)
    assert changed.displaced == pytest.approx(ratio * VEHICLE.displaced, rel=1e-14)
    assert changed[:3] == VEHICLE[:3]


def test_a_slack_hull_displaces_the_same_mass_of_any_air():
    assert air_state.change_body((-5e3, 20.0, 1.0), VEHICLE) == VEHICLE


def test_gas_follows_the_gas_law_at_the_volume_of_the_hull():
    gas = HELIUM * VOLUME
    changed = gas_state.change_body((gas, 6.0, 800.0), VEHICLE)
    filled = 102125.0 * VOLUME / (2077.1 * 299.15)
    assert changed.mass - VEHICLE.mass == pytest.approx(filled - gas, rel=1e-9)
    assert changed[1:] == VEHICLE[1:]
    assert gas_state.change_body((gas, 0.0, 0.0), VEHICLE) == VEHICLE


def test_air_in_the_helium_weighs():
    changed = gas_purity.change_body((-0.07,), VEHICLE)
    heavier = 0.07 * VOLUME * (AIR - 0.1664)
    assert changed.mass - VEHICLE.mass == pytest.approx(heavier, rel=1e-12)
    assert heavier == pytest.approx(0.0249, rel=2e-3)
    assert changed[1:] == VEHICLE[1:]


@pytest.mark.parametrize('module', [ballast, payload], ids=named)
def test_a_point_mass_is_one_point_more(module):
    generator = np.random.default_rng(3)
    masses, places = generator.uniform(0.01, 0.1, 7), generator.normal(size=(7, 3))
    before = of_points(masses[:6], places[:6], 0.4)
    after = of_points(masses, places, 0.4)
    changed = module.change_body((masses[6], *places[6]), before)
    for name in RigidBody._fields:
        np.testing.assert_allclose(
            getattr(changed, name), getattr(after, name), rtol=1e-12, atol=1e-15
        )


def test_ballast_taken_off_and_put_back_is_none():
    less = ballast.change_body((-0.02, 0.1, 0.0, -0.4), VEHICLE)
    assert less.mass == pytest.approx(VEHICLE.mass - 0.02, rel=1e-15)
    again = ballast.change_body((0.02, 0.1, 0.0, -0.4), less)
    np.testing.assert_allclose(again.inertia, VEHICLE.inertia, rtol=1e-12)
