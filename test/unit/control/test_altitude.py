# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The altitude filter against matrices, and its honesty against noise that is what it believes."""

from lta_control.motion_filters import AltitudeEstimate, correct_altitude, predict_altitude
import numpy as np

DT = 0.01
UPPER = np.triu_indices(3)


def matrix(p):
    full = np.zeros((3, 3))
    full[UPPER] = p
    return full + full.T - np.diag(np.diag(full))


def kalman_predict(x, P, a, noise, walk):
    F = np.array([[1.0, DT, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
    G = np.array([0.5 * DT**2, DT, 0.0])
    Q = np.outer(G, G) * noise**2 + np.diag([0.0, 0.0, walk**2 * DT])
    return F @ x + G * a, F @ P @ F.T + Q


def kalman_correct(x, P, z, noise, H):
    H = np.array([H])
    K = P @ H.T / (H @ P @ H.T + noise**2)
    return x + K[:, 0] * (z - H @ x), (np.eye(3) - K @ H) @ P


def test_it_is_the_kalman_filter_of_matrices():
    generator = np.random.default_rng(7)
    state = AltitudeEstimate()
    x, P = np.zeros(3), matrix(state.p)
    for k in range(400):
        a = float(generator.normal())
        state = predict_altitude(state, a, 0.15, 0.02, DT)
        x, P = kalman_predict(x, P, a, 0.15, 0.02)
        if k % 3 == 0:
            z = float(generator.normal(0.5, 0.1))
            state = correct_altitude(state, z, 0.01, False)
            x, P = kalman_correct(x, P, z, 0.01, (1.0, 0.0, 0.0))
        if k % 2 == 0:
            z = float(generator.normal(0.7, 0.3))
            state = correct_altitude(state, z, 0.15, True)
            x, P = kalman_correct(x, P, z, 0.15, (1.0, 0.0, 1.0))
        np.testing.assert_allclose((state.height, state.climb, state.offset), x, atol=1e-12)
        np.testing.assert_allclose(matrix(state.p), P, atol=1e-12)


def flight(generator, steps=150):
    """Return estimate and truth after a flight whose noise is what the filter believes."""
    first = matrix(AltitudeEstimate().p)
    truth = generator.multivariate_normal(np.zeros(3), first)
    state = AltitudeEstimate()
    for k in range(steps):
        a = generator.normal(0.0, 0.3)
        truth[0] += DT * truth[1] + 0.5 * DT**2 * a
        truth[1] += DT * a
        truth[2] += 0.02 * np.sqrt(DT) * generator.normal()
        state = predict_altitude(state, a + 0.15 * generator.normal(), 0.15, 0.02, DT)
        if k % 2 == 0:
            z = truth[0] + truth[2] + 0.15 * generator.normal()
            state = correct_altitude(state, z, 0.15, True)
        if k % 5 == 0:
            state = correct_altitude(state, truth[0] + 0.01 * generator.normal(), 0.01, False)
    return state, truth
