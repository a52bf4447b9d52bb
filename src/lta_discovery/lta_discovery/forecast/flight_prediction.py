"""Predict a flight with one set of parameters, piece by piece from measured initial states."""

from typing import Final, final, NamedTuple
import warnings

from lta_discovery.fit.evidence import STATE
from lta_discovery.flights.measured_flight import CHANNELS
from lta_discovery.model.quaternions import rotation_matrix
from lta_discovery.replay.flight_linearizer import FlightLinearizer
from lta_discovery.replay.linearized_flight import LinearizationPoint
from lta_discovery.replay.replay import STEPS
from lta_discovery.replay.sensing import predict_readings
from lta_discovery.replay.variational_equation import apply_state_changes, NUDGE, WIDTH
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

POSE: Final = slice(0, 6)  # of CHANNELS


@final
class ModelPrediction(NamedTuple):
    """Prediction of a flight by a model."""

    time: Array  # of each piece, shape (S, n) [s]
    position: Array  # NaN outside of the pieces, shape (S, n, 3) [m]
    heading: Array  # shape (S, n) [rad]
    # Mean speed and mean absolute yaw rate of each piece, shape (S,) [m/s, rad/s]
    speed: Array
    turning: Array


def build_uncorrected_point(point: LinearizationPoint) -> LinearizationPoint:
    """Return a point without corrections of initial states or latent forces."""
    return LinearizationPoint(point.nominal, point.values, np.zeros_like(point.random))


def predict_flight(flight: FlightLinearizer, point: LinearizationPoint) -> ModelPrediction:
    """Predict a flight; initial-state corrections and latent forces are ignored."""
    point, rows = build_uncorrected_point(point), flight.replay.build_replay_rows(point.nominal)
    states = flight.simulate_forecast(point)[:, ::STEPS]
    predicted = predict_readings(states, flight.time, rows.acting, flight.places)
    out = ~flight.replay.cut.inside
    position, turn = predicted.position.copy(), heading_from_quaternion(predicted.quaternion)
    position[out], turn[out] = np.nan, np.nan
    # Body velocity, so relative to the map, not to the air
    speed = np.linalg.norm(states[..., 7:10], axis=-1).mean(axis=1)
    turning = np.abs(states[..., 12]).mean(axis=1)
    return ModelPrediction(flight.time, position, turn, speed, turning)


def heading_from_quaternion(quaternion: Array) -> Array:
    """Return the heading of the body x axis [rad], shape (...), from quaternions (..., 4)."""
    rotation = rotation_matrix(quaternion)
    heading: Array = np.arctan2(rotation[..., 1, 0], rotation[..., 0, 0])
    return heading


def error_to_noise(left: Array) -> Array:
    """Return the RMS error of each piece by the noise, shape (S, 14); 1 for a perfect model."""
    finite = np.isfinite(left)
    total = np.sum(np.where(finite, left, 0.0) ** 2, axis=1)
    count = finite.sum(axis=1)
    # A piece needs at least 5 readings of a channel for a meaningful RMS.
    out: Array = np.sqrt(np.where(count > 4, total / np.maximum(count, 1), np.nan))
    return out


def best_start_residual(flight: FlightLinearizer, point: LinearizationPoint) -> Array:
    """
    Return the residuals of a flight with the best-fitting initial state of each piece.

    Initial velocities are known to some cm/s only, and sensors have offsets in each flight. Both
    would hide the error of the model itself. Each piece therefore corrects its initial state, by
    one Gauss-Newton step, and each sensor its offset.

    The result has shape (S, n, 14): by the noise; NaN where nothing was measured.
    """
    point, replay = build_uncorrected_point(point), flight.replay
    met = replay.build_replay_rows(point.nominal)
    ready, push = replay.compute_body_inputs(met), np.zeros((len(replay.first), replay.span, 6))

    def compute_residual(start: Array) -> Array:
        states = replay.integrate_pieces(met, ready, start, push)[:, ::STEPS]
        out: Array = flight.compute_residual(states, point, met) / replay.flight.noise
        return out

    start = replay.cut.start
    base = _remove_offsets(compute_residual(start))
    finite = np.isfinite(base)
    columns = np.empty((*base.shape, WIDTH))
    for k in range(WIDTH):
        aside = np.broadcast_to(NUDGE * (np.arange(WIDTH) == k), (len(start), WIDTH))
        # NaN entries stay NaN in the difference and are set to 0 below.
        columns[..., k] = (
            base - _remove_offsets(compute_residual(apply_state_changes(start, aside)))
        ) / NUDGE[k]
    columns = np.where(finite[..., None], columns, 0.0)
    target = np.where(finite, base, 0.0)
    # Fit to the pose alone: with its low noise, a gyroscope with a scale error would dominate.
    rows = columns[..., POSE, :].reshape(len(base), -1, WIDTH)
    pose_target = target[..., POSE].reshape(len(base), -1, 1)
    across = np.swapaxes(rows, 1, 2)
    # One Gauss-Newton step, regularized by the accuracy of the initial states
    change = np.linalg.solve(across @ rows + np.diag(STATE**-2.0), across @ pose_target)
    better = target - (columns @ change[:, None])[..., 0]
    return _remove_offsets(np.where(finite, better, np.nan))


def _remove_offsets(left: Array) -> Array:
    """Remove the median of each sensor over the flight, and of the pressure in each piece."""
    out = left.copy()
    with warnings.catch_warnings():
        warnings.simplefilter('ignore', RuntimeWarning)  # a channel without readings
        # Channels 6 to 12 are rates, specific force and range; 13 is pressure
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
