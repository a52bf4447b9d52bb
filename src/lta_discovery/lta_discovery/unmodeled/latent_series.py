"""Collect the latent wrench of a flight over time, in map and body axes."""

from typing import final, NamedTuple

from lta_discovery.fit.joint_fit import FlightFit
from lta_discovery.model.quaternions import rotate_vectors
from lta_discovery.replay.flight_linearizer import FlightLinearizer
from lta_discovery.unmodeled.unexplained_force import latent_at_knots, states_at_knots
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@final
class LatentSeries(NamedTuple):
    """
    Latent wrench of a flight at its N valid knots.

    A time occurs twice where one piece ends and the next begins.
    """

    time: Array  # of the knots, shape (N,) [s]
    ground: Array  # force in the axes of the map, shape (N, 3) [N]
    body: Array  # force [N] and moment [N m] in the axes of the body, shape (N, 6)

    @classmethod
    def from_fit(cls, flight: FlightLinearizer, fit: FlightFit) -> 'LatentSeries':
        """Return the latent wrench of a fitted flight."""
        inside = flight.replay.cut.inside
        share = np.linspace(0.0, 1.0, fit.linear.knots)
        # Knots after the end of a shorter last piece have no data
        valid = inside[:, np.rint(share * (inside.shape[1] - 1)).astype(int)].ravel()
        begin, end = flight.time[:, :1], flight.time[:, -1:]
        time = (begin + (end - begin) * share).ravel()[valid]
        body = latent_at_knots(fit)[valid]
        turn = states_at_knots(flight, fit)[valid, 3:7]
        return cls(time, rotate_vectors(turn, body[:, :3]), body)

    @property
    def duration(self) -> float:
        """Time from the first knot to the last. [s]"""
        return float(np.ptp(self.time)) if len(self.time) else 0.0
