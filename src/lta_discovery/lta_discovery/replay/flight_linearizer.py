"""
Linearize a flight about a set of parameters: residuals and their sensitivities.

The columns are the initial state of each piece, the knots of a latent wrench, the pressure, and
every free parameter. Only the products of whitened columns are stored per piece.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import Final, final

from lta_discovery.flights.measured_flight import CHANNELS, PERIOD
from lta_discovery.model.nominal import ReplayRows
from lta_discovery.model.parameters import FreeParameter
from lta_discovery.model.quaternions import (
    quaternion_conjugate,
    quaternion_logarithm,
    quaternion_product,
)
from lta_discovery.model.replay_kernel import BODY_PLACES
from lta_discovery.replay.linearization_inputs import (
    LinearizationInputs,
    prepare_linearization,
    SensorStep,
)
from lta_discovery.replay.linearized_flight import (
    AXES,
    count_unknowns,
    hat_functions,
    LinearizationPoint,
    LinearizedFlight,
    SENSORS,
)
from lta_discovery.replay.reading_jacobian import reading_jacobians
from lta_discovery.replay.replay import BodyInputs, FlightReplay, STEPS
from lta_discovery.replay.sensing import (
    ideal_readings,
    pose_sensitivity,
    predict_readings,
    PredictedReadings,
    SensorPlaces,
    transform_to_map,
)
from lta_discovery.replay.variational_equation import (
    apply_state_changes,
    discretize_dynamics,
    propagate_changes,
    WIDTH,
)
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

CHUNK: Final = 8  # pieces at a time, to limit memory
POSE: Final = 6  # number of pose channels, the first of CHANNELS


@final
class FlightLinearizer:
    """
    Linearize one flight.

    Attributes `index`, `time`, shape (S, n): grid points of each piece, and their times [s].
    Attributes `random`, `motion`: number of unknowns of a piece, and of those that affect its
    motion, which come first.
    """

    def __init__(
        self, replay: FlightReplay, knobs: Sequence[FreeParameter], places: SensorPlaces
    ) -> None:
        self.replay, self.knobs, self.places = replay, list(knobs), places
        flight, cut = replay.flight, replay.cut
        # The last piece may end after the flight; its readings there are masked by `inside`
        steps = cut.first[:, None] + np.arange(cut.length)
        self.index = np.minimum(steps, len(flight.time) - 1)
        self.time = flight.time[0] + PERIOD * steps
        self._knots, self.random = cut.knots, count_unknowns(cut.knots)
        # All unknowns but the pressure, which is the last
        self.motion = self.random - 1
        self._hats = hat_functions(replay.span, cut.knots)
        # The same weights per grid period, for the sensitivities
        self._sparse = self._hats.reshape(-1, STEPS, self._knots).mean(axis=1)

    def with_knots(self, knots: int) -> 'FlightLinearizer':
        """Return the flight with another number of knots in each piece."""
        cut = replace(self.replay.cut, knots=knots)
        return FlightLinearizer(self.replay.with_pieces(cut), self.knobs, self.places)

    def simulate_trajectory(self, point: LinearizationPoint, which: slice = slice(None)) -> Array:
        """Return the states at each step, shape (S, span + 1, 13)."""
        rows = self.replay.build_replay_rows(point.nominal)
        return self._simulate_pieces(rows, self.replay.compute_body_inputs(rows), point, which)

    def simulate_forecast(self, point: LinearizationPoint) -> Array:
        """
        Return the states at each step without corrections, shape (S, span + 1, 13).

        The states start at the measured ones and are in the map frame, whatever the tracker frame.
        """
        rows = self.replay.build_replay_rows(point.nominal)
        start = transform_to_map(self.replay.cut.start, rows.acting)
        latent = np.zeros((len(start), self.replay.span, AXES))
        return self.replay.integrate_pieces(
            rows, self.replay.compute_body_inputs(rows), start, latent
        )

    def _simulate_pieces(
        self, rows: ReplayRows, ready: BodyInputs, point: LinearizationPoint, which: slice
    ) -> Array:
        """Return the states at each step of some pieces."""
        told_at = self.replay.cut.start[which]
        # Poses are in the tracker frame; the model needs the map frame
        begun = transform_to_map(told_at, rows.acting)
        start = apply_state_changes(begun, point.random[which, :WIDTH])
        latent = self._interpolate_latent(point, which, self._hats)
        return self.replay.integrate_pieces(rows, ready, start, latent, which)

    def _interpolate_latent(self, point: LinearizationPoint, which: slice, hats: Array) -> Array:
        """Return the latent force and moment on the vehicle in each step."""
        knots: Array = point.random[which, WIDTH : self.motion].reshape(-1, AXES, self._knots)
        return np.ascontiguousarray(np.einsum('saj,kj->ska', knots, hats))

    def compute_whitened_columns(
        self,
        point: LinearizationPoint,
        which: slice = slice(None),
        columns: Flags | None = None,
    ) -> tuple[Array, Array]:
        """
        Return columns, shape (S, n, 14, N), and residuals about a point, by the noise.

        Columns are the unknowns of the piece, then parameters, then SENSORS. `columns`, shape
        (G,): parameters whose columns are computed; the others are 0. All by default.
        """
        about = prepare_linearization(self.replay, self.knobs, point, columns)
        table, left = self._compute_whitened_table(point, about, which)
        out = np.zeros((*left.shape, self.random + len(self.knobs) + len(SENSORS)))
        out[:, :, : table.shape[2], self._column_order(about)[:-1]] = table[..., :-1]
        return out, left

    def linearize(
        self, point: LinearizationPoint, columns: Flags | None = None
    ) -> LinearizedFlight:
        """
        Linearize the flight about a point.

        `columns`, shape (G,): columns to compute (`Prior.free`); the others are 0, which is
        faster. All by default. Raise `BadInput` for an impossible vehicle.
        """
        about, pieces = (
            prepare_linearization(self.replay, self.knobs, point, columns),
            len(self.replay.first),
        )
        size, order = self.random + len(self.knobs) + len(SENSORS) + 1, self._column_order(about)
        grams = np.zeros((pieces, size, size))
        counts = np.empty(pieces, dtype=np.int64)
        residual = np.empty((pieces, self.replay.cut.length, len(CHANNELS)))
        for begin in range(0, pieces, CHUNK):
            which = slice(begin, begin + CHUNK)
            table, left = self._compute_whitened_table(point, about, which)
            finite = np.isfinite(left)
            # An unmeasured reading contributes nothing to the products
            table[~finite[..., : table.shape[2]]] = 0.0
            flat = table.reshape(len(table), -1, len(order))
            grams[begin : begin + len(table), order[:, None], order] = (
                np.swapaxes(flat, 1, 2) @ flat
            )
            counts[which] = finite.sum(axis=(1, 2))
            residual[which] = left
        names = (*(knob.name for knob in self.knobs), *SENSORS)
        return LinearizedFlight(names, grams, counts, point, residual)

    def _column_order(self, about: LinearizationInputs) -> NDArray[np.int64]:
        """Return the index of each table column among all columns; the last is the residual."""
        first = self.random
        own = first + len(self.knobs)
        moving, reading = ([first + k for k in some] for some in (about.moving, about.reading))
        sensors = range(own, own + len(SENSORS) + 1)
        # Columns are stored in the order in which they are computed; this restores theirs
        return np.array([*range(self.motion), *moving, first - 1, *reading, *sensors])

    def _compute_whitened_table(
        self, point: LinearizationPoint, about: LinearizationInputs, which: slice
    ) -> tuple[Array, Array]:
        """
        Return whitened columns in the order of `_column_order`, and residuals.

        Without another sensor the columns are of the pose alone.
        """
        noise = self.replay.flight.noise
        states = self._simulate_pieces(about.rows, about.ready, point, which)
        grid, time = states[:, ::STEPS], self.time[which]
        exact = ideal_readings(grid[:, :-1], grid[:, 1:], self.places)
        base = predict_readings(grid, time, about.rows.acting, self.places, exact)
        left = self._subtract_predicted(base, point, which) / noise
        channels = len(CHANNELS) if np.isfinite(noise[POSE:]).any() else POSE
        table = np.zeros((*left.shape[:2], channels, len(self._column_order(about))))
        end = self.motion + len(about.moving)
        change = self.state_sensitivities(point, about, states, which)
        self._write_reading_columns(change, grid, exact, time, about, table[..., :end])
        for k, turn in enumerate(about.turned):
            grids: tuple[Array, Array] = (grid, grid)
            same: Array | None = exact
            # The initial state follows the tracker frame, and so does the whole trajectory. The
            # sensitivities would leave a turn about the vertical some effect.
            if turn.after.acting['pose'] != turn.before.acting['pose']:
                before, after = (
                    self._simulate_pieces(rows, about.ready, point, which)[:, ::STEPS]
                    for rows in (turn.before, turn.after)
                )
                grids, same = (before, after), None
            read = self._difference_readings(grids, time, turn, same)[..., :channels]
            table[..., end + 1 + k] = read / (turn.step * noise[:channels])
        if channels > POSE:
            own = table.shape[-1] - 1 - len(SENSORS)
            # Offsets of the pressure in the piece and the flight, then force scales.
            table[:, :, 13, [end, own]] = 1.0 / noise[13]
            for axis in range(3):
                force = base.readings[..., 3 + axis]
                table[:, :, 9 + axis, own + 1 + axis] = force / noise[9 + axis]
        table[..., -1] = left[..., :channels]
        return table, left

    def compute_residual(self, grid: Array, point: LinearizationPoint, rows: ReplayRows) -> Array:
        """
        Return measured minus predicted, shape (S, n, 14), for states (S, n + 1, 13).

        By CHANNELS in SI units; NaN where nothing was measured.
        """
        base = predict_readings(grid, self.time, rows.acting, self.places)
        return self._subtract_predicted(base, point, slice(None))

    def _subtract_predicted(
        self, base: PredictedReadings, point: LinearizationPoint, which: slice
    ) -> Array:
        """Return measured minus predicted readings."""
        flight, index = self.replay.flight, self.index[which]
        # Attitude error as a rotation vector in the body, small enough to be linear
        turn = quaternion_logarithm(
            quaternion_product(quaternion_conjugate(base.quaternion), flight.quaternion[index])
        )
        readings_left = flight.readings[index] - base.readings
        offset, *scales = point.values[-len(SENSORS) :]
        # Pressure offset of the flight and of the piece
        readings_left[..., 7] -= offset + point.random[which, -1:]
        readings_left[..., 3:6] -= np.array(scales) * base.readings[..., 3:6]
        left = np.concatenate(
            [flight.position[index] - base.position, turn, readings_left], axis=-1
        )
        left[~self.replay.cut.inside[which]] = np.nan
        # Infinite or unknown noise marks a channel that was not recorded
        left[..., ~np.isfinite(flight.noise)] = np.nan
        left[~np.isfinite(left)] = np.nan
        return left

    def state_sensitivities(
        self, point: LinearizationPoint, about: LinearizationInputs, states: Array, which: slice
    ) -> Array:
        """
        Return the sensitivities of the states on the grid.

        `states`, shape (S, span + 1, 13): simulated at the point. The result has shape (S, n + 1,
        12, motion + moving): to the 12 of the initial state, the knots, and the parameters that
        affect the motion.
        """
        # Whole grid periods suffice: columns need less accuracy than the prediction.
        middle = np.ascontiguousarray(states[:, STEPS // 2 :: STEPS])
        latent = self._interpolate_latent(point, which, self._sparse)
        jacobian = self.replay.state_jacobians(about.turns, middle, latent, which)
        # Without the latent wrench: its prior shrinks it, which would favour a lighter vehicle.
        answers = self.replay.parameter_sensitivities(
            about.turns, middle, np.zeros_like(latent), which
        )
        # A force accelerates by the inverse of the mass matrix, independent of the motion.
        inverse = _inverse_mass(about.rows)
        # Acceleration in each period per unit force at each knot
        knots = np.einsum('ia,kj->kiaj', inverse, self._sparse).reshape(
            -1, AXES, AXES * self._knots
        )
        pushed = [np.broadcast_to(knots, (len(states), *knots.shape)), answers]
        a, b = discretize_dynamics(jacobian, PERIOD)
        # Accelerations enter the last six components of a change only
        return propagate_changes(a, b[..., AXES:] @ np.concatenate(pushed, axis=-1))

    def _write_reading_columns(
        self,
        change: Array,
        grid: Array,
        exact: Array,
        time: Array,
        about: LinearizationInputs,
        out: Array,
    ) -> None:
        """Write the sensitivities of the readings, by the noise."""
        noise, acting = self.replay.flight.noise[:, None], about.rows.acting
        begin, end = change[:, :-1], change[:, 1:]
        out[:, :, :POSE] = pose_sensitivity(begin, grid[:, :-1], acting) / noise[:POSE]
        if out.shape[2] > POSE:
            slopes = reading_jacobians(grid, exact, time, acting, self.places)
            first, last = (slope / noise[POSE:] for slope in slopes)
            out[:, :, POSE:] = first @ begin
            out[:, :, POSE:12] += last[:, :, :6] @ end  # range and pressure are of an instant

    def _difference_readings(
        self, grids: tuple[Array, Array], time: Array, turn: SensorStep, exact: Array | None
    ) -> Array:
        """
        Return the difference of readings under two sets of measurement effects.

        `exact`: ideal readings, if they are those of both trajectories.
        """
        a, b = (
            predict_readings(grid, time, rows.acting, self.places, exact)
            for grid, rows in zip(grids, (turn.before, turn.after), strict=True)
        )
        turned = quaternion_logarithm(
            quaternion_product(quaternion_conjugate(a.quaternion), b.quaternion)
        )
        return np.concatenate([b.position - a.position, turned, b.readings - a.readings], axis=-1)


def _inverse_mass(rows: ReplayRows) -> Array:
    """Return the inverse mass matrix of a vehicle, shape (6, 6)."""
    return rows.body[BODY_PLACES['inverse']].reshape(AXES, AXES)


def start_sensitivity(states: Array, turn: SensorStep) -> Array:
    """Return the sensitivity of measured initial states to the tracker frame, shape (S, 12)."""
    a, b = (transform_to_map(states, rows.acting) for rows in turn[:2])
    out = np.zeros((len(states), WIDTH))
    out[:, :3] = (b[:, :3] - a[:, :3]) / turn.step
    out[:, 3:POSE] = (
        quaternion_logarithm(quaternion_product(quaternion_conjugate(a[:, 3:7]), b[:, 3:7]))
        / turn.step
    )
    out[:, POSE:] = (b[:, 7:] - a[:, 7:]) / turn.step
    return out
