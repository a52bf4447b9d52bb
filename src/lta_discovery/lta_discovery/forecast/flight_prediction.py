"""What one set of parameters makes of a flight, piece by piece, from where each piece begins."""

from typing import Final, final, NamedTuple
import warnings

from lta_discovery.fit.evidence import STATE
from lta_discovery.flights.measured_flight import CHANNELS
from lta_discovery.model.quaternions import rotation_matrix
from lta_discovery.replay.linearized_flight import LinearizationPoint
from lta_discovery.replay.linearizer import FlightLinearizer
from lta_discovery.replay.replay import STEPS
from lta_discovery.replay.sensing import predict_readings
from lta_discovery.replay.variational_equation import add_change, NUDGE, WIDTH
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

POSE: Final = slice(0, 6)  # of CHANNELS


@final
class ModelPrediction(NamedTuple):
    """
    A flight as a model has it.

    Attributes
    ----------
    time : ndarray, shape (S, n)
        Of each piece. [s]
    position : ndarray, shape (S, n, 3)
        Predicted; NaN where the flight does not count. [m]
    heading : ndarray, shape (S, n)
        Predicted. [rad]
    speed, turning : ndarray, shape (S,)
        Of each piece, how fast it flies and turns on the mean. [m/s, rad/s]

    """

    time: Array
    position: Array
    heading: Array
    speed: Array
    turning: Array


def build_unaided_point(point: LinearizationPoint) -> LinearizationPoint:
    """Return a point at which nobody helps the model on its way."""
    return LinearizationPoint(point.nominal, point.values, np.zeros_like(point.random))


def predict_flight(flight: FlightLinearizer, point: LinearizationPoint) -> ModelPrediction:
    """Return a flight as a model has it; the states and forces of the point are not used."""
    point, rows = build_unaided_point(point), flight.replay.build_rows(point.nominal)
    states = flight.simulate_forecast(point)[:, ::STEPS]
    said = predict_readings(states, flight.time, rows.acting, flight.places)
    out = ~flight.replay.cut.inside
    position, turn = said.position.copy(), heading_angle(said.quaternion)
    position[out], turn[out] = np.nan, np.nan
    speed = np.linalg.norm(states[..., 7:10], axis=-1).mean(axis=1)
    turning = np.abs(states[..., 12]).mean(axis=1)
    return ModelPrediction(flight.time, position, turn, speed, turning)


def heading_angle(quaternion: Array) -> Array:
    """Return where the nose points, shape (...), from shape (..., 4). [rad]"""
    rotation = rotation_matrix(quaternion)
    heading: Array = np.arctan2(rotation[..., 1, 0], rotation[..., 0, 0])
    return heading


def error_to_noise(left: Array) -> Array:
    """Return the error of each piece by the noise, shape (S, 14): 1 where nothing is missing."""
    known = np.isfinite(left)
    total = np.sum(np.where(known, left, 0.0) ** 2, axis=1)
    count = known.sum(axis=1)
    # A piece of which a channel knows next to nothing says nothing of it.
    out: Array = np.sqrt(np.where(count > 4, total / np.maximum(count, 1), np.nan))
    return out


def best_start_residual(flight: FlightLinearizer, point: LinearizationPoint) -> Array:
    """
    Return what is left over when each piece begins as suits it best.

    A start is known to some centimetres a second only, and a sensor has its own error in each
    flight: both would hide what the model itself leaves over. So each piece may choose its start,
    by one step of Gauss and Newton, and each sensor its offset.

    Returns
    -------
    ndarray, shape (S, n, 14)
        By the noise; NaN where nothing was measured.

    """
    point, replay = build_unaided_point(point), flight.replay
    met = replay.build_rows(point.nominal)
    ready, push = replay.compute_inputs(met), np.zeros((len(replay.first), replay.span, 6))

    def compute_residual(start: Array) -> Array:
        states = replay.integrate_pieces(met, ready, start, push)[:, ::STEPS]
        out: Array = flight.compute_residual(states, point, met) / replay.flight.noise
        return out

    start = replay.cut.start
    base = _remove_offsets(compute_residual(start))
    known = np.isfinite(base)
    columns = np.empty((*base.shape, WIDTH))
    for k in range(WIDTH):
        aside = np.broadcast_to(NUDGE * (np.arange(WIDTH) == k), (len(start), WIDTH))
        # A NaN less a NaN, and an offset less itself: only known differences are left.
        columns[..., k] = (
            base - _remove_offsets(compute_residual(add_change(start, aside)))
        ) / NUDGE[k]
    columns = np.where(known[..., None], columns, 0.0)
    target = np.where(known, base, 0.0)
    # By the pose alone: a gyroscope's scale would have its way, so little is its noise.
    rows = columns[..., POSE, :].reshape(len(base), -1, WIDTH)
    wanted = target[..., POSE].reshape(len(base), -1, 1)
    across = np.swapaxes(rows, 1, 2)
    change = np.linalg.solve(across @ rows + np.diag(STATE**-2.0), across @ wanted)
    better = target - (columns @ change[:, None])[..., 0]
    return _remove_offsets(np.where(known, better, np.nan))


def _remove_offsets(left: Array) -> Array:
    """Return what is left over without that of each sensor, and of the pressure in each piece."""
    out = left.copy()
    with warnings.catch_warnings():
        warnings.simplefilter('ignore', RuntimeWarning)  # a channel that is not there
        out[..., 6:13] -= np.nanmedian(out[..., 6:13], axis=(0, 1))
        out[..., 13] -= np.nanmedian(out[..., 13], axis=1)[:, None]
    return out


NAMES: Final = dict(
    zip(
        CHANNELS,
        (
            'position x', 'position y', 'position z', 'attitude x', 'attitude y', 'attitude z',
            'roll rate', 'pitch rate', 'yaw rate', 'accel. x', 'accel. y', 'accel. z',
            'range', 'pressure',
        ),
        strict=True,
    )
)  # fmt: skip
