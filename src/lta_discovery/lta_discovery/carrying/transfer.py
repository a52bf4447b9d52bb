"""
Whether what was learned carries over to a regime that was left out, or only interpolates.

Coefficients that are refitted freely are right where they were fitted and can be worse than the
vehicle file elsewhere. So flights are grouped by regime (slow and fast, left and right, places of
a moving mass); each group is left out once, and what the others teach has to make its forecasts
better.
"""

from collections.abc import Mapping, Sequence
from typing import Final, final, NamedTuple

from lta_discovery.forecast.foresight import Fitted, Foresight
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

KEPT: Final = 1.0  # of the error of the vehicle file; above it, the regime got worse
TOLD: Final = 3  # regimes that a warning names


@final
class Regime(NamedTuple):
    """
    One regime, left out.

    Attributes
    ----------
    name : str
        'moving mass at 0.0847 m'.
    flights : int
        How many.
    before, after : float
        Size of the errors ahead, by that of the vehicle file over all flights.

    """

    name: str
    flights: int
    before: float
    after: float

    @property
    def ratio(self) -> float:
        """Error with what the other regimes taught, by that of the vehicle file."""
        return self.after / self.before


def squared(regimes: Sequence[Regime]) -> float:
    """Return the squared error of regimes left out, each by how many flights it has."""
    return sum(one.flights * one.after**2 for one in regimes)


def left(regimes: Sequence[Regime]) -> float:
    """Return which part of the squared error of the vehicle file is left in regimes left out."""
    return squared(regimes) / sum(one.flights * one.before**2 for one in regimes)


def left_out(
    foresight: Foresight,
    fitted: Fitted,
    which: Sequence[int],
    spread: Array,
    regimes: Mapping[str, Sequence[int]],
) -> list[Regime]:
    """
    Return what each regime says of the knobs that the others taught, the worst first.

    Parameters
    ----------
    foresight : Foresight
        All flights.
    fitted : Fitted
        To all of them; each fit without a regime is a step of Gauss-Newton away from it.
    which, spread
        The knobs, and how far they may be off: as for `Foresight.fit`.
    regimes : mapping of str to sequence of int
        Flights by regime; each has flights outside of it.

    """
    out = []
    zero = np.zeros(len(foresight.knobs))
    for name, inside in regimes.items():
        taught = foresight.without(fitted, which, spread, inside)
        sizes = [foresight.size(values, inside) for values in (zero, taught)]
        out.append(Regime(name, len(inside), *sizes))
    return sorted(out, key=lambda regime: -regime.ratio)


def warning(names: Sequence[str], regimes: Sequence[Regime]) -> str:
    """
    Return a sentence where what was learned only interpolates, '' where it carries over.

    Parameters
    ----------
    names : sequence of str
        Of the effects.
    regimes : sequence of Regime
        As `left_out` returns them.

    """
    worse = [regime for regime in regimes if regime.ratio > KEPT]
    if not worse:
        return ''
    told = ', '.join(f'{one.name} ({one.ratio:.2f} times the error)' for one in worse[:TOLD])
    more = f' and {len(worse) - TOLD} more' if len(worse) > TOLD else ''
    return (
        f'{", ".join(names)}: interpolation only; left out of the fit, {told}{more} '
        'came out worse than with the vehicle file.'
    )
