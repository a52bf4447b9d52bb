"""Blimp2b (Zufferey 2006) by kernel flights: where its published numbers say it settles."""

import math

from lta_sim import kernel
from lta_sim.effects import initial_memory
from lta_sim.state import pack
from lta_sim.vehicle import load_vehicle
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

G = 9.80665
SURGE = math.sqrt(0.0400 / 0.07)  # 0.756 m/s


@pytest.fixture(scope='module')
def vehicle():
    return load_vehicle('blimp2b')


def flown(vehicle, duty, wind=(0.0, 0.0, 0.0), seconds=240.0):
    """Return the state after so long at constant duties, from rest on the ground's axes."""
    state = pack((0.0, 0.0, 100.0), memory=initial_memory())
    count = round(seconds / 2e-3)
    return kernel.advance(state, vehicle.model(), vehicle.command(duty), wind, 2e-3, count)


def over_ground(state):
    return Rotation.from_quat(state[3:7]).apply(state[7:10])


def test_full_surge_climbs_by_the_tilt_of_its_propeller(vehicle):
    """It is neutral, so only the moment of the thrust pitches it: m g 0.125 sin = T 0.269."""
    state = flown(vehicle, (1, 0, 0))
    pitch = math.asin(0.0400 * 0.269 / (0.184 * G * 0.125))
    assert math.degrees(pitch) == pytest.approx(2.73, abs=0.01)
    nose = Rotation.from_quat(state[3:7]).apply((1.0, 0.0, 0.0))
    assert math.asin(nose[2]) == pytest.approx(pitch, rel=1e-4)
    expected = (SURGE * math.cos(pitch), 0.0, SURGE * math.sin(pitch))
    np.testing.assert_allclose(over_ground(state), expected, atol=1e-4)


@pytest.mark.parametrize('wind', [(0.5, 0.0, 0.0), (-0.4, 0.3, 0.0)])
def test_surge_in_wind_is_surge_through_the_air(vehicle, wind):
    """Started at rest in the wind it turns on the way, but its airspeed settles at the same."""
    state = flown(vehicle, (1, 0, 0), wind)
    through = Rotation.from_quat(state[3:7]).inv().apply(over_ground(state) - wind)
    assert through[0] == pytest.approx(SURGE, rel=1e-3)
    assert np.linalg.norm(through[1:]) < 2e-3 * SURGE


def test_it_drifts_with_the_wind(vehicle):
    """No thrust: quadratic drag leaves 1 / (1 / w + D t / (m + m_a)) of the wind w across it."""
    wind, seconds = 0.6, 240.0
    state = flown(vehicle, (0, 0, 0), (0.0, wind, 0.0), seconds)
    assert 0.0 < wind - over_ground(state)[1] < 0.02 * wind
    assert np.linalg.norm(over_ground(state)[[0, 2]]) < 0.02 * wind


@pytest.mark.parametrize(('surplus', 'sign'), [(0.002, -1.0), (-0.002, 1.0)])
def test_terminal_velocity(vehicle, surplus, sign):
    """2 g too heavy or too light: sqrt(2 g / 0.22 N s2/m2) = 0.299 m/s down or up."""
    body = {'mass': vehicle.mass, 'cg': vehicle.cg, 'inertia': vehicle.inertia}
    model = kernel.Model.build(vehicle.effects(), displaced=vehicle.mass - surplus, **body)
    state = pack((0.0, 0.0, 200.0), memory=initial_memory())
    state = kernel.advance(state, model, (), np.zeros(3), 2e-3, 60_000)
    terminal = math.sqrt(abs(surplus) * G / 0.22)
    assert terminal == pytest.approx(0.2986, abs=1e-4)
    assert state[9] == pytest.approx(sign * terminal, rel=1e-9)
