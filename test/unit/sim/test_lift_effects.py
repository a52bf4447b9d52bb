"""Values of the lift effects by hand and by the gas law."""

from lta_model.effects.gas import AIR_STATE, GAS_PURITY, GAS_STATE, SUPERHEAT
from lta_model.effects.protocol import RigidBody
import numpy as np
import pytest

from . import still_air as air

G = 9.80665
THRUST = (0.0,) * 8
# The mylar shape of 1 m: 0.343225 m3 of air at 20 C, and what R = 2077.1 J/(kg K) makes of helium.
VOLUME, AIR = 0.343225, 1.2041
HELIUM = 101325.0 / (2077.1 * 293.15)
VEHICLE = RigidBody(
    0.413, (0.001, -0.002, -0.03), (0.03, 0.031, 0.032, 1e-4, 2e-4, 3e-4), VOLUME * AIR
)
TILTED = air.turned((0.4, 0.3, -0.2))


def test_superheat_is_the_weight_of_the_air_that_slack_gas_displaces():
    """A mass of helium at the pressure of the air, 293.15 K and then 9 K warmer."""
    gas = HELIUM * VOLUME
    cold, warm = (gas * 2077.1 * kelvin / 101325.0 for kelvin in (293.15, 302.15))
    seen = air.motion(TILTED, displaced=VOLUME * AIR)
    wrench = SUPERHEAT.wrench((0.02, 70.0, 1.0), (9.0,), seen, THRUST)
    np.testing.assert_allclose(wrench[:3], (warm - cold) * AIR * G * air.up(TILTED), rtol=1e-12)
    assert SUPERHEAT.wrench((0.02, 70.0, 0.0), (9.0,), seen, THRUST) == (0.0,) * 6
    half = SUPERHEAT.wrench((0.02, 70.0, 0.5), (9.0,), seen, THRUST)
    np.testing.assert_allclose(half, 0.5 * np.array(wrench), rtol=1e-14)


def density(pascal, kelvin):
    return pascal / (287.05 * kelvin)


@pytest.mark.parametrize(('pascal', 'kelvin'), [(1500.0, 0.0), (0.0, 8.0), (-3e3, -12.0)])
def test_a_taut_hull_displaces_air_of_the_new_density(pascal, kelvin):
    changed = AIR_STATE.change((pascal, kelvin, 0.0), VEHICLE)
    ratio = density(101325.0 + pascal, 293.15 + kelvin) / density(101325.0, 293.15)
    assert changed.displaced == pytest.approx(ratio * VEHICLE.displaced, rel=1e-14)
    assert changed[:3] == VEHICLE[:3]


def test_a_slack_hull_displaces_the_same_mass_of_any_air():
    assert AIR_STATE.change((-5e3, 20.0, 1.0), VEHICLE) == VEHICLE


def test_gas_follows_the_gas_law_at_the_volume_of_the_hull():
    gas = HELIUM * VOLUME
    changed = GAS_STATE.change((gas, 6.0, 800.0), VEHICLE)
    filled = 102125.0 * VOLUME / (2077.1 * 299.15)
    assert changed.mass - VEHICLE.mass == pytest.approx(filled - gas, rel=1e-9)
    assert changed[1:] == VEHICLE[1:]
    assert GAS_STATE.change((gas, 0.0, 0.0), VEHICLE) == VEHICLE


def test_air_in_the_helium_weighs():
    changed = GAS_PURITY.change((-0.07,), VEHICLE)
    heavier = 0.07 * VOLUME * (AIR - 0.1664)
    assert changed.mass - VEHICLE.mass == pytest.approx(heavier, rel=1e-12)
    assert heavier == pytest.approx(0.0249, rel=2e-3)
    assert changed[1:] == VEHICLE[1:]
