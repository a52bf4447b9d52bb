"""
Where the first fit of flights begins: with the beginning of each piece.

A vehicle file that is off by a large effect is lost within a piece, and no slope that is taken
where it is lost leads back. It is not lost yet a second after it began; what that second teaches
carries on to the next ones, and so to the end of the piece.
"""

from collections.abc import Sequence
from copy import copy
from dataclasses import replace
from typing import Final

from lta_config.errors import BadInput
from lta_discovery.fit.evidence import Prior
from lta_discovery.fit.joint_fit import JointFitter
from lta_discovery.flights.measured_flight import PERIOD
from lta_discovery.replay.linearized_flight import LinearizationPoint
from lta_discovery.replay.linearizer import FlightLinearizer
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

STAGES: Final = (0.8, 2.4)  # s; of each piece
ROUNDS: Final = 6  # of each stage
REST: Final = 10.0  # nats; a beginning need not be as good as an end
CAPPED: Final = 2.5  # floors; of the deviations that the next stage begins with
LOST: Final = 300.0  # floors; a model that has to be helped by more has not found the flight


def shorten_pieces(flight: FlightLinearizer, seconds: float) -> FlightLinearizer:
    """Return a flight of which only the beginning of each piece counts."""
    out, replay = copy(flight), copy(flight.replay)
    inside = replay.cut.inside.copy()
    inside[:, round(seconds / PERIOD) :] = False
    replay.cut = replace(replay.cut, inside=inside)
    out.replay = replay
    return out


def guess_start(
    fitter: JointFitter, prior: Prior, points: Sequence[LinearizationPoint]
) -> tuple[Array, list[LinearizationPoint], Array]:
    """
    Return where to begin to fit flights of which nothing is known yet.

    Parameters
    ----------
    fitter : Fitter
        The flights.
    prior : Prior
        Of what they share.
    points : sequence of Point
        Where the vehicle file has them; all at the same values.

    Returns
    -------
    ndarray, shape (G,), list of Point, and ndarray, shape (6,)
        What the flights share, the point of each, and the deviations of the latent wrench.

    """
    at, deviations = points[0].values, fitter.floor
    for seconds in STAGES:
        flights = [shorten_pieces(flight, seconds) for flight in fitter.flights]
        stage = replace(fitter, flights=flights)
        try:
            here = stage.linearize_flights(at, points, prior)
            last = stage.fit(prior, here, deviations, ROUNDS, REST, narrow=True)
        except BadInput:
            break  # what is known by then may do
        if (last.deviations > LOST * fitter.floor).any():
            break  # where such a stage ends is no place to begin the next
        at, points = stage.propose_step(last)
        deviations = np.minimum(last.deviations, CAPPED * fitter.floor)
    return at, list(points), deviations
