"""Whether a name holds between flights that teach and those that confirm, both ways."""

from collections.abc import Sequence
from typing import Final

from lta_discovery.carrying.choose import Chosen
from lta_discovery.carrying.groups import Group, wide
from lta_discovery.forecast.foresight import Foresight
import numpy as np

ROUNDS: Final = 2  # of the fit to one half of the flights


def confirmed(
    sight: Foresight, chosen: Chosen, halves: Sequence[Sequence[int]]
) -> tuple[Group, ...]:
    """
    Return the names without which the forecasts of the other half get worse.

    Parameters
    ----------
    sight : Foresight
        All flights that teach or confirm.
    chosen : Chosen
        Names in the order of their worth.
    halves : sequence of sequences of int
        Those that teach, and those that confirm; where one is empty, all names stand.

    """
    kept = list(chosen.groups)
    if not all(halves):
        return tuple(kept)
    for group in reversed(chosen.groups):
        rest = [one for one in kept if one is not group]
        with_it, without = (_off(sight, chosen, some, halves) for some in (kept, rest))
        if with_it >= without:
            kept = rest
    return tuple(kept)


def _off(
    sight: Foresight, chosen: Chosen, groups: Sequence[Group], halves: Sequence[Sequence[int]]
) -> float:
    """Return the squared error of each half by what the other half teaches, both together."""
    which = [k for group in groups for k in group.knobs]
    begin = np.where(np.isin(np.arange(len(sight.knobs)), which), chosen.values, 0.0)
    total = 0.0
    for teaching, other in (halves, halves[::-1]):
        values = begin
        if which:
            spread = wide(sight.knobs, which)
            values = sight.fit(which, spread, teaching, begin, ROUNDS, told=False).values
        total += len(other) * sight.size(values, other) ** 2
    return total
