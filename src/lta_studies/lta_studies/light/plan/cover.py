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


def demand(heard: Mask, overlap: int) -> Whole:
    """Return how many lamps each cell should hear: `overlap`, or as many as can be heard there."""
    return np.asarray(np.minimum(heard.sum(axis=0), overlap), dtype=np.int64)


def greedy(
    heard: Mask, needed: Whole, kept: Chosen, most: int, weights: Array | None = None
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
    chosen = list(kept)
    lacking = needed - heard[chosen].sum(axis=0)
    worth = np.ones(len(heard)) if weights is None else weights.copy()
    worth[chosen] = 0.0
    while len(chosen) < most and lacking.max(initial=0) > 0:
        gains = worth * heard[:, lacking > 0].sum(axis=1)
        best = int(gains.argmax())
        if gains[best] <= 0.0:
            break
        chosen.append(best)
        worth[best] = 0.0
        lacking = lacking - heard[best]
    return chosen


def improved(
    heard: Mask, needed: Whole, chosen: Chosen, kept: Chosen, bound: int, chance: Generator
) -> Chosen:
    """
    Return lamps that cover what was covered, fewer where that is found.

    Takes a lamp and its neighbours away and fills the hole by a greedy choice among weighted
    lamps, again and again; what is no worse is gone on from.

    Parameters
    ----------
    heard, needed, kept
        As `greedy` takes them.
    chosen : list of int
        What to begin with.
    bound : int
        There cannot be fewer.
    chance : numpy.random.Generator
        Of the holes and weights.

    """
    goal = np.minimum(heard[chosen].sum(axis=0), needed)
    best = needless_out(heard, goal, chosen, kept)
    for _ in range(TRIES):
        movable = [lamp for lamp in best if lamp not in kept]
        if len(best) <= bound or not movable:
            break
        shared = (heard[movable] & heard[chance.choice(movable)]).sum(axis=1)
        hole = {movable[k] for k in np.argsort(-shared)[: chance.integers(2, HOLE + 1)]}
        rest = [lamp for lamp in best if lamp not in hole]
        weights = chance.uniform(LEAST_WEIGHT, 1.0, len(heard))
        filled = greedy(heard, goal, rest, len(best), weights)
        if np.all(heard[filled].sum(axis=0) >= goal):
            best = needless_out(heard, goal, filled, kept)
    return best


def needless_out(heard: Mask, goal: Whole, chosen: Chosen, kept: Chosen) -> Chosen:
    """Return lamps without those whose cells hear enough others, the first chosen first."""
    count = heard[chosen].sum(axis=0)
    left = list(chosen)
    for lamp in chosen:
        if lamp not in kept and np.all(count - heard[lamp] >= goal):
            left.remove(lamp)
            count = count - heard[lamp]
    return left


def fewest(heard: Mask, needed: Whole, kept: Chosen) -> int:
    """Return a number of lamps below which nothing covers all, from the linear program."""
    columns, weights = distinct(heard, needed)
    if not columns.size:
        return len(kept)
    least = np.zeros(len(heard))
    least[kept] = 1.0
    found = milp(
        np.ones(len(heard)),
        bounds=Bounds(least, np.ones(len(heard))),
        constraints=LinearConstraint(csr_array(columns.T.astype(float)), lb=weights),
    )
    return math.ceil(float(found.fun or 0.0) - ROUNDING)


def distinct(heard: Mask, needed: Whole) -> tuple[Mask, Whole]:
    """Return each different column once, with what it needs; cells that need nothing are out."""
    asks = needed > 0
    packed = np.vstack([np.packbits(heard[:, asks], axis=0), needed[asks].astype(np.uint8)])
    _, first = np.unique(packed, axis=1, return_index=True)
    return heard[:, asks][:, first], needed[asks][first]
