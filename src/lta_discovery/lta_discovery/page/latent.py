"""The force and moment that nothing explains, along the flights that teach and confirm."""

from collections.abc import Sequence
from typing import final, NamedTuple

from lta_discovery.fit.fit import Fit
from lta_discovery.outside.unexplained import knots_of, states_at_knots, terms
from lta_discovery.page.told import taught
from lta_discovery.replay.linear import AXES
from lta_discovery.study import Flown, Study
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@final
class Latent(NamedTuple):
    """
    What remains of one flight.

    Attributes
    ----------
    name : str
        Of its bag.
    time : ndarray, shape (S, K)
        Of the knots of each piece. [s]
    wrench : ndarray, shape (S, K, 6)
        Force [N] and moment [N m], body frame.
    known : ndarray of bool, shape (S, K)
        Whether the flight counts there: the last piece may end early.
    terms : mapping of str to ndarray, shape (S * K,)
        What it may follow, of the state there.

    """

    name: str
    time: Array
    wrench: Array
    known: NDArray[np.bool_]
    terms: dict[str, Array]


def latents(study: Study) -> list[Latent]:
    """Return what remains of a flight that taught and of one that confirmed."""
    chosen = {flown.role: (flown, fit) for flown, fit in reversed(taught(study))}
    return [_of(*chosen[role]) for role in ('train', 'confirm') if role in chosen]


def _of(flown: Flown, fit: Fit) -> Latent:
    """Return what remains of one flight."""
    flight, inside = flown.flight, flown.flight.replay.cut.inside
    count = fit.linear.knots
    at = np.linspace(0.0, 1.0, count)
    begin, length = flight.time[:, :1], flight.time[:, -1:] - flight.time[:, :1]
    known = inside[:, np.rint(at * (inside.shape[1] - 1)).astype(int)]
    wrench = knots_of(fit).reshape(len(inside), count, AXES)
    there = terms(states_at_knots(flight, fit))
    return Latent(flown.name, begin + length * at, wrench, known, there)


def joined(each: Latent, axis: int) -> tuple[Array, Array]:
    """Return the force or moment on one axis over time, a gap between pieces."""
    gap = np.full((len(each.time), 1), np.nan)
    time = np.hstack([each.time, each.time[:, -1:]]).ravel()
    values = np.where(each.known, each.wrench[..., axis], np.nan)
    return time, np.hstack([values, gap]).ravel()


def followed(flights: Sequence[Latent], axis: int, names: Sequence[str]) -> list[Array]:
    """
    Return what the terms that a force follows make of it together, for each flight.

    Returns
    -------
    list of ndarray, shape (S * K,)
        By least squares over all flights, in the unit of the force.

    """
    rows = [
        np.column_stack([each.terms.get(name, np.zeros(each.known.size)) for name in names])
        for each in flights
    ]
    known = np.concatenate([each.known.ravel() for each in flights])
    target = np.concatenate([each.wrench[..., axis].ravel() for each in flights])
    weights = np.linalg.lstsq(np.concatenate(rows)[known], target[known], rcond=None)[0]
    return [part @ weights for part in rows]
