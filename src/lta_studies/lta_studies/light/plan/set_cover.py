"""
Which lamps, as few as may be, so that every cell hears as many as it should.

Set cover is hard: a greedy choice (Chvatal, A greedy heuristic for the set-covering problem,
Mathematics of Operations Research 4, 1979) is made better by tearing holes into it and filling
them otherwise; a linear program, the same problem with parts of lamps, tells how few there
could be at least.
"""

import math
from typing import Final

from lta_studies.light.plan.polygon import Array, Mask
import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray
from scipy.optimize import Bounds, LinearConstraint, milp
from scipy.sparse import csr_array

ROUNDING: Final = 1e-6  # of the linear program's optimum
TRIES: Final = 400
HOLE: Final = 6  # lamps taken away at once, at most
LEAST_WEIGHT: Final = 0.7

Chosen = list[int]
Whole = NDArray[np.int64]


def coverage_demand(audible: Mask, overlap: int) -> Whole:
    """Return how many lamps each cell should hear: `overlap`, or as many as can be heard there."""
    return np.asarray(np.minimum(audible.sum(axis=0), overlap), dtype=np.int64)


def select_greedily(
    audible: Mask, needed: Whole, existing: Chosen, most: int, weights: Array | None = None
) -> Chosen:
    """
    Return lamps, each the one that brings most of what is still needed.

    Parameters
    ----------
    heard : ndarray of bool, shape (lamps, cells)
        Which lamp is heard where.
    needed : ndarray of int, shape (cells,)
        How many lamps each cell should hear.
    kept : list of int
        Lamps that are there in any case.
    most : int
        How many lamps there may be.
    weights : ndarray, shape (lamps,), optional
        By which what a lamp brings is counted; all alike by default.

    """
    chosen = list(existing)
    lacking = needed - audible[chosen].sum(axis=0)
    worth = np.ones(len(audible)) if weights is None else weights.copy()
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
    Return lamps that cover what was covered, fewer where that is found.

    Takes a lamp and its neighbours away and fills the hole by a greedy choice among weighted
    lamps, again and again; what is no worse is gone on from.

    Parameters
    ----------
    heard, needed, kept
        As `select_greedily` takes them.
    chosen : list of int
        What to begin with.
    bound : int
        There cannot be fewer.
    chance : numpy.random.Generator
        Of the holes and weights.

    """
    goal = np.minimum(audible[chosen].sum(axis=0), needed)
    best = drop_redundant(audible, goal, chosen, existing)
    for _ in range(TRIES):
        movable = [lamp for lamp in best if lamp not in existing]
        if len(best) <= bound or not movable:
            break
        shared = (audible[movable] & audible[chance.choice(movable)]).sum(axis=1)
        hole = {movable[k] for k in np.argsort(-shared)[: chance.integers(2, HOLE + 1)]}
        rest = [lamp for lamp in best if lamp not in hole]
        weights = chance.uniform(LEAST_WEIGHT, 1.0, len(audible))
        filled = select_greedily(audible, goal, rest, len(best), weights)
        if np.all(audible[filled].sum(axis=0) >= goal):
            best = drop_redundant(audible, goal, filled, existing)
    return best


def drop_redundant(audible: Mask, goal: Whole, chosen: Chosen, existing: Chosen) -> Chosen:
    """Return lamps without those whose cells hear enough others, the first chosen first."""
    count = audible[chosen].sum(axis=0)
    left = list(chosen)
    for lamp in chosen:
        if lamp not in existing and np.all(count - audible[lamp] >= goal):
            left.remove(lamp)
            count = count - audible[lamp]
    return left


def solve_lower_bound(audible: Mask, needed: Whole, existing: Chosen) -> int:
    """Return a number of lamps below which nothing covers all, from the linear program."""
    columns, weights = merge_duplicate_cells(audible, needed)
    if not columns.size:
        return len(existing)
    least = np.zeros(len(audible))
    least[existing] = 1.0
    found = milp(
        np.ones(len(audible)),
        bounds=Bounds(least, np.ones(len(audible))),
        constraints=LinearConstraint(csr_array(columns.T.astype(float)), lb=weights),
    )
    return math.ceil(float(found.fun or 0.0) - ROUNDING)


def merge_duplicate_cells(audible: Mask, needed: Whole) -> tuple[Mask, Whole]:
    """Return each different column once, with what it needs; cells that need nothing are out."""
    asks = needed > 0
    packed = np.vstack([np.packbits(audible[:, asks], axis=0), needed[asks].astype(np.uint8)])
    _, first = np.unique(packed, axis=1, return_index=True)
    return audible[:, asks][:, first], needed[asks][first]
