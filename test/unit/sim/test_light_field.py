"""Light by hand: the paper's figures at its distances, the lamp's total flux, a room's echo."""

import math

from lta_model.light.field import Room, uniform_albedo
from lta_model.light.lamp import BeaconLamp, direct_illuminance, SquareWave
import numpy as np
import pytest

LED = 300.0  # lm/W
WAVE = SquareWave(150.0)
LAMP = BeaconLamp((0.0, 0.0, 1.0), (1.0, 0.0, 0.0), 10_000.0, WAVE, LED)
TO_LAMP = np.array([-1.0, 0.0, 0.0])


def at(distance: float, angle: float = 0.0) -> np.ndarray:
    """Return a point at the lamp's height, off its axis by an angle."""
    return np.array([distance * math.cos(angle), distance * math.sin(angle), 1.0])


@pytest.mark.parametrize(
    ('distance', 'lux', 'tolerance'),
    [
        (7.0, 64.96, 0.01),  # 10 000 / (pi 49)
        (1.0, 3183.1, 1.0),
        (0.42, 18.0e3, 0.1e3),  # as the paper's array test
        (0.20, 80.0e3, 1.0e3),  # as its harvest test
    ],
)
def test_on_axis_by_hand(distance, lux, tolerance):
    assert direct_illuminance(LAMP, at(distance), TO_LAMP) == pytest.approx(lux, abs=tolerance)


def test_half_power_at_sixty_degrees():
    angle = math.radians(60.0)
    ray = np.array([-math.cos(angle), -math.sin(angle), 0.0])
    ratio = direct_illuminance(LAMP, at(5.0, angle), ray) / direct_illuminance(
        LAMP, at(5.0), TO_LAMP
    )
    assert ratio == pytest.approx(0.5, rel=1e-12)


def test_tilted_plane_gets_the_cosine():
    normal = np.array([-math.cos(0.8), 0.0, math.sin(0.8)])
    ratio = direct_illuminance(LAMP, at(5.0), normal) / direct_illuminance(LAMP, at(5.0), TO_LAMP)
    assert ratio == pytest.approx(math.cos(0.8), rel=1e-12)


@pytest.mark.parametrize('order', [1.0, 2.0, 5.5])
def test_all_the_flux_arrives(order):
    lamp = BeaconLamp((0.0, 0.0, 0.0), (0.0, 0.0, 2.0), 10_000.0, WAVE, LED, order=order)
    # Light through a sphere of 10 m, by Gauss-Legendre over the cosine of the angle.
    nodes, weights = np.polynomial.legendre.leggauss(60)
    cosine = 0.5 * (nodes + 1.0)
    outwards = np.stack([np.sqrt(1.0 - cosine**2), 0.0 * cosine, cosine], axis=-1)
    lux = direct_illuminance(lamp, 10.0 * outwards, -outwards)
    flux = 2.0 * math.pi * 100.0 * (0.5 * weights * lux).sum()
    # The disc of 15 mm takes (0.015 / 10)^2 off.
    assert flux == pytest.approx(10_000.0, rel=5e-6)


def test_nothing_behind_the_lamp_or_the_plane():
    assert direct_illuminance(LAMP, np.array([-2.0, 0.0, 1.0]), -TO_LAMP) == 0.0
    assert direct_illuminance(LAMP, at(2.0), -TO_LAMP) == 0.0


def test_light_is_finite_at_the_lamp():
    # On the disc itself Phi / (pi r^2), the limit of its own formula.
    close = direct_illuminance(LAMP, at(1e-9), TO_LAMP)
    assert close == pytest.approx(10_000.0 / (math.pi * 0.015**2), rel=1e-9)
    assert direct_illuminance(LAMP, np.array(LAMP.position), TO_LAMP) == 0.0


def test_disc_is_exact_on_its_axis():
    # Sum over rings of the disc at 3 cm: L cos^4 / d^2 dA, with L = Phi / (pi A).
    radius = (np.arange(20_000) + 0.5) * (0.015 / 20_000)
    distance = np.hypot(0.03, radius)
    radiance = 10_000.0 / (math.pi * math.pi * 0.015**2)
    rings = radiance * (0.03 / distance) ** 2 / distance**2 * 2.0 * math.pi * radius
    lux = rings.sum() * 0.015 / 20_000
    assert direct_illuminance(LAMP, at(0.03), TO_LAMP) == pytest.approx(lux, rel=1e-7)


def test_echo_of_the_shared_room_by_hand():
    # 268 m^2 of surface: 10 000 x 0.5 / (268 x 0.5).
    assert Room((10.0, 8.0, 3.0), uniform_albedo(0.5)).diffuse_illuminance(
        10_000.0
    ) == pytest.approx(37.3134, abs=1e-4)


def test_echo_is_the_sum_of_all_bounces():
    room, bounced = Room((10.0, 8.0, 3.0), uniform_albedo(0.7)), 0.0
    for bounce in range(1, 200):
        bounced += 10_000.0 * 0.7**bounce / 268.0
    assert room.diffuse_illuminance(10_000.0) == pytest.approx(bounced, rel=1e-12)


def test_many_points_are_as_one_by_one():
    generator = np.random.default_rng(2)
    points = generator.uniform(-4.0, 4.0, size=(11, 8, 3))
    normals = generator.normal(size=(11, 8, 3))
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    lux = direct_illuminance(LAMP, points, normals)
    assert lux.shape == (11, 8)
    for i in range(11):
        for j in range(8):
            assert direct_illuminance(LAMP, points[i, j], normals[i, j]) == pytest.approx(
                lux[i, j], rel=1e-12
            )
