"""
How well flights tell two knobs apart: what each says, all else marginalised.

Of a knob's column a part is left once states, latent forces and every other knob have had their
share. Two knobs of which the parts that are left point the same way are one name to such flights.
"""

from collections.abc import Sequence
from typing import Final, final, NamedTuple

from lta_discovery.fit.evidence import build_shared_prior, per_flight_variance, ReducedFlight
from lta_discovery.model.parameters import FreeParameter
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

ALIKE: Final = 0.8  # of a cosine; less alike, two names are never confused, only both weak


@final
class ParameterPair(NamedTuple):
    """
    What flights say of two knobs, each beside all others but these two.

    Attributes
    ----------
    first, second : float
        Information of each. [1 / unit2]
    shared : float
        Between the two.

    """

    first: float
    second: float
    shared: float

    @property
    def cosine(self) -> float:
        """Return how alike they are: 1 or -1 where they are one; 0 where either is not seen."""
        size = self.first * self.second
        return self.shared / float(np.sqrt(size)) if size > 0.0 else 0.0

    def expected_log_bayes(self, value: float) -> float:
        """
        Return the log Bayes factor to expect of the first at a value, over the second. [nats]

        The second is free to take whatever value fits best; so this is the least to expect.
        """
        best = self.shared**2 / self.second if self.second > 0.0 else 0.0
        return 0.5 * value**2 * max(0.0, self.first - best)


@final
class PairSeparability:
    """
    Flights of one vehicle, ready to be asked about any two knobs.

    Parameters
    ----------
    flights : sequence of Reduced
        Each about the vehicle file, or about one point.
    knobs : sequence of Knob
        Of all.
    times : float
        How much longer each flight is: what more of the same would say.

    """

    def __init__(
        self, flights: Sequence[ReducedFlight], knobs: Sequence[FreeParameter], times: float = 1.0
    ) -> None:
        self.knobs = list(knobs)
        own = per_flight_variance(knobs)
        at = np.flatnonzero(own)
        # What a flight has of its own comes on top of what flights share of the same knob.
        parts = [
            self._eliminate_columns(times * f.products[:-1, :-1], at, own[at]) for f in flights
        ]
        self._products = np.sum(parts, axis=0)
        self._variance = np.diag(build_shared_prior(knobs).covariance)

    def _eliminate_columns(self, products: Array, at: NDArray[np.int64], variance: Array) -> Array:
        """Return products without some columns, which are within their tolerance."""
        inner = products[np.ix_(at, at)] + np.diag(1.0 / variance)
        cross = products[at]
        left: Array = products - cross.T @ np.linalg.solve(inner, cross)
        return left

    def _marginal_information(self, picked: tuple[int, ...]) -> Array:
        """Return the information about some knobs, all others marginalised."""
        free = self._variance > 1e-30
        free[list(picked)] = False
        at = np.flatnonzero(free)
        left = self._eliminate_columns(self._products, at, self._variance[at])
        return left[np.ix_(picked, picked)]

    def parameter_information(self, k: int) -> float:
        """Return the information about one knob, all others marginalised. [1 / unit2]"""
        return max(0.0, float(self._marginal_information((k,))[0, 0]))

    def compare_pair(self, a: int, b: int) -> ParameterPair:
        """Return what the flights say of two knobs, neither of which is a tolerance then."""
        left = self._marginal_information((a, b))
        return ParameterPair(max(0.0, left[0, 0]), max(0.0, left[1, 1]), float(left[0, 1]))

    def detection_sigma(self, k: int) -> float:
        """Return how many deviations a typical size of a knob is, its own tolerance among them."""
        typical, information = self.knobs[k].typical, self.parameter_information(k)
        if information * typical**2 < 1e-6:
            return 0.0
        return typical / float(np.sqrt(1.0 / information + max(0.0, self._variance[k])))

    def can_replace(self, name: str, value: float, other: str) -> bool:
        """
        Tell whether a candidate can have the value that does what a knob does at a value.

        A clock that runs ahead looks like a delay below zero, which there is not.
        """
        order = [knob.name for knob in self.knobs]
        if name not in order or other not in order:
            return True
        pair = self.compare_pair(order.index(name), order.index(other))
        if pair.second <= 0.0:
            return True
        best, deviation = value * pair.shared / pair.second, pair.second**-0.5
        return self.knobs[order.index(other)].is_promising(best, deviation)

    def list_confused(self, name: str, value: float, least: float) -> list[str]:
        """
        Return candidates that these flights take for one at a value, the likest first.

        Parameters
        ----------
        name : str
            Of the knob.
        value : float
            Of it, in its unit.
        least : float
            Log Bayes factor to expect where two are told apart. [nats]

        """
        a = [knob.name for knob in self.knobs].index(name)
        found = []
        for b, knob in enumerate(self.knobs):
            if b != a and knob.typical > 0.0:
                pair = self.compare_pair(a, b)
                if abs(pair.cosine) > ALIKE and pair.expected_log_bayes(value) < least:
                    found.append((pair.expected_log_bayes(value), knob.name))
        return [other for _, other in sorted(found)]
