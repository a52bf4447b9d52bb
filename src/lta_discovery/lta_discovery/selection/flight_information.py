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
from lta_discovery.fit.joint_fit import JointFit
from lta_discovery.model.parameters import FreeParameter
import numpy as np

KNOWN: Final = 0.8  # of the prior's deviation; a larger one means that no flight informs it
SHARE: Final = 0.1  # of the information of all flights; flights with less are not listed
MOST: Final = 12  # parameters


def attribute_information(
    fit: JointFit, knobs: Sequence[FreeParameter], flights: Sequence[str]
) -> tuple[InformedParameter, ...]:
    """
    Return the parameters that some flights inform, the best known first.

    Parameters
    ----------
    flights : sequence of str
        Names, in the order of the fit.

    """
    prior, free = fit.prior, np.flatnonzero(fit.prior.free)
    inverse = np.linalg.inv(prior.covariance[np.ix_(free, free)])
    before = np.diag(prior.covariance)[free]
    gains = np.zeros((len(flights), len(free)))
    for gain, pieces in zip(gains, fit.group.pieces, strict=True):
        alone = replace(fit.group, pieces=(pieces,)).reduce_flights(fit.deviations)
        products = alone.products[np.ix_(free, free)]
        after = np.diag(np.linalg.inv(products + inverse))
        gain[:] = np.maximum(1.0 / after - 1.0 / before, 0.0)
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
