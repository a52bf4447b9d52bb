"""
Find the starting point of the first fit, using only the beginning of each piece.

If the vehicle file lacks a large effect, the prediction diverges within a piece, and gradients
there do not lead back. One second after the start it has not diverged yet. A fit to that second
serves as the start of a fit to longer pieces.
"""

from collections.abc import Sequence
from copy import copy
from dataclasses import replace
from typing import Final

from lta_config.errors import BadInput
from lta_discovery.fit.evidence import Prior
from lta_discovery.fit.joint_fit import JointFitter
from lta_discovery.flights.measured_flight import PERIOD
from lta_discovery.replay.flight_linearizer import FlightLinearizer
from lta_discovery.replay.linearized_flight import LinearizationPoint
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

STAGES: Final = (0.8, 2.4)  # s; used length of each piece, by stage
ROUNDS: Final = 6  # most steps of a stage
REST: Final = 10.0  # nats; convergence criterion of a stage, which may be loose
CAPPED: Final = 2.5  # noise floors; largest deviations at the start of a stage
LOST: Final = 300.0  # noise floors; a stage with larger deviations has failed


def shorten_pieces(flight: FlightLinearizer, seconds: float) -> FlightLinearizer:
    """Return a flight that uses only the beginning of each piece."""
    out, replay = copy(flight), copy(flight.replay)
    inside = replay.cut.inside.copy()
    # Mask later readings instead of cutting, so that array shapes stay the same
    inside[:, round(seconds / PERIOD) :] = False
    replay.cut = replace(replay.cut, inside=inside)
    out.replay = replay
    return out


def guess_start(
    fitter: JointFitter, prior: Prior, at: Array, points: Sequence[LinearizationPoint]
) -> tuple[Array, list[LinearizationPoint], Array]:
    """
    Find where to start the fit of flights.

    Parameters
    ----------
    at : ndarray, shape (G,)
        Shared parameters at which the search begins.
    points : sequence of LinearizationPoint
        Of each flight, at these parameters.

    Returns
    -------
    ndarray, shape (G,), list of LinearizationPoint, and ndarray, shape (6,)
        Shared parameters, point of each flight, and deviations of the latent wrench.

    """
    deviations = fitter.floor
    for seconds in STAGES:
        flights = [shorten_pieces(flight, seconds) for flight in fitter.flights]
        stage = replace(fitter, flights=flights)
        try:
            here = stage.linearize_flights(at, points, prior)
            last = stage.fit(prior, here, deviations, ROUNDS, REST, narrow=True)
        except BadInput:
            break  # use the result of the stage before
        if (last.deviations > LOST * fitter.floor).any():
            break  # a failed stage is a bad start for the next
        try:
            at, points = stage.propose_step(last)
        except np.linalg.LinAlgError:
            break
        # Large deviations would hide the missing effect in the next stage
        deviations = np.minimum(last.deviations, CAPPED * fitter.floor)
    return at, list(points), deviations
