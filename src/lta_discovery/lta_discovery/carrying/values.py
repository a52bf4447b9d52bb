"""What names are worth in numbers: fitted to all flights, and left out regime by regime."""

from collections.abc import Mapping, Sequence
from typing import Final, final, NamedTuple

from lta_discovery.carrying.groups import Group, tolerances, wide
from lta_discovery.carrying.intervals import drawn
from lta_discovery.carrying.transfer import left_out, Regime
from lta_discovery.forecast.foresight import Fitted, Foresight
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

ROUNDS: Final = 6  # of the fit of names
TUNING: Final = 4  # rounds, of tolerances


@final
class Valued(NamedTuple):
    """
    Names with their values.

    Attributes
    ----------
    which : list of int
        Places of their knobs.
    fitted : Fitted
        To all flights.
    draws : ndarray, shape (D, K)
        Values by flights drawn anew.
    regimes : list of Regime
        Each left out, the worst first.

    """

    which: list[int]
    fitted: Fitted
    draws: Array
    regimes: list[Regime]


def valued(
    sight: Foresight,
    groups: Sequence[Group],
    parts: Mapping[str, Sequence[int]],
    seed: int,
) -> Valued:
    """
    Return names fitted to all flights.

    Parameters
    ----------
    sight : Foresight
        All flights that teach or confirm.
    groups : sequence of Group
        The names.
    parts : mapping of str to sequence of int
        Flights by regime.
    seed : int
        Of the draws.

    """
    every = range(len(sight.flights))
    which = [k for group in groups for k in group.knobs]
    spread = wide(sight.knobs, which)
    fitted = sight.fit(which, spread, every, rounds=ROUNDS)
    found = left_out(sight, fitted, which, spread, parts)
    draws = drawn(fitted, sight.knobs, which, spread, seed)
    return Valued(which, fitted, draws, found)


def tuned(
    sight: Foresight, parts: Mapping[str, Sequence[int]], groups: Sequence[Group] = ()
) -> tuple[Array, list[Regime]]:
    """Return the tolerances of the file as forecasts have them, beside names, and each regime."""
    named = [k for group in groups for k in group.knobs]
    rest = [k for k in tolerances(sight.knobs) if k not in named]
    which = [*named, *rest]
    spread = np.concatenate([wide(sight.knobs, named), [sight.knobs[k].tolerance for k in rest]])
    fitted = sight.fit(which, spread, range(len(sight.flights)), rounds=TUNING)
    return fitted.values, left_out(sight, fitted, which, spread, parts)
