"""Steps of the parameters, and their moments against those of their joint distribution."""

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


def test_a_step_moves_the_others_as_is_best_beside_what_is_at_its_bound() -> None:
    """Without bounds the step is (2, -1); beside 0.5, the second is best at (0 - 0.5) / 2."""
    inner, pull = np.array([[2.0, 1.0], [1.0, 2.0]]), np.array([3.0, 0.0])
    deviation, far = np.ones(2), np.full(2, np.inf)
    own = np.zeros(2, dtype=np.bool_)
    free = ParameterPrior(deviation, -far, far, own)
    bounded = ParameterPrior(deviation, -far, np.array([0.5, np.inf]), own)
    np.testing.assert_allclose(free.step(np.zeros(2), inner, pull), [2.0, -1.0])
    np.testing.assert_allclose(bounded.step(np.zeros(2), inner, pull), [0.5, -0.25])
    np.testing.assert_allclose(free.step(np.zeros(2), inner, pull, longest=0.5), [0.5, -0.5])
    np.testing.assert_allclose(free.step(np.zeros(2), inner, pull, 1.0), [0.8, -0.2])
