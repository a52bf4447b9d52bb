"""Moments of the parameters of a flight against those of their joint normal distribution."""

from lta_discovery.state_filter.likelihood import build_moments_root, ParameterPrior
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
