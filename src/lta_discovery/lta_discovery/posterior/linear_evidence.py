# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
The evidence of all flights about one point, as a quadratic form, and that of models within it.

Of normal unknowns x with variances v, and readings whose log density is c + b x - x A x / 2, the
evidence is c + b (A + 1/v)^-1 b / 2 - log det(1 + v A) / 2.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import final, NamedTuple

from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.state_filter.kalman import FilteredFlight
from lta_discovery.state_filter.likelihood import eliminate_own, ParameterPrior
from lta_discovery.state_filter.noise_fit import log_prior_of_noise
from lta_discovery.state_filter.noise_model import NoiseModel
import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_triangular

Array = NDArray[np.float64]


@final
@dataclass(frozen=True, slots=True)
class LinearEvidence:
    """What all flights tell of K unknowns under one assumption about the noise."""

    information: Array  # A, shape (K, K)
    pull: Array  # b, of the unknowns themselves, not of their change; shape (K,)
    constant: float  # c [nats]

    @classmethod
    def of(
        cls,
        filtered: Sequence[FilteredFlight],
        noise: Sequence[NoiseModel],
        own: ParameterPrior,
        values: Array,
        nominal: NominalVehicle,
    ) -> 'LinearEvidence':
        """
        Return the evidence of filtered flights without what each has of its own.

        `values`: about which they are linearized, shape (K,).
        """
        information, pull = np.zeros((len(values), len(values))), np.zeros(len(values))
        constant = log_prior_of_noise(noise, nominal)
        for one in filtered:
            products, more = eliminate_own(one.products, own)
            information += products[:-1, :-1]
            pull -= products[:-1, -1]
            constant += more - 0.5 * one.log_determinant - 0.5 * float(products[-1, -1])
        constant -= float(pull @ values) + 0.5 * float(values @ information @ values)
        return cls(information, pull + information @ values, constant)

    def restrict(self, variance: Array) -> 'RestrictedEvidence':
        """Return the evidence of a model; unknowns of variance 0 are absent, shape (K,)."""
        free = np.flatnonzero(variance > 0.0)
        root = np.sqrt(variance[free])
        inner = self.information[np.ix_(free, free)] * np.outer(root, root)
        lower = np.linalg.cholesky(inner + np.eye(len(free)))
        white = solve_triangular(lower, self.pull[free] * root, lower=True, check_finite=False)
        log_evidence = self.constant + 0.5 * float(white @ white)
        log_evidence -= float(np.sum(np.log(np.diag(lower))))
        return RestrictedEvidence(log_evidence, self, free, root, lower, white)


@final
class RestrictedEvidence(NamedTuple):
    """The evidence of a model, and what follows of it."""

    log_evidence: float  # [nats]
    whole: LinearEvidence
    free: NDArray[np.int64]  # unknowns of the model, shape (F,)
    root: Array  # their standard deviations before the flights, shape (F,)
    lower: Array  # Cholesky factor of 1 + v A, shape (F, F)
    white: Array  # shape (F,)

    def posterior(self) -> tuple[Array, Array]:
        """Return mean and covariance of the unknowns of the model, shape (F,), (F, F)."""
        inverse = solve_triangular(self.lower, np.diag(self.root), lower=True, check_finite=False)
        return inverse.T @ self.white, inverse.T @ inverse

    def compute_remainder(self) -> tuple[Array, Array]:
        """
        Return what is left for other unknowns beside the model.

        The pull of each, shape (K,), and the columns whose products, subtracted from those of the
        information, leave that of the others, shape (F, K).
        """
        rows = self.whole.information[self.free] * self.root[:, None]
        across = solve_triangular(self.lower, rows, lower=True, check_finite=False)
        return self.whole.pull - self.white @ across, across
