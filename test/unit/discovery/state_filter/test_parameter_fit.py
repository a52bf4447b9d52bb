"""Fits of linear flights against the posterior distribution, computed densely."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter
from lta_discovery.state_filter.forecast_sums import weigh_errors
from lta_discovery.state_filter.linear_flight import LinearFlight
from lta_discovery.state_filter.parameter_fit import fit_likelihood
import numpy as np
from numpy.typing import NDArray
import pytest
from scipy.linalg import block_diag
from scipy.stats import multivariate_normal

from .dense_gaussian import build_dense, build_flight, NOISE, PARAMETERS

Array = NDArray[np.float64]

DEVIATIONS = np.array([0.5, 0.3, 0.8])
OWN = 2  # the parameter that each flight has of its own


class LinearSystem:
    """A flight that is linear in its parameters, so that one Gauss-Newton step is exact."""

    def __init__(self, flight: LinearFlight) -> None:
        self._flight = flight
        self.parameters = [
            FreeParameter(
                f'effect.{k}', '1', {('effect', str(k)): 1.0}, 1.0, 1.0, float(deviation),
                per_flight=k == OWN,
            )
            for k, deviation in enumerate(DEVIATIONS)
        ]  # fmt: skip

    def linearize(self, _nominal: NominalVehicle, values: Array) -> LinearFlight:
        """Return the flight as seen from some values."""
        at = self._flight
        return replace(
            at, defect=at.defect + at.moved @ values, left=at.left - at.read_moved @ values
        )


def test_a_fit_is_the_posterior_of_the_parameters() -> None:
    """Of two flights that share two parameters and have a third one each."""
    # Their first states do not depend on the parameters
    flights = [build_flight(seed) for seed in (11, 12)]
    flights = [replace(one, begun=0.0 * one.begun) for one in flights]
    systems: Any = [LinearSystem(one) for one in flights]
    nominal: Any = SimpleNamespace()
    fit = fit_likelihood(systems, nominal, np.zeros(PARAMETERS), [NOISE, NOISE], learning=())
    dense = [build_dense(one, NOISE) for one in flights]
    # Unknowns: the two shared ones, then that of each flight
    design = np.concatenate([one.design[:, :OWN] for one in dense])
    design = np.column_stack([design, block_diag(*(one.design[:, OWN:] for one in dense))])
    values = np.concatenate([one.values for one in dense])
    own = block_diag(*(one.covariance for one in dense))
    prior = np.diag(np.concatenate([DEVIATIONS[:OWN], DEVIATIONS[[OWN, OWN]]]) ** 2.0)
    weight = np.linalg.inv(own)
    covariance = np.linalg.inv(design.T @ weight @ design + np.linalg.inv(prior))
    mean = covariance @ design.T @ weight @ values
    np.testing.assert_allclose(fit.values, [*mean[:OWN], 0.0], rtol=1e-6)
    np.testing.assert_allclose(fit.covariance[:OWN, :OWN], covariance[:OWN, :OWN], rtol=1e-6)
    for k, (each, spread) in enumerate(fit.own):
        assert each[OWN] == pytest.approx(mean[OWN + k], rel=1e-6)
        assert spread[OWN, OWN] == pytest.approx(covariance[OWN + k, OWN + k], rel=1e-6)
    evidence = multivariate_normal(np.zeros(len(values)), own + design @ prior @ design.T)
    wanted = evidence.logpdf(values) + 0.5 * len(values) * np.log(2.0 * np.pi)
    assert fit.evidence == pytest.approx(wanted, rel=1e-8)


def test_one_wild_forecast_weighs_like_a_linear_cost() -> None:
    """All errors have the size 1 of a normal median; one of 45 weighs by the root of 0.1."""
    errors = np.zeros((101, 1, 6, 2))
    errors[..., -1] = 0.6745
    errors[0, ..., -1] = 45.0
    errors[1] = np.nan
    weighed, size = weigh_errors(errors)
    np.testing.assert_allclose(size, 1.0, rtol=1e-3)
    assert weighed[2, 0, 0, -1] == pytest.approx(0.6745, rel=1e-3)
    # Attitudes weigh half
    assert weighed[2, 0, 3, -1] == pytest.approx(0.5 * 0.6745, rel=1e-3)
    assert weighed[0, 0, 0, -1] == pytest.approx(45.0 * 0.1**0.5, rel=1e-3)
    assert not weighed[1].any()
