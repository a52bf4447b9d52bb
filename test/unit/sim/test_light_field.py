# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Light by hand: the paper's figures, total flux, an echo; volts and noise of photodiodes."""

import math

from lta_model.light.lamp import BeaconLamp, direct_illuminance, SquareWave
from lta_model.sensors.photodiode import PhotodiodeArray, voltage_sensitivity
import numpy as np
import pytest

from .diode_noise import noise_volts

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


RING = {'count': 8, 'depth': 0.33, 'radius': 0.05, 'feedback_resistance': 1e5}


def ring(**given) -> PhotodiodeArray:
    """Return a ring of eight photodiodes, with other numbers where given."""
    return PhotodiodeArray(**{**RING, **given})


PLAIN = ring(feedback_resistance=1e6)


def test_volts_of_one_lux_by_hand():
    # 1/300 W/m^2 on 5.2 mm^2: 17.33 nW, times 0.37398 A/W: 6.4823 nA, times 1 Mohm.
    assert voltage_sensitivity(PLAIN, 300.0) == pytest.approx(6.4823e-3, rel=1e-4)
    small = ring(feedback_resistance=47e3)
    assert voltage_sensitivity(small, 300.0) == pytest.approx(6.4823e-3 * 0.047, rel=1e-4)
    # 1/105 W/m^2 of sunlight: 49.52 nW, times 0.31606 A/W.
    assert voltage_sensitivity(PLAIN, 105.0) == pytest.approx(15.653e-3, rel=1e-4)


def test_the_amplifier_saturates_before_a_converter_with_its_own_supply():
    # 5 V less 1.15 V is beyond the converter's 3.3 V; 3.3 V less 1.15 V is 65 % of them.
    assert ring().largest_reading == 4095.0
    assert ring(output_limit=2.15).largest_reading == round(2.15 / 3.3 * 4096) == 2669


def test_noise_in_the_dark_is_the_data_sheets():
    assert noise_volts(PLAIN, 0.0) == pytest.approx(300e-6, rel=1e-12)
    small = ring(feedback_resistance=10e3)
    assert noise_volts(small, 0.0) == pytest.approx(30e-6, rel=1e-12)


def test_shot_noise_by_hand():
    # 1 V at 1 Mohm is 1 uA; B = 21 991 Hz; 2 q I B = 7.047e-21 A^2: 83.9 pA, 83.9 uV.
    quiet = ring(feedback_resistance=1e6, noise=0.0)
    assert noise_volts(quiet, 1.0) == pytest.approx(83.95e-6, rel=1e-3)
    # The same current through a tenth of the resistor gives a tenth of the noise.
    tenth = ring(feedback_resistance=1e5, noise=0.0)
    assert noise_volts(tenth, 0.1) == pytest.approx(8.395e-6, rel=1e-3)


def test_ring_looks_around_and_hangs_below():
    array = ring(count=4, depth=0.3, radius=0.1)
    points, axes = array.transform_to_map(np.array([1.0, 2.0, 3.0]), np.eye(3))
    hand = [[1, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0]]
    assert axes == pytest.approx(np.array(hand, dtype=float), abs=1e-15)
    assert points == pytest.approx(np.array([1.0, 2.0, 2.7]) + 0.1 * np.array(hand), abs=1e-15)


def test_ring_tilts_with_the_drone():
    # Nose down by 90 degrees (positive pitch): forward looks down, the ring swings back.
    pitch = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
    points, axes = ring(count=4, radius=0.0).transform_to_map(np.zeros(3), pitch)
    assert axes[0] == pytest.approx([0.0, 0.0, -1.0], abs=1e-15)
    assert points[0] == pytest.approx([-0.33, 0.0, 0.0], abs=1e-15)


def test_many_poses_are_as_one_by_one():
    generator = np.random.default_rng(1)
    positions = generator.normal(size=(5, 3))
    rotations = np.linalg.qr(generator.normal(size=(5, 3, 3)))[0]
    array = ring()
    points, axes = array.transform_to_map(positions, rotations)
    assert points.shape == axes.shape == (5, 8, 3)
    for k in range(5):
        one = array.transform_to_map(positions[k], rotations[k])
        assert points[k] == pytest.approx(one[0], abs=1e-14)
        assert axes[k] == pytest.approx(one[1], abs=1e-14)
