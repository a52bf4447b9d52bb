"""
Detect a permanent change within a flight, such as a failed rotor or a dropped payload.

For each parameter that can change suddenly and each beginning of a piece, the change from there on
is an additional unknown with a Bayes factor. The largest factor has to exceed those of the same
pieces in random orders (permutation test).
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

# Effects that can start or end within a flight.
CHANGING: Final = (
    'rotor_fault', 'net_lift', 'cg_offset', 'thrust_scale', 'steady_wind', 'command_delay',
    'tracker_delay', 'range_offset',
)  # fmt: skip
LARGE: Final = 3.0  # typical sizes; failures are larger than differences between vehicles
LEAST: Final = 2  # pieces on either side
WON: Final = 8.0  # nats
DRAWS: Final = 199
CHANCE: Final = 0.04  # significance level; 8 pieces have too few orders for a smaller one


@final
class ChangePoint(NamedTuple):
    """A permanent change."""

    piece: int  # first piece after it
    knob: str  # changed parameter: 'rotor_fault.lost_3'
    won: float  # log Bayes factor [nats]


def find_change_point(
    this: FlightFit, knobs: Sequence[FreeParameter], seed: int
) -> ChangePoint | None:
    """
    Return the most significant permanent change of a flight, or None.

    `this`: fit of its tolerances without any effect.
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
    # Tolerances as fitted without a change
    projection = inverse @ (whole[free, -1] + precision @ off)
    sizes = LARGE * np.array([knobs[k].typical for k in picked])

    def evidence_gain(order: NDArray[np.int64]) -> Array:
        # Sums over the pieces from each beginning on, shape (S - 1, K, ...).
        after = np.cumsum(each[order][::-1][:, picked], axis=0)[::-1][LEAST : 1 - LEAST]
        others = after[..., free]
        information = after[:, range(len(picked)), picked]
        information = information - np.einsum('jkf,fg,jkg->jk', others, inverse, others)
        pull = after[..., -1] - others @ projection
        gained: Array = 0.5 * pull**2 / (information + sizes**-2.0)
        gained -= 0.5 * np.log1p(information * sizes**2)
        return gained

    own = evidence_gain(np.arange(len(each)))
    place, which = np.unravel_index(int(np.argmax(own)), own.shape)
    rng = np.random.default_rng([seed, len(each)])
    others = [evidence_gain(rng.permutation(len(each))).max() for _ in range(DRAWS)]
    most = float(own[place, which])
    # p-value, counting the observed order as one of the draws
    chance = (1 + int(np.sum(np.array(others) >= most))) / (DRAWS + 1)
    if most < WON or chance > CHANCE:
        return None
    return ChangePoint(int(place) + LEAST, knobs[picked[which]].name, most)
