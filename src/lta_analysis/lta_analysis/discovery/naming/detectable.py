"""How small an effect flights could have shown: what an answer of 'nothing' is worth."""

from collections.abc import Sequence
from typing import Final, final, NamedTuple

from lta_analysis.discovery.fit.evidence import Prior, Reduced
from lta_analysis.discovery.model.knobs import Knob
import numpy as np

SIGMA: Final = 5.0


@final
class Detectable(NamedTuple):
    """
    One candidate.

    Attributes
    ----------
    knob : str
        Its name.
    unit : str
        Of its size.
    size : float
        From which on it would have stood out by SIGMA deviations, those of the nominal model's
        own tolerance among them.
    typical : float
        Size of the effect where it is there.

    """

    knob: str
    unit: str
    size: float
    typical: float


def detectable(
    flights: Sequence[Reduced], prior: Prior, knobs: Sequence[Knob], named: Sequence[str] = ()
) -> tuple[Detectable, ...]:
    """
    Return how small each candidate could have been, the clearest by its typical size first.

    Parameters
    ----------
    flights : sequence of Reduced
        Those that teach and confirm; each has nuisances of its own.
    prior : Prior
        Of the nuisances, as `tolerances` or `shared` has it, and of what is named already.
    knobs : sequence of Knob
        All.
    named : sequence of str
        Those that were found, and are no candidates any more.

    """
    free, variance = prior.free, np.diag(prior.covariance)
    out = []
    for k, knob in enumerate(knobs):
        if knob.typical == 0.0 or knob.name in named:
            continue
        others = np.flatnonzero(free & (np.arange(len(free)) != k))
        information = 0.0
        for one in flights:
            products = one.products
            inner = products[np.ix_(others, others)] + np.diag(1.0 / variance[others])
            cross = products[others, k]
            information += float(products[k, k] - cross @ np.linalg.solve(inner, cross))
        if information * knob.typical**2 > 1e-6:
            size = SIGMA * float(np.sqrt(1.0 / information + variance[k]))
            out.append(Detectable(knob.name, knob.unit, size, knob.typical))
    return tuple(sorted(out, key=lambda one: one.size / one.typical))
