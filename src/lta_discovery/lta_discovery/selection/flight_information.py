"""
Attribute what is known about each number to the flights that inform it.

The information of a flight about a parameter is what it adds alone to the inverse variance of the
prior, with all other parameters free within their priors. A free decay informs damping, a step
thrust, a spin-down the drag about the vertical.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import Final

from lta_discovery.finding import FlightShare, InformedParameter
from lta_discovery.fit.evidence import Prior
from lta_discovery.fit.flight_group import LinearizedGroup
from lta_discovery.fit.joint_fit import JointFit
from lta_discovery.model.parameters import FreeParameter
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

KNOWN: Final = 0.8  # of the prior's deviation; a larger one means that no flight informs it
SHARE: Final = 0.1  # of the information of all flights; flights with less are not listed
MOST: Final = 12  # parameters


def measure_information(group: LinearizedGroup, deviations: Array, prior: Prior) -> Array:
    """
    Return the information of each flight alone about each free parameter, shape (F, K).

    What the flight adds to the inverse variance, with all other parameters free within their
    priors.

    `deviations`, shape (6,): of the latent wrench [N, N m].
    """
    return np.array([
        measure_joint_information(group, deviations, prior, [i]) for i in range(len(group.pieces))
    ])  # fmt: skip


def measure_joint_information(
    group: LinearizedGroup, deviations: Array, prior: Prior, flights: Sequence[int]
) -> Array:
    """Return the information of some flights, given by index, together; see above. Shape (K,)."""
    free = prior.free
    inverse = np.linalg.inv(prior.covariance[np.ix_(free, free)])
    before = np.diag(prior.covariance)[free]
    some = replace(group, pieces=tuple(group.pieces[i] for i in flights))
    products = some.reduce_flights(deviations).products[:-1, :-1]
    after = np.diag(np.linalg.inv(products[np.ix_(free, free)] + inverse))
    return np.maximum(1.0 / after - 1.0 / before, 0.0)


def attribute_information(
    fit: JointFit, knobs: Sequence[FreeParameter], flights: Sequence[str]
) -> tuple[InformedParameter, ...]:
    """
    Return the parameters that some flights inform, the best known first.

    `flights`: names, in the order of the fit.
    """
    free = np.flatnonzero(fit.prior.free)
    gains = measure_information(fit.group, fit.deviations, fit.prior)
    before = np.diag(fit.prior.covariance)[free]
    remaining = np.sqrt(np.diag(fit.fitted.covariance)[free] / before)
    out = []
    for place in np.argsort(remaining):
        k, total = int(free[place]), float(gains[:, place].sum())
        # The trailing sensor errors are of each flight
        if k >= len(knobs) or remaining[place] > KNOWN or total <= 0.0:
            continue
        shares = [
            FlightShare(name, float(gain[place] / total))
            for name, gain in zip(flights, gains, strict=True)
            if gain[place] >= SHARE * total
        ]
        shares.sort(key=lambda one: -one.share)
        out.append(InformedParameter(knobs[k].name, float(remaining[place]), tuple(shares)))
    return tuple(out[:MOST])
