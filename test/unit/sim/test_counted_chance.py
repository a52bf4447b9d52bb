# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Counted chance is Threefry's, the same compiled, and what comes out of it is as declared."""

import math

from lta_sim.compiled_sensors import draw_normals, draw_uniforms, threefry
import numpy as np
import pytest

DRAWS = 4000


@pytest.mark.parametrize(
    ('key', 'counter', 'bits'),
    [
        ((0, 0), (0, 0), (0x6B200159, 0x99BA4EFE)),
        ((0xFFFFFFFF, 0xFFFFFFFF), (0xFFFFFFFF, 0xFFFFFFFF), (0x1CB996FC, 0xBB002BE7)),
        ((0x13198A2E, 0x03707344), (0x243F6A88, 0x85A308D3), (0xC4923A9C, 0x483DF7A0)),
    ],
)
def test_it_gives_the_known_answers_of_its_authors(key, counter, bits):
    # Random123, tests/kat_vectors, threefry2x32 with 20 rounds.
    assert threefry(*key, *counter) == bits


def test_normal_deviates_are_normal_and_those_of_other_streams_are_others():
    values = np.array([draw_normals(5, 2, k, 0) for k in range(DRAWS)])
    error = 1.0 / math.sqrt(DRAWS)
    np.testing.assert_allclose(values.mean(axis=0), 0.0, atol=4 * error)
    np.testing.assert_allclose(values.std(axis=0), 1.0, atol=4 * error)
    np.testing.assert_allclose((values**4).mean(axis=0), 3.0, atol=4 * math.sqrt(96) * error)
    others = [
        np.array([draw_normals(*name, k, lane)[0] for k in range(DRAWS)])
        for name, lane in (((6, 2), 0), ((5, 3), 0), ((5, 2), 1))
    ]
    for other in (values[:, 1], values[1:, 0], *others):
        assert abs(np.corrcoef(values[: len(other), 0], other)[0, 1]) < 4 * error


def test_uniform_numbers_are_between_their_ends():
    values = np.array([draw_uniforms(1, 0, k, 0) for k in range(DRAWS)])
    assert values.min() > 0.0
    assert values.max() < 1.0
    np.testing.assert_allclose(values.mean(axis=0), 0.5, atol=4 * math.sqrt(1 / 12 / DRAWS))
