"""
Whether what was learned carries over to a regime that was left out, or only interpolates.

Coefficients that are refitted freely are right where they were fitted and can be worse than the
vehicle file elsewhere. So flights are grouped by regime (slow and fast, left and right, places of
a moving mass); each group is left out once, and what the others teach has to make its forecasts
better.
"""

from collections.abc import Mapping, Sequence
from typing import Final, final, NamedTuple

from lta_discovery.forecast.forecast_fit import ForecastFit, ForecastFitter
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

KEPT: Final = 1.0  # of the error of the vehicle file; above it, the regime got worse
TOLD: Final = 3  # regimes that a warning names


@final
class RegimeError(NamedTuple):
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


def sum_squared_error(regimes: Sequence[RegimeError]) -> float:
    """Return the squared error of regimes left out, each by how many flights it has."""
    return sum(one.flights * one.after**2 for one in regimes)


def remaining_error_share(regimes: Sequence[RegimeError]) -> float:
    """Return which part of the squared error of the vehicle file is left in regimes left out."""
    return sum_squared_error(regimes) / sum(one.flights * one.before**2 for one in regimes)


def cross_validate(
    foresight: ForecastFitter,
    fit: ForecastFit,
    which: Sequence[int],
    spread: Array,
    regimes: Mapping[str, Sequence[int]],
) -> list[RegimeError]:
    """
    Return what each regime says of the knobs that the others taught, the worst first.

    Parameters
    ----------
    foresight : Foresight
        All flights.
    fitted : Fitted
        To all of them; each fit without a regime is a step of Gauss-Newton away from it.
    which, spread
        The knobs, and how far they may be off: as for `ForecastFitter.fit`.
    regimes : mapping of str to sequence of int
        Flights by regime; each has flights outside of it.

    """
    out = []
    zero = np.zeros(len(foresight.knobs))
    for name, inside in regimes.items():
        taught = foresight.leave_out(fit, which, spread, inside)
        sizes = [foresight.rms_error(values, inside) for values in (zero, taught)]
        out.append(RegimeError(name, len(inside), *sizes))
    return sorted(out, key=lambda regime: -regime.ratio)


def format_warning(names: Sequence[str], regimes: Sequence[RegimeError]) -> str:
    """
    Return a sentence where what was learned only interpolates, '' where it carries over.

    Parameters
    ----------
    names : sequence of str
        Of the effects.
    regimes : sequence of Regime
        As `cross_validate` returns them.

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
