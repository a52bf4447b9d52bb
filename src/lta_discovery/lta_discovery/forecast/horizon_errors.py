"""
Compute prediction errors at some horizons, and their sensitivity to parameters.

Each piece starts at the state estimated from the poses and runs without correction: no latent
force, no free state.
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
from lta_discovery.replay.flight_linearizer import FlightLinearizer, start_sensitivity
from lta_discovery.replay.linearization_inputs import LinearizationInputs, prepare_linearization
from lta_discovery.replay.linearized_flight import AXES, LinearizationPoint, zero_unknowns
from lta_discovery.replay.replay import STEPS
from lta_discovery.replay.sensing import pose_sensitivity, predict_pose, transform_to_map
from lta_discovery.replay.variational_equation import WIDTH
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

HORIZONS: Final = (1.0, 2.0, 3.0, 4.0, 5.0)  # s
CHUNK: Final = 32  # pieces at a time, to limit memory


@final
@dataclass(frozen=True, slots=True)
class HorizonErrors:
    """Errors of one flight about one set of parameters."""

    # Measured minus predicted: position, then rotation vector; NaN where unknown, shape (S, H, 6)
    # [m, rad]
    errors: Array
    columns: Array  # sensitivity of the prediction to each requested parameter, shape (S, H, 6, K)


def compute_horizon_errors(
    flight: FlightLinearizer,
    point: LinearizationPoint,
    which: Sequence[int] = (),
    horizons: Sequence[float] = HORIZONS,
) -> HorizonErrors:
    """
    Compute prediction errors ahead of the beginning of each piece, and their sensitivities.

    `flight`: in pieces longer than the last horizon. `point`: the parameters; its states and
    latent forces are ignored.
    """
    selected = np.isin(np.arange(len(flight.knobs)), which)
    about = prepare_linearization(flight.replay, flight.knobs, point, selected)
    begun = LinearizationPoint(point.nominal, point.values, zero_unknowns(flight.replay.cut))
    # Grid points of the horizons within a piece
    index = np.rint(np.asarray(horizons) / PERIOD).astype(np.int64)
    parts = []
    for begin in range(0, len(flight.replay.first), CHUNK):
        some = slice(begin, begin + CHUNK)
        parts.append(_compute_piece_errors(flight, begun, about, which, index, some))
    left, columns = (np.concatenate(each) for each in zip(*parts, strict=True))
    return HorizonErrors(left, columns)


def find_measured_poses(flight: FlightLinearizer, horizons: Sequence[float]) -> NDArray[np.bool_]:
    """Return what was measured at the horizons, shape (S, H, 6), also where forecasts diverge."""
    at = np.rint(np.asarray(horizons) / PERIOD).astype(np.int64)
    index, measured = flight.index[:, at], flight.replay.flight
    place = np.isfinite(measured.position[index])
    turn = np.isfinite(measured.quaternion[index]).all(axis=-1, keepdims=True)
    valid = np.concatenate([place, np.repeat(turn, 3, axis=-1)], axis=-1)
    valid[~flight.replay.cut.inside[:, at]] = False
    return valid


def _compute_piece_errors(
    flight: FlightLinearizer,
    begun: LinearizationPoint,
    about: LinearizationInputs,
    which: Sequence[int],
    index: NDArray[np.int64],
    some: slice,
) -> tuple[Array, Array]:
    """Return errors and sensitivities of some pieces."""
    replay, time, acting = flight.replay, flight.time[some], about.rows.acting
    start = transform_to_map(replay.cut.start[some], acting)
    latent = np.zeros((len(time), replay.span, AXES))
    states = replay.integrate_pieces(about.rows, about.ready, start, latent, some)
    grid = states[:, ::STEPS]
    position, quaternion = predict_pose(grid, time, acting)
    at = flight.index[some][:, index]
    turn = quaternion_logarithm(
        quaternion_product(
            quaternion_conjugate(quaternion[:, index]), replay.flight.quaternion[at]
        )
    )
    left = np.concatenate([replay.flight.position[at] - position[:, index], turn], axis=-1)
    left[~replay.cut.inside[some][:, index]] = np.nan
    columns = np.zeros((*left.shape, len(which)))
    if not len(which):
        return left, columns
    answers = flight.state_sensitivities(begun, about, states, some)[:, index]
    answers = pose_sensitivity(answers, grid[:, index], acting)
    order = list(which)
    for j, k in enumerate(about.moving):
        columns[..., order.index(k)] = answers[..., flight.motion + j]
    for turned, k in zip(about.turned, about.reading, strict=True):
        # A rotation of the tracker frame also rotates the initial state of a piece.
        begins = start_sensitivity(replay.cut.start[some], turned)
        columns[..., order.index(k)] = np.einsum('shpb,sb->shp', answers[..., :WIDTH], begins)
    for turned, k in zip(about.turned, about.reading, strict=True):
        a, b = (predict_pose(grid, time, rows.acting) for rows in turned[:2])
        turns = quaternion_logarithm(
            quaternion_product(quaternion_conjugate(a[1][:, index]), b[1][:, index])
        )
        change = np.concatenate([(b[0] - a[0])[:, index], turns], axis=-1)
        columns[..., order.index(k)] += change / turned.step
    return left, columns
