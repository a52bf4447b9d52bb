"""Volts, noise and where the diodes look, by hand."""

import math

from lta_model.sensors.photodiode import PhotodiodeArray, voltage_sensitivity
import numpy as np
from pydantic import ValidationError
import pytest

from .diode_noise import noise_volts

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


@pytest.mark.parametrize(
    'change',
    [
        {'count': 0},
        {'radius': -0.1},
        {'depth': math.nan},
        {'feedback_resistance': 0.0},
        {'bandwidth': -1.0},
        {'bandwidth': math.inf},
        {'adc_bits': 17},
        {'resistance': 1.0},
    ],
)
def test_what_is_no_ring_is_refused(change):
    with pytest.raises(ValidationError, match=next(iter(change))):
        ring(**change)
