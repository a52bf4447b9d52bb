"""The force and moment that nothing explains, along the flights that teach and confirm."""

from collections.abc import Sequence
from typing import final, NamedTuple

from lta_analysis.discovery.evidence import FLOOR, Pieces, tolerances
from lta_analysis.discovery.fit import settled
from lta_analysis.discovery.linear import AXES, KNOTS, origin
from lta_analysis.discovery.linearise import Linearised
from lta_analysis.discovery.nominal import Nominal
from lta_analysis.discovery.replay import STEPS
from lta_analysis.discovery.study import Flown, Study
from lta_analysis.discovery.tangent import WIDTH
from lta_analysis.discovery.unexplained import terms
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
    time : ndarray, shape (S, KNOTS)
        [s]
    wrench : ndarray, shape (S, KNOTS, 6)
        Force [N] and moment [N m], body frame.
    terms : mapping of str to ndarray, shape (S * KNOTS,)
        What it may follow, of the state there.

    """

    name: str
    time: Array
    wrench: Array
    terms: dict[str, Array]


def latents(study: Study) -> list[Latent]:
    """Return what remains of a flight that taught and of one that confirmed."""
    chosen: dict[str, Flown] = {}
    for flown in study.flights:
        if flown.role != 'holdout':
            chosen.setdefault(flown.role, flown)
    return [_of(flown.name, flown.flight, study.learned) for flown in chosen.values()]


def _of(name: str, flight: Linearised, learned: Nominal) -> Latent:
    """Return what remains of one flight, its tolerances and offsets free."""
    start = origin(learned, flight.knobs, len(flight.replay.first))
    pieces = Pieces(flight.at(start))
    _, deviations, found, _ = settled(pieces, tolerances(flight.knobs), FLOOR)
    random = pieces.solved(deviations, found.mean - start.values)
    knots = random[:, WIDTH : WIDTH + AXES * KNOTS].reshape(-1, AXES, KNOTS)
    states = flight.trajectory(start)[:, ::STEPS]
    index = np.rint(np.linspace(0, states.shape[1] - 1, KNOTS)).astype(int)
    length = flight.time[:, -1] - flight.time[:, 0]
    time = flight.time[:, :1] + length[:, None] * np.linspace(0.0, 1.0, KNOTS)
    here = states[:, index].reshape(-1, states.shape[-1])
    return Latent(name, time, np.swapaxes(knots, 1, 2), terms(here))


def joined(each: Latent, axis: int) -> tuple[Array, Array]:
    """Return the force or moment on one axis over time, a gap between pieces."""
    gap = np.full((len(each.time), 1), np.nan)
    time = np.hstack([each.time, each.time[:, -1:]]).ravel()
    return time, np.hstack([each.wrench[..., axis], gap]).ravel()


def followed(flights: Sequence[Latent], axis: int, names: Sequence[str]) -> list[Array]:
    """
    Return what the terms that a force follows make of it together, for each flight.

    Returns
    -------
    list of ndarray, shape (S * KNOTS,)
        By least squares over all flights, in the unit of the force.

    """
    rows = [np.column_stack([each.terms[name] for name in names]) for each in flights]
    target = np.concatenate([each.wrench[..., axis].ravel() for each in flights])
    weights = np.linalg.lstsq(np.concatenate(rows), target, rcond=None)[0]
    return [part @ weights for part in rows]
