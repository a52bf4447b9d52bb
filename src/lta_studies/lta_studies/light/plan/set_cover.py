"""
Select as few lamps as possible so that every cell receives enough of them.

Set cover is NP-hard. A greedy solution (Chvatal, A greedy heuristic for the set-covering problem,
Mathematics of Operations Research 4, 1979) is improved by large neighbourhood search: remove
neighbouring lamps and fill the hole again. The linear relaxation gives a lower bound.
"""

import math
from typing import Final

from lta_studies.light.plan.polygon import Array, Mask
import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray
from scipy.optimize import Bounds, LinearConstraint, milp
from scipy.sparse import csr_array

ROUNDING: Final = 1e-6  # tolerance of the linear program's optimum
TRIES: Final = 400  # iterations of the improvement
HOLE: Final = 6  # maximum number of lamps removed at once
LEAST_WEIGHT: Final = 0.7  # random weights in [0.7, 1] vary the greedy choice

Chosen = list[int]
Whole = NDArray[np.int64]


def coverage_demand(audible: Mask, overlap: int) -> Whole:
    """Return the demand of each cell: `overlap`, or the number of lamps it can receive."""
    return np.asarray(np.minimum(audible.sum(axis=0), overlap), dtype=np.int64)


def select_greedily(
    audible: Mask, needed: Whole, existing: Chosen, most: int, weights: Array | None = None
) -> Chosen:
    """
    Select lamps greedily by the unmet demand that each covers.

    Parameters
    ----------
    audible : ndarray of bool, shape (lamps, cells)
        Whether a lamp is received in a cell.
    needed : ndarray of int, shape (cells,)
        Demand of each cell.
    existing : list of int
        Lamps that are always included.
    most : int
        Maximum number of lamps.
    weights : ndarray, shape (lamps,), optional
        Weights of the lamps; equal by default.

    """
    chosen = list(existing)
    lacking = needed - audible[chosen].sum(axis=0)
    worth = np.ones(len(audible)) if weights is None else weights.copy()
    # A lamp that is already chosen has no further worth.
    worth[chosen] = 0.0
    while len(chosen) < most and lacking.max(initial=0) > 0:
        gains = worth * audible[:, lacking > 0].sum(axis=1)
        best = int(gains.argmax())
        if gains[best] <= 0.0:
            break
        chosen.append(best)
        worth[best] = 0.0
        lacking = lacking - audible[best]
    return chosen


def improve_cover(
    audible: Mask, needed: Whole, chosen: Chosen, existing: Chosen, bound: int, chance: Generator
) -> Chosen:
    """
    Search for fewer lamps with the same coverage.

    Repeatedly removes a lamp and its neighbours and fills the hole greedily with random weights.
    A solution that is not worse is accepted.

    `audible`, `needed`, `existing`: as in `select_greedily`. `chosen`: initial solution. `bound`:
    lower bound; the search stops there.
    """
    # With a limit on the lamps the demand may be unmet; keep what the greedy choice reached.
    goal = np.minimum(audible[chosen].sum(axis=0), needed)
    best = drop_redundant_lamps(audible, goal, chosen, existing)
    for _ in range(TRIES):
        movable = [lamp for lamp in best if lamp not in existing]
        if len(best) <= bound or not movable:
            break
        # Neighbours: lamps that share the most cells with a random one
        shared = (audible[movable] & audible[chance.choice(movable)]).sum(axis=1)
        hole = {movable[k] for k in np.argsort(-shared)[: chance.integers(2, HOLE + 1)]}
        rest = [lamp for lamp in best if lamp not in hole]
        weights = chance.uniform(LEAST_WEIGHT, 1.0, len(audible))
        filled = select_greedily(audible, goal, rest, len(best), weights)
        # Accept an equal number of lamps too: another layout may have a redundant one.
        if np.all(audible[filled].sum(axis=0) >= goal):
            best = drop_redundant_lamps(audible, goal, filled, existing)
    return best


def drop_redundant_lamps(audible: Mask, goal: Whole, chosen: Chosen, existing: Chosen) -> Chosen:
    """Drop lamps whose cells all receive enough others, in the order of choice."""
    count = audible[chosen].sum(axis=0)
    left = list(chosen)
    for lamp in chosen:
        if lamp not in existing and np.all(count - audible[lamp] >= goal):
            left.remove(lamp)
            count = count - audible[lamp]
    return left


def solve_lower_bound(audible: Mask, needed: Whole, existing: Chosen) -> int:
    """Return a lower bound on the number of lamps, from the linear relaxation."""
    columns, weights = merge_duplicate_cells(audible, needed)
    if not columns.size:
        return len(existing)
    least = np.zeros(len(audible))
    least[existing] = 1.0
    # Without `integrality` this is the linear relaxation.
    solution = milp(
        np.ones(len(audible)),
        bounds=Bounds(least, np.ones(len(audible))),
        constraints=LinearConstraint(csr_array(columns.T.astype(float)), lb=weights),
    )
    return math.ceil(float(solution.fun or 0.0) - ROUNDING)


def merge_duplicate_cells(audible: Mask, needed: Whole) -> tuple[Mask, Whole]:
    """Return the unique columns with their demand, without cells that need nothing."""
    asks = needed > 0
    # Bits packed into bytes make `unique` eight times smaller.
    packed = np.vstack([np.packbits(audible[:, asks], axis=0), needed[asks].astype(np.uint8)])
    _, first = np.unique(packed, axis=1, return_index=True)
    return audible[:, asks][:, first], needed[asks][first]
