"""Flights of a balloon whose lift changes, against closed forms."""

from lta_model.state import IRRADIANCE, POSITION, RATES, SURROUNDINGS, VELOCITY
from lta_sim.kernels.kernel import advance
from lta_sim.simulated_vehicle import LAYOUT
import numpy as np
import pytest

from . import flat_balloon as balloon

OFF = np.zeros(4)
CALM = np.zeros(3)
NEUTRAL = balloon.NEUTRAL | balloon.ADDED
MOVED = balloon.MASS + balloon.ADDED['added_mass']['heave']  # kg, going up or down
LIFT = balloon.MASS * balloon.G


def flown(given, seconds, surroundings=CALM, dt=2e-3):
    """Return how a neutral balloon at rest at 0 m has moved, and its state."""
    model = balloon.model(NEUTRAL | given, displaced=balloon.MASS)
    start = balloon.at((0.0, 0.0, 0.0))
    return advance(start, model, OFF, surroundings, dt, round(seconds / dt))


def level(state):
    return not np.any(state[POSITION][:2]) and not np.any(state[RATES])


def test_a_neutral_balloon_stays():
    state = flown({}, 60.0)
    np.testing.assert_allclose(state[POSITION], 0.0, atol=1e-9)


def test_a_leak_sinks_it_with_the_cube_of_time():
    state = flown({'helium_leak': {'rate': 1e-4}}, 20.0)
    assert state[LAYOUT.remembers['helium_leak']] == pytest.approx(2e-3, rel=1e-12)
    assert state[2] == pytest.approx(-1e-4 * 20.0**3 / (6.0 * MOVED), rel=1e-10)
    assert level(state)


def test_net_lift_lifts():
    state = flown({'net_lift': {'force': 0.02}}, 3.0)
    assert state[2] == pytest.approx(0.5 * 0.02 / MOVED * 9.0, rel=1e-11)
    assert level(state)


@pytest.mark.parametrize('effect', ['payload', 'ballast'])
def test_two_grams_fall_with_all_that_must_be_moved(effect):
    state = flown({effect: {'mass': 0.002, 'z': -0.4}}, 3.0)
    fall = 0.002 * balloon.G / (MOVED + 0.002)
    assert state[VELOCITY][2] == pytest.approx(-fall * 3.0, rel=1e-11)
    assert level(state)


def test_light_lifts_a_slack_balloon_as_its_gas_warms():
    """0.02 K m2/W under 600 W/m2 are 12 K in the end; velocity and height integrated by hand."""
    lit = np.zeros(SURROUNDINGS)
    lit[IRRADIANCE] = 600.0
    lag, t = 8.0, 20.0
    given = {'superheat': {'warming': 0.02, 'lag': lag, 'slack': 0.7}}
    state = flown(given, t, lit)
    gone = np.exp(-t / lag)
    assert state[LAYOUT.remembers['superheat']] == pytest.approx(12.0 * (1 - gone), rel=1e-10)
    most = 0.7 * LIFT * 12.0 / 293.15 / MOVED
    assert state[VELOCITY][2] == pytest.approx(most * (t - lag * (1 - gone)), rel=1e-9)
    height = most * (t**2 / 2 - lag * t + lag**2 * (1 - gone))
    assert state[2] == pytest.approx(height, rel=1e-9)
    assert level(state)
    np.testing.assert_array_equal(flown(given | {'superheat': {'slack': 0.0}}, t, lit)[2], 0.0)


def test_air_of_another_density_carries_more_or_less():
    state = flown({'air_state': {'temperature': 3.0, 'pressure': 500.0}}, 3.0)
    more = (101825.0 / 101325.0) * (293.15 / 296.15) - 1.0
    assert state[VELOCITY][2] == pytest.approx(more * LIFT / MOVED * 3.0, rel=1e-9)


def test_impure_gas_is_heavier_and_slower():
    state = flown({'gas_purity': {'purity': -0.01}}, 3.0)
    air = 0.01 * (1.0 - 0.1664 / 1.2041) * balloon.MASS
    assert state[VELOCITY][2] == pytest.approx(-air * balloon.G / (MOVED + air) * 3.0, rel=1e-10)


def test_warm_gas_under_pressure():
    state = flown({'gas_state': {'gas': 0.07, 'temperature': 5.0, 'overpressure': 300.0}}, 3.0)
    more = 0.07 * ((101625.0 / 101325.0) * (293.15 / 298.15) - 1.0)
    assert state[VELOCITY][2] == pytest.approx(-more * balloon.G / (MOVED + more) * 3.0, rel=1e-9)
