"""
When something changed for good in a flight: a rotor that fails, a payload that drops.

For each number of the model that can change at once, and each beginning of a piece, the change of
the number from there on is one more unknown; what it wins is a log Bayes factor, everything else
being free as before. The most that is won has to be more than what the same pieces win in another
order: where nothing happened, their order says nothing.
"""

from collections.abc import Sequence
from typing import Final, final, NamedTuple

from lta_discovery.fit.evidence import build_prior
from lta_discovery.fit.joint_fit import FlightFit
from lta_discovery.fit.robust_variance import reduce_each_piece
from lta_discovery.model.parameters import FreeParameter
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# Effects that can begin or end in flight.
CHANGING: Final = (
    'rotor_fault', 'net_lift', 'cg_offset', 'thrust_scale', 'steady_wind', 'command_delay',
    'tracker_delay', 'range_offset',
)  # fmt: skip
LARGE: Final = 3.0  # typical sizes: what fails in flight fails by more than vehicles differ
LEAST: Final = 2  # pieces on either side
WON: Final = 8.0  # nats
DRAWS: Final = 199
CHANCE: Final = 0.04  # of 8 pieces there are no more orders than that tells apart


@final
class ChangePoint(NamedTuple):
    """
    A change.

    Attributes
    ----------
    piece : int
        The first after it.
    knob : str
        As if this had changed: 'rotor_fault.lost_3'.
    won : float
        Log Bayes factor. [nats]

    """

    piece: int
    knob: str
    won: float


def find_change_point(
    this: FlightFit, knobs: Sequence[FreeParameter], seed: int
) -> ChangePoint | None:
    """
    Return what changed for good in a flight; None where nothing did, as far as can be told.

    Parameters
    ----------
    this : Fit
        The flight, its tolerances fitted without any effect.
    knobs : sequence of Knob
        Of it.
    seed : int
        Of the other orders of its pieces.

    """
    each = reduce_each_piece(this.linear, this.deviations)
    picked = [
        k
        for k, knob in enumerate(knobs)
        if knob.typical > 0.0 and knob.name.partition('.')[0] in CHANGING
    ]
    if len(each) < 2 * LEAST + 1 or not picked:
        return None
    prior = build_prior(knobs)
    free = np.flatnonzero(prior.free)
    precision = np.linalg.inv(prior.covariance[np.ix_(free, free)])
    whole = each.sum(axis=0)
    inverse = np.linalg.inv(whole[np.ix_(free, free)] + precision)
    off = (prior.mean - this.linear.point.values)[free]
    known = inverse @ (whole[free, -1] + precision @ off)
    sizes = LARGE * np.array([knobs[k].typical for k in picked])

    def evidence_gain(order: NDArray[np.int64]) -> Array:
        # What the pieces from each place on say of each number, shape (S - 1, K, ...).
        after = np.cumsum(each[order][::-1][:, picked], axis=0)[::-1][LEAST : 1 - LEAST]
        others = after[..., free]
        information = after[:, range(len(picked)), picked]
        information = information - np.einsum('jkf,fg,jkg->jk', others, inverse, others)
        pull = after[..., -1] - others @ known
        gained: Array = 0.5 * pull**2 / (information + sizes**-2.0)
        gained -= 0.5 * np.log1p(information * sizes**2)
        return gained

    own = evidence_gain(np.arange(len(each)))
    place, which = np.unravel_index(int(np.argmax(own)), own.shape)
    rng = np.random.default_rng([seed, len(each)])
    others = [evidence_gain(rng.permutation(len(each))).max() for _ in range(DRAWS)]
    most = float(own[place, which])
    chance = (1 + int(np.sum(np.array(others) >= most))) / (DRAWS + 1)
    if most < WON or chance > CHANCE:
        return None
    return ChangePoint(int(place) + LEAST, knobs[picked[which]].name, most)
