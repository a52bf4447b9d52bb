"""
Cross-validate fitted effects by leaving out flight regimes.

Freely fitted coefficients are right where they were fitted and can be worse than the vehicle file
elsewhere. Flights are therefore grouped by regime (slow and fast, left and right, places of a
moving mass). Each group is left out once, and the values of the others have to improve its
forecasts.
"""

from collections.abc import Mapping, Sequence
from typing import Final, final, NamedTuple

from lta_discovery.forecast.forecast_fit import ForecastFit, ForecastFitter
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

KEPT: Final = 1.0  # of the error of the vehicle file; above it, a regime got worse
TOLD: Final = 3  # most regimes that a warning names


@final
class RegimeForecastErrors(NamedTuple):
    """Forecast error of one left-out regime."""

    name: str  # 'moving mass at 0.0847 m'
    flights: int
    # Weighted error with the vehicle file, and with the values of the other regimes
    before: float
    after: float

    @property
    def ratio(self) -> float:
        """Error with the values of the other regimes, by that of the vehicle file."""
        return self.after / self.before


def sum_squared_error(regimes: Sequence[RegimeForecastErrors]) -> float:
    """Return the squared error of left-out regimes, weighted by their number of flights."""
    return sum(one.flights * one.after**2 for one in regimes)


def remaining_error_share(regimes: Sequence[RegimeForecastErrors]) -> float:
    """Return the share of the vehicle file's squared error that remains in left-out regimes."""
    return sum_squared_error(regimes) / sum(one.flights * one.before**2 for one in regimes)


def cross_validate(
    foresight: ForecastFitter,
    fit: ForecastFit,
    which: Sequence[int],
    spread: Array,
    regimes: Mapping[str, Sequence[int]],
    is_quick: bool = True,
) -> list[RegimeForecastErrors]:
    """
    Return the forecast error of each regime with the values of the others, the worst first.

    `fit`: to all flights; the fits without a regime begin at its values. `regimes`: flights by
    regime; each has flights outside of it. `is_quick`: whether these take one step.
    """
    out = []
    zero = np.zeros(len(foresight.knobs))
    for name, inside in regimes.items():
        fitted_without = foresight.leave_out_flights(fit, which, spread, inside, is_quick)
        sizes = [foresight.rms_error(values, inside) for values in (zero, fitted_without)]
        out.append(RegimeForecastErrors(name, len(inside), *sizes))
    return sorted(out, key=lambda regime: -regime.ratio)


def format_interpolation_warning(
    names: Sequence[str], regimes: Sequence[RegimeForecastErrors]
) -> str:
    """Return a warning if effects only interpolate, '' if they transfer."""
    worse = [regime for regime in regimes if regime.ratio > KEPT]
    if not worse:
        return ''
    listing = ', '.join(f'{one.name} ({one.ratio:.2f} times its error)' for one in worse[:TOLD])
    more = f' and {len(worse) - TOLD} more' if len(worse) > TOLD else ''
    return (
        f'{", ".join(names)}: interpolation only. Flight regimes that are left out of the fit are '
        f'predicted worse than by the vehicle file: {listing}{more}.'
    )
