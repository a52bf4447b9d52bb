"""
How far ahead a model sees, and how that answers to its knobs: errors at a few horizons.

Each piece begins where the poses around its beginning say, and nothing helps the model on its way:
no latent force, no freed state. That is what a forecast is worth, and what a few knobs can be
fitted to where the model's own error, not the tracker's noise, is what counts.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, final

from lta_discovery.flights.measured_flight import PERIOD
from lta_discovery.model.quaternions import (
    quaternion_conjugate,
    quaternion_logarithm,
    quaternion_product,
)
from lta_discovery.replay.linearization_inputs import LinearizationInputs, prepare_linearization
from lta_discovery.replay.linearized_flight import AXES, LinearizationPoint, zero_unknowns
from lta_discovery.replay.linearizer import FlightLinearizer, POSE, start_sensitivity
from lta_discovery.replay.replay import STEPS
from lta_discovery.replay.sensing import predict_readings, tracker_frame, transform_to_map
from lta_discovery.replay.variational_equation import WIDTH
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

HORIZONS: Final = (1.0, 2.0, 3.0, 4.0, 5.0)  # s
CHUNK: Final = 32  # pieces at a time, which bounds the memory


@final
@dataclass(frozen=True, slots=True)
class HorizonErrors:
    """
    Errors of one flight about one set of parameters.

    Attributes
    ----------
    left : ndarray, shape (S, H, 6)
        Measured less predicted at each horizon: place, then rotation vector. NaN where the
        flight does not say. [m, rad]
    columns : ndarray, shape (S, H, 6, K)
        How the prediction answers to each knob asked for; K is 0 where none was.

    """

    left: Array
    columns: Array


def compute_horizon_errors(
    flight: FlightLinearizer,
    point: LinearizationPoint,
    which: Sequence[int] = (),
    horizons: Sequence[float] = HORIZONS,
) -> HorizonErrors:
    """
    Return how far a model is off ahead of each piece's beginning, and how it answers.

    Parameters
    ----------
    flight : Linearised
        The flight, in pieces longer than the last horizon.
    point : Point
        The parameters; its states and latent forces of the pieces are not used.
    which : sequence of int
        Of the flight's knobs.
    horizons : sequence of float
        [s]

    """
    wanted = np.isin(np.arange(len(flight.knobs)), which)
    about = prepare_linearization(flight.replay, flight.knobs, point, wanted)
    begun = LinearizationPoint(point.nominal, point.values, zero_unknowns(flight.replay.cut))
    index = np.rint(np.asarray(horizons) / PERIOD).astype(np.int64)
    parts = []
    for begin in range(0, len(flight.replay.first), CHUNK):
        some = slice(begin, begin + CHUNK)
        parts.append(_compute_chunk(flight, begun, about, which, index, some))
    left, columns = (np.concatenate(each) for each in zip(*parts, strict=True))
    return HorizonErrors(left, columns)


def _compute_chunk(
    flight: FlightLinearizer,
    begun: LinearizationPoint,
    about: LinearizationInputs,
    which: Sequence[int],
    index: NDArray[np.int64],
    some: slice,
) -> tuple[Array, Array]:
    """Return errors and columns of some pieces."""
    replay, time, acting = flight.replay, flight.time[some], about.rows.acting
    start = transform_to_map(replay.cut.start[some], acting)
    latent = np.zeros((len(time), replay.span, AXES))
    states = replay.integrate_pieces(about.rows, about.ready, start, latent, some)
    grid = states[:, ::STEPS]
    base = predict_readings(grid, time, acting, flight.places)
    at = flight.index[some][:, index]
    turn = quaternion_logarithm(
        quaternion_product(
            quaternion_conjugate(base.quaternion[:, index]), replay.flight.quaternion[at]
        )
    )
    left = np.concatenate([replay.flight.position[at] - base.position[:, index], turn], axis=-1)
    left[~replay.cut.inside[some][:, index]] = np.nan
    columns = np.zeros((*left.shape, len(which)))
    if not len(which):
        return left, columns
    answers = flight.state_sensitivities(begun, about, states, some)[:, index, :POSE]
    order = list(which)
    for j, k in enumerate(about.moving):
        columns[..., order.index(k)] = answers[..., flight.motion + j]
    for turned, k in zip(about.turned, about.reading, strict=True):
        # Where the tracker's frame turns, so does the state in which a piece begins.
        begins = start_sensitivity(replay.cut.start[some], turned)
        columns[..., order.index(k)] = np.einsum('shpb,sb->shp', answers[..., :WIDTH], begins)
    columns[..., :3, :] = tracker_frame(acting)[0] @ columns[..., :3, :]
    for turned, k in zip(about.turned, about.reading, strict=True):
        a, b = (predict_readings(grid, time, rows.acting, flight.places) for rows in turned[:2])
        turns = quaternion_logarithm(
            quaternion_product(quaternion_conjugate(a.quaternion), b.quaternion)
        )
        said = np.concatenate([b.position - a.position, turns], axis=-1)
        columns[..., order.index(k)] += said[:, index] / turned.step
    return left, columns
