"""
How well flights tell two knobs apart: what each says, all else marginalised.

Of a knob's column a part is left once states, latent forces and every other knob have had their
share. Two knobs of which the parts that are left point the same way are one name to such flights.
"""

from collections.abc import Sequence
from typing import final, NamedTuple

from lta_analysis.discovery.evidence import Reduced, tolerances
from lta_analysis.discovery.knobs import Knob
from lta_analysis.discovery.linear import SENSORS
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@final
class Pair(NamedTuple):
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

    def apart(self, value: float) -> float:
        """
        Return the log Bayes factor to expect of the first at a value, over the second. [nats]

        The second is free to take whatever value fits best; so this is the least to expect.
        """
        best = self.shared**2 / self.second if self.second > 0.0 else 0.0
        return 0.5 * value**2 * max(0.0, self.first - best)


@final
class Pairs:
    """
    Flights of one vehicle, ready to be asked about any two knobs.

    Parameters
    ----------
    flights : sequence of Reduced
        Each about the vehicle file, or about one point.
    knobs : sequence of Knob
        Of all.
    times : float
        How often each flight is flown: what more of the same would say.

    """

    def __init__(
        self, flights: Sequence[Reduced], knobs: Sequence[Knob], times: float = 1.0
    ) -> None:
        self.knobs = list(knobs)
        self._products = [times * flight.products[:-1, :-1] for flight in flights]
        self._tolerance = np.sqrt(np.diag(tolerances(knobs).covariance))
        own = np.array([knob.per_flight for knob in knobs] + [True] * len(SENSORS))
        free = self._tolerance > 0.0
        self._own, self._common = own & free, ~own & free
        self._kept: dict[tuple[int, ...], Array] = {}

    def _without_own(self, picked: tuple[int, ...]) -> Array:
        """Return the sum over flights, with what is each flight's own eliminated from it."""
        aside = tuple(k for k in picked if self._own[k])
        if aside not in self._kept:
            out = self._own.copy()
            out[list(aside)] = False
            at = np.flatnonzero(out)
            self._kept[aside] = np.sum([self._eliminated(p, at) for p in self._products], axis=0)
        return self._kept[aside]

    def _eliminated(self, products: Array, at: NDArray[np.int64]) -> Array:
        """Return products without some columns, which have their tolerance."""
        inner = products[np.ix_(at, at)] + np.diag(self._tolerance[at] ** -2.0)
        cross = products[at]
        left: Array = products - cross.T @ np.linalg.solve(inner, cross)
        return left

    def _left(self, picked: tuple[int, ...]) -> Array:
        """Return the information about some knobs, all others marginalised."""
        products = self._without_own(picked)
        free = self._common.copy()
        free[list(picked)] = False
        left = self._eliminated(products, np.flatnonzero(free))
        return left[np.ix_(picked, picked)]

    def one(self, k: int) -> float:
        """Return the information about one knob, all others marginalised. [1 / unit2]"""
        return max(0.0, float(self._left((k,))[0, 0]))

    def pair(self, a: int, b: int) -> Pair:
        """Return what the flights say of two knobs, neither of which is a tolerance then."""
        left = self._left((a, b))
        return Pair(max(0.0, left[0, 0]), max(0.0, left[1, 1]), float(left[0, 1]))

    def sigma(self, k: int) -> float:
        """Return how many deviations a typical size of a knob is, its own tolerance among them."""
        knob, information = self.knobs[k], self.one(k)
        if information * knob.typical**2 < 1e-6:
            return 0.0
        return knob.typical / float(np.sqrt(1.0 / information + knob.tolerance**2))
