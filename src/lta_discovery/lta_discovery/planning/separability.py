"""
Compute how well flights separate two parameters, all others marginalized.

Two parameters whose marginal columns are parallel are indistinguishable in such flights.
"""

from collections.abc import Sequence
from typing import Final, final, NamedTuple

from lta_discovery.fit.evidence import build_shared_prior, per_flight_variance, ReducedFlight
from lta_discovery.model.parameters import FreeParameter
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

ALIKE: Final = 0.8  # cosine; below it two effects are never confused, only both weak


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

    def expected_log_bayes(self, value: float) -> float:
        """
        Return the expected log Bayes factor of the first at a value over the second. [nats]

        A lower bound, because the second may take its best-fitting value.
        """
        # Part of the information that the second explains by a change of its value
        best = self.shared**2 / self.second if self.second > 0.0 else 0.0
        return 0.5 * value**2 * max(0.0, self.first - best)


@final
class PairSeparability:
    """
    Separability of parameters in flights of one vehicle.

    `flights`: about the vehicle file, or a common point. `times`: factor on the length of the
    flights.
    """

    def __init__(
        self, flights: Sequence[ReducedFlight], knobs: Sequence[FreeParameter], times: float = 1.0
    ) -> None:
        self.knobs = list(knobs)
        own = per_flight_variance(knobs)
        at = np.flatnonzero(own)
        # Per-flight errors add to the shared value of the same parameter.
        parts = [
            self._eliminate_columns(times * f.products[:-1, :-1], at, own[at]) for f in flights
        ]
        self._products = np.sum(parts, axis=0)
        self._variance = np.diag(build_shared_prior(knobs).covariance)

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
        """Return the information on one parameter, all others marginalized. [1 / unit2]"""
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

    def can_replace(self, name: str, value: float, other: str) -> bool:
        """
        Return whether a candidate can take the value that mimics another.

        For example, a clock that runs ahead would need a negative delay.
        """
        order = [knob.name for knob in self.knobs]
        if name not in order or other not in order:
            return True
        pair = self.compare_pair(order.index(name), order.index(other))
        if pair.second <= 0.0:
            return True
        best, deviation = value * pair.shared / pair.second, pair.second**-0.5
        return self.knobs[order.index(other)].is_plausible_estimate(best, deviation)

    def list_confused(self, name: str, value: float, least: float) -> list[str]:
        """
        Return the candidates that these flights confuse with one, the most similar first.

        `least`: expected log Bayes factor of separable candidates [nats].
        """
        a = [knob.name for knob in self.knobs].index(name)
        confused = []
        for b, knob in enumerate(self.knobs):
            if b != a and knob.typical > 0.0:
                pair = self.compare_pair(a, b)
                if abs(pair.cosine) > ALIKE and pair.expected_log_bayes(value) < least:
                    confused.append((pair.expected_log_bayes(value), knob.name))
        return [other for _, other in sorted(confused)]
