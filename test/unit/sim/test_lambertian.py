# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Compiled light against the arrays of `light.field`, and counts against plain Python."""

from lta_config.compilation.compiler import compile_functions
from lta_model.light.direct_light import DiodeResponse
from lta_model.light.field import Ambient, LightField
from lta_model.light.lamp import BeaconLamp, direct_illuminance, SquareWave
from lta_model.light.readings import write_pose_readings
from lta_model.light.reflected_light import DAYLIGHT_ROW, LAMP_ROWS, UNIFORM_ROW
from lta_model.light.view import build_field_geometry, pack_beams
from lta_model.rigid_body import rotation_matrix
from lta_model.sensors.photodiode import PhotodiodeArray
from lta_model.sensors.photodiode_adc import convert_to_counts
import numpy as np

LAMP = BeaconLamp((3.5, 0.5, 1.0), (-2.0, 0.3, 0.1), 10_000.0, SquareWave(150.0), 300.0, order=1.7)
OTHER = BeaconLamp((-3.0, 2.0, 2.5), (1.0, -0.5, -0.3), 3000.0, SquareWave(210.0), 300.0)
RING = PhotodiodeArray(count=8, depth=0.33, radius=0.07, feedback_resistance=1e5)


def poses(count, seed=1):
    rng = np.random.default_rng(seed)
    turns = rng.standard_normal((count, 4))
    turns /= np.linalg.norm(turns, axis=1)[:, None]
    return np.hstack([rng.uniform(-2.0, 2.0, (count, 3)), turns])


def test_a_ring_is_lit_as_by_the_arrays():
    field = LightField((LAMP, OTHER), Ambient(300.0))
    flight = poses(11)
    turns = np.array([rotation_matrix(tuple(pose[3:])) for pose in flight]).reshape(-1, 3, 3)
    place = RING.transform_to_map(flight[:, :3], turns)
    for function in (write_pose_readings, compile_functions(write_pose_readings)[0]):
        before, later, lit = np.zeros((4, 8)), np.zeros((4, 8)), np.empty((2, 11, 8))
        later[UNIFORM_ROW], later[DAYLIGHT_ROW], later[LAMP_ROWS] = 0.5, 30.0, 4.0
        steady, mains = np.empty((11, 8)), np.empty((11, 8))
        function(
            build_field_geometry(field), pack_beams(field), DiodeResponse(1.0, 0.0),
            (0.0, 0.0, 0.0), flight, RING.planes, before, later,
            (100.0, 20.0, 2.0), lit, steady, mains,
        )  # fmt: skip
        part = np.linspace(0.0, 1.0, 11)[:, None]  # what is gathered changes evenly on the way
        np.testing.assert_allclose(
            lit[0], direct_illuminance(LAMP, *place) + 4.0 * part, rtol=1e-12
        )
        np.testing.assert_allclose(lit[1], direct_illuminance(OTHER, *place), rtol=1e-12)
        np.testing.assert_allclose(steady, np.broadcast_to(110.0 * part, (11, 8)), rtol=1e-12)
        np.testing.assert_allclose(mains, np.broadcast_to(10.0 * part, (11, 8)), rtol=1e-12)


def test_counts_round_to_the_nearest():
    """Halves go to even: 2.5 to 2, 3.5 to 4; beyond the ends they stay there."""
    numbers = (0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 15.0)
    volts = np.array([[2.5, 3.5, 2.51, 14.6, -3.0, 99.0]])
    zero, block = np.zeros_like(volts), np.empty((1, 6), dtype=np.uint16)
    wave, flicker, chance = np.zeros((1, 2)), np.zeros(1), np.zeros((1, 6))
    scratch = np.empty((2, 6))
    convert_to_counts(
        zero[None], volts, zero, wave, flicker, chance, numbers, zero[0], block, scratch
    )
    assert block.tolist() == [[2, 4, 3, 15, 0, 15]]
