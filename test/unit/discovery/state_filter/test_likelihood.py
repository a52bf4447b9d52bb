# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Moments of the parameters of a flight against those of their joint normal distribution."""

from lta_discovery.state_filter.kalman import FilteredFlight
from lta_discovery.state_filter.likelihood import build_moments_root, list_pulls, ParameterPrior
import numpy as np

DEVIATIONS = np.array([0.5, 0.0, 0.8, 0.3, 2.0])
OWN = np.array([False, False, False, True, True])


def test_a_root_of_the_moments_is_that_of_shared_and_own_parameters() -> None:
    """The second parameter is held, the last two are those of the flight."""
    rng = np.random.default_rng(4)
    rows = rng.standard_normal((30, len(OWN) + 1))
    products = rows.T @ rows
    none = np.full(len(OWN), np.inf)
    prior = ParameterPrior(DEVIATIONS, -none, none, OWN)
    acting = np.flatnonzero(DEVIATIONS > 0.0)
    precision = products[np.ix_(acting, acting)] + np.diag(DEVIATIONS[acting] ** -2.0)
    covariance = np.linalg.inv(precision)
    mean = np.zeros(len(OWN))
    mean[acting] = -covariance @ products[acting, -1]
    root = np.linalg.cholesky(covariance[:2, :2])
    out = build_moments_root(products, prior, np.where(OWN, 0.0, mean), root)
    wanted = np.zeros((len(OWN) + 1, len(OWN) + 1))
    wanted[np.ix_(acting, acting)] = covariance
    wanted += np.outer(np.append(mean, 1.0), np.append(mean, 1.0))
    np.testing.assert_allclose(out @ out.T, wanted, rtol=1e-9, atol=1e-12)


def test_pulls_of_pieces_are_those_beside_what_a_flight_has_of_its_own() -> None:
    """Three pieces of whitened readings, by least squares with two unknowns of the flight."""
    rows = np.random.default_rng(6).standard_normal((30, len(OWN) + 1))
    pieces = [rows[:8], rows[8:13], rows[13:]]
    sums = np.stack([rows[:end].T @ rows[:end] for end in (8, 13)])
    none = np.zeros((0, 0, 0))
    filtered = FilteredFlight(rows.T @ rows, 0.0, none, sums, none)
    away = np.full(len(OWN), np.inf)
    pulls = list_pulls(filtered, ParameterPrior(DEVIATIONS, -away, away, OWN))
    own = np.flatnonzero(OWN)
    # The prior of an unknown is one more reading
    design = np.concatenate([rows[:, own], np.diag(1.0 / DEVIATIONS[own])])
    both = np.concatenate([rows, np.zeros((len(own), rows.shape[1]))])
    slopes = np.linalg.lstsq(design, both)[0]
    wanted = [-(one - one[:, own] @ slopes).T @ (one - one[:, own] @ slopes) for one in pieces]
    shared = np.flatnonzero(~OWN)
    for found, one in zip(pulls, wanted, strict=True):
        np.testing.assert_allclose(found[shared], one[shared, -1], rtol=1e-9)
        assert not found[own].any()
