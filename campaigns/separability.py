# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Compute how well flights separate two parameters, all others marginalized.

Two parameters whose marginal columns are parallel are indistinguishable in such flights.
"""

from collections.abc import Sequence
from typing import final, NamedTuple

from lta_discovery.model.parameters import FreeParameter
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@final
class ParameterPair(NamedTuple):
    """Joint information on two parameters, all others marginalized."""

    # Information of each [1 / unit2]
    first: float
    second: float
    shared: float  # between the two

    @property
    def cosine(self) -> float:
        """Return the cosine of the columns: 1 or -1 if equivalent; 0 if one is unobservable."""
        size = self.first * self.second
        return self.shared / float(np.sqrt(size)) if size > 0.0 else 0.0


@final
class PairSeparability:
    """
    Separability of K parameters in flights of one vehicle.

    `flights`: information of each about the parameters, shape (K, K), about the vehicle file or a
    common point. `times`: factor on the length of the flights.
    """

    def __init__(
        self, flights: Sequence[Array], knobs: Sequence[FreeParameter], times: float = 1.0
    ) -> None:
        self.knobs = list(knobs)
        tolerance = np.array([one.tolerance for one in knobs])
        per_flight = np.array([one.per_flight for one in knobs], dtype=np.bool_)
        at = np.flatnonzero(per_flight & (tolerance > 0.0))
        # Per-flight errors add to the shared value of the same parameter.
        parts = [self._eliminate_columns(times * one, at, tolerance[at] ** 2) for one in flights]
        self._products = np.sum(parts, axis=0)
        self._variance = np.where(per_flight, 0.0, tolerance**2)

    def _eliminate_columns(self, products: Array, at: NDArray[np.int64], variance: Array) -> Array:
        """Marginalize columns with a prior variance."""
        inner = products[np.ix_(at, at)] + np.diag(1.0 / variance)
        cross = products[at]
        left: Array = products - cross.T @ np.linalg.solve(inner, cross)
        return left

    def _marginal_information(self, picked: tuple[int, ...]) -> Array:
        """Return the information on some parameters, all others marginalized."""
        # Fixed parameters have a variance of 0
        free = self._variance > 1e-30
        free[list(picked)] = False
        at = np.flatnonzero(free)
        left = self._eliminate_columns(self._products, at, self._variance[at])
        return left[np.ix_(picked, picked)]

    def parameter_information(self, k: int) -> float:
        """Return the information on one parameter, all others marginalized [1 / unit2]."""
        return max(0.0, float(self._marginal_information((k,))[0, 0]))

    def compare_pair(self, a: int, b: int) -> ParameterPair:
        """Return the information on two parameters, without their tolerances."""
        left = self._marginal_information((a, b))
        return ParameterPair(max(0.0, left[0, 0]), max(0.0, left[1, 1]), float(left[0, 1]))

    def detection_sigma(self, k: int) -> float:
        """Return the significance of a parameter's typical size, including its tolerance."""
        typical, information = self.knobs[k].typical, self.parameter_information(k)
        if information * typical**2 < 1e-6:
            return 0.0
        return typical / float(np.sqrt(1.0 / information + max(0.0, self._variance[k])))
