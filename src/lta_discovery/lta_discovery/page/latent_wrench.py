"""Compute the unexplained force and moment along training and confirming flights."""

from collections.abc import Sequence
from typing import final, NamedTuple

from lta_discovery.fit.joint_fit import FlightFit
from lta_discovery.page.flight_views import list_fit_flights
from lta_discovery.replay.linearized_flight import AXES
from lta_discovery.study import DiscoveryStudy, StudyFlight
from lta_discovery.unmodeled.unexplained_force import latent_at_knots, state_terms, states_at_knots
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@final
class LatentWrench(NamedTuple):
    """Unexplained wrench of one flight."""

    name: str  # of its bag
    time: Array  # of the knots of each piece, shape (S, K) [s]
    wrench: Array  # force [N] and moment [N m], body frame, shape (S, K, 6)
    # Whether the flight has data there: the last piece may end early, shape (S, K)
    has_data: NDArray[np.bool_]
    terms: dict[str, Array]  # candidate terms of the state, at the knots, shape (S * K,)


def collect_latent_wrenches(study: DiscoveryStudy) -> list[LatentWrench]:
    """Return the unexplained wrench of one training and one confirming flight."""
    chosen = {
        study_flight.role: (study_flight, fit)
        for study_flight, fit in reversed(list_fit_flights(study))
    }
    return [
        _compute_latent_wrench(*chosen[role]) for role in ('train', 'confirm') if role in chosen
    ]


def _compute_latent_wrench(study_flight: StudyFlight, fit: FlightFit) -> LatentWrench:
    """Return the unexplained wrench of one flight."""
    flight, inside = study_flight.flight, study_flight.flight.replay.cut.inside
    count = fit.linear.knots
    at = np.linspace(0.0, 1.0, count)
    begin, length = flight.time[:, :1], flight.time[:, -1:] - flight.time[:, :1]
    valid = inside[:, np.rint(at * (inside.shape[1] - 1)).astype(int)]
    wrench = latent_at_knots(fit).reshape(len(inside), count, AXES)
    there = state_terms(states_at_knots(flight, fit))
    return LatentWrench(study_flight.name, begin + length * at, wrench, valid, there)


def join_pieces(each: LatentWrench, axis: int) -> tuple[Array, Array]:
    """Return force or moment on one axis over time, with a gap between pieces."""
    gap = np.full((len(each.time), 1), np.nan)
    time = np.hstack([each.time, each.time[:, -1:]]).ravel()
    values = np.where(each.has_data, each.wrench[..., axis], np.nan)
    return time, np.hstack([values, gap]).ravel()


def fit_terms(flights: Sequence[LatentWrench], axis: int, names: Sequence[str]) -> list[Array]:
    """
    Return the joint least-squares fit of some terms to a force, for each flight.

    Returns
    -------
    list of ndarray, shape (S * K,)
        In the unit of the force.

    """
    rows = [
        np.column_stack([each.terms.get(name, np.zeros(each.has_data.size)) for name in names])
        for each in flights
    ]
    valid = np.concatenate([each.has_data.ravel() for each in flights])
    target = np.concatenate([each.wrench[..., axis].ravel() for each in flights])
    weights = np.linalg.lstsq(np.concatenate(rows)[valid], target[valid], rcond=None)[0]
    return [part @ weights for part in rows]
