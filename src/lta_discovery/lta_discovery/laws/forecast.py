"""
Forecast flights under a law.

The law acts as an outer wrench on the replay. It depends on the motion that it causes, so motion
and wrench are computed in turn until they agree; over some seconds that takes a few rounds.
"""

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Final, final, Protocol

from lta_config.schema.vehicle_law import Law
from lta_discovery.fit.bounds import apply_parameters
from lta_discovery.flights.measured_flight import PERIOD
from lta_discovery.flights.windows import cut_into_pieces
from lta_discovery.forecast.held_out import (
    compute_forecast_residuals,
    compute_own_columns,
    count_learning_pieces,
    estimate_own_errors,
    Simulate,
)
from lta_discovery.forecast.prediction_errors import HORIZONS
from lta_discovery.laws.quantities import (
    at_pieces,
    filter_hidden,
    follow_drive,
    input_quantities,
    measured_states,
    state_quantities,
)
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.quaternions import rotation_matrix
from lta_discovery.replay.diverging_pieces import drop_diverging_pieces
from lta_discovery.replay.flight_linearizer import FlightLinearizer, POSE
from lta_discovery.replay.linearized_flight import (
    AXES,
    hat_functions,
    LinearizationPoint,
    unchanged_vehicle_point,
    zero_unknowns,
)
from lta_discovery.replay.replay import STEPS
from lta_discovery.replay.sensing import transform_to_map
from lta_discovery.replay.variational_equation import WIDTH
from lta_model.law_arrays import evaluate_drive_fade, evaluate_law, evaluate_product
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

OVERLAPS: Final = 4  # windows that a moment of a held-out flight belongs to
ROUNDS: Final = 12  # most rounds of motion and wrench
DIVERGED: Final = 1e3  # m or rad; stands for the error of a forecast that diverges
SAME: Final = 1e-3  # of the largest wrench; difference at which they agree


class WrenchLaw(Protocol):
    """A force and moment that follows the motion of one flight."""

    def compute_wrench(self, states: Array) -> Array:
        """Return the wrench in each step of the pieces, shape (S, span, 6), body frame."""
        ...


Prepare = Callable[[FlightLinearizer, NominalVehicle], WrenchLaw]


@final
class FlightLaw:
    """A law on one flight: with its inputs, and its hidden state where each piece begins."""

    def __init__(self, law: Law, flight: FlightLinearizer, nominal: NominalVehicle) -> None:
        self._law = law
        inputs = input_quantities(flight, nominal)
        self._known = {
            name: np.repeat(values, STEPS, axis=1)
            for name, values in at_pieces(flight, inputs).items()
        }
        if law.hidden is not None:
            whole = state_quantities(measured_states(flight, len(inputs['time']))) | inputs
            first = np.maximum(flight.replay.cut.first - 1, 0)
            both = follow_drive(law.hidden, whole, evaluate_drive_fade(law, whole))
            self._begin = np.column_stack([each[first] for each in both])

    def compute_wrench(self, states: Array) -> Array:
        """Return the wrench in each step of the pieces, shape (S, span, 6), body frame."""
        middle = 0.5 * (states[:, :-1] + states[:, 1:])
        quantities = state_quantities(middle) | self._known
        hidden = self._law.hidden
        if hidden is not None:
            fade = evaluate_drive_fade(self._law, quantities)
            drive = fade * evaluate_product(hidden.drive, quantities)
            value, rate = filter_hidden(drive, PERIOD / STEPS, hidden, self._begin)
            quantities |= {'hidden': value, 'hidden_rate': rate}
        return evaluate_law(self._law, quantities, rotation_matrix(middle[..., 3:7]))


def simulate_under_law(
    flight: FlightLinearizer, point: LinearizationPoint, law: WrenchLaw
) -> Array:
    """Return the states of a forecast at each step, shape (S, span + 1, 13)."""
    replay = flight.replay
    rows = replay.build_replay_rows(point.nominal)
    ready, start = (
        replay.compute_body_inputs(rows),
        transform_to_map(replay.cut.start, rows.acting),
    )
    wrench = np.zeros((len(start), replay.span, AXES))
    with np.errstate(over='ignore', invalid='ignore'):
        states = replay.integrate_pieces(rows, ready, start, wrench)
        for _ in range(ROUNDS):
            now = law.compute_wrench(states)
            if not np.isfinite(now).all():
                break
            apart, wrench = np.max(np.abs(now - wrench)), now
            states = replay.integrate_pieces(rows, ready, start, wrench)
            if apart <= SAME * float(np.max(np.abs(now))):
                break
    return states


def build_simulation(
    flight: FlightLinearizer, nominal: NominalVehicle, prepare: Prepare | None
) -> Simulate:
    """Return a function that simulates the forecasts of a flight, with a law or without (None)."""
    if prepare is None:
        return FlightLinearizer.simulate_forecast
    return partial(_simulate_prepared, prepare(flight, nominal))


def _simulate_prepared(
    law: WrenchLaw, flight: FlightLinearizer, point: LinearizationPoint
) -> Array:
    """Simulate a forecast under a law, which comes first."""
    return simulate_under_law(flight, point, law)


def overlap_windows(flight: FlightLinearizer, nominal: NominalVehicle) -> FlightLinearizer:
    """
    Return a flight in overlapping windows, after the pieces that its own errors are learned from.

    A few pieces of a flight tell small differences between forecasts badly: chance decides.
    """
    cut, replay = flight.replay.cut, flight.replay
    dense = cut_into_pieces(replay.flight, knots=cut.knots, overlaps=OVERLAPS)
    late = dense.first >= cut.first[count_learning_pieces(flight)]
    dense = replace(
        dense, first=dense.first[late], start=dense.start[late], inside=dense.inside[late]
    )
    there = FlightLinearizer(replay.with_pieces(dense), flight.knobs, flight.places)
    return drop_diverging_pieces(there, nominal)[0]


@final
class LawForecaster:
    """Forecast residuals of one flight under laws, for shared parameters."""

    def __init__(
        self, flight: FlightLinearizer, nominal: NominalVehicle, deviations: Array
    ) -> None:
        self._flight, self._nominal, self._deviations = flight, nominal, deviations
        self._count = count_learning_pieces(flight)
        self._columns: Array | None = None
        self._known: NDArray[np.bool_] | None = None

    @property
    def flight(self) -> FlightLinearizer:
        """The flight."""
        return self._flight

    def compute_residuals(self, prepare: Prepare | None, at: Array) -> Array:
        """Return measured minus predicted at each horizon, shape (S, H, 14); None is no law."""
        point, simulate = self._build_point(prepare, at)
        return compute_forecast_residuals(self._flight, point, simulate=simulate)

    def compute_dense_residuals(
        self, dense: FlightLinearizer, prepare: Prepare | None, at: Array
    ) -> Array:
        """Return the residuals of the same flight in overlapping windows (`overlap_windows`)."""
        nominal = self._build_point(prepare, at)[0].nominal
        point = LinearizationPoint(nominal, at, zero_unknowns(dense.replay.cut))
        return compute_forecast_residuals(
            dense, point, simulate=build_simulation(dense, nominal, prepare), learned=0
        )

    def compute_pose_residuals(self, prepare: Prepare | None, at: Array) -> Array:
        """Return the residuals of the pose, NaN only where it was not measured, (S, H, 6)."""
        return self._complete_pose(self.compute_residuals(prepare, at))

    def linearize_pose(
        self, prepare: Prepare, at: Array, free: NDArray[np.bool_]
    ) -> tuple[Array, Array, Array]:
        """
        Return the residuals of the pose, and how its prediction changes.

        `free`, shape (G,): shared parameters of which the change is needed; that by others is 0.

        Returns
        -------
        left : ndarray, shape (S, H, 6)
        shared : ndarray, shape (S, H, 6, G)
            Change by the shared parameters.
        pushed : ndarray, shape (S, H, 6, 6 K)
            Change by a wrench at the knots, axis by axis.

        """
        flight, (point, simulate) = self._flight, self._build_point(prepare, at)
        left = compute_forecast_residuals(flight, point, simulate=simulate)
        # The law as a wrench at the knots, so that changes are about the motion under the law
        wrench = prepare(flight, point.nominal).compute_wrench(simulate(flight, point))
        knots, random = point.knots, point.random.copy()
        hats = np.linalg.pinv(hat_functions(flight.replay.span, knots))
        latent = slice(WIDTH, WIDTH + AXES * knots)
        random[:, latent] = np.einsum('kt,sta->sak', hats, wrench).reshape(len(random), -1)
        about = replace(point, random=random)
        after, some = slice(self._count, None), free[: len(flight.knobs)]
        columns = flight.compute_whitened_columns(about, after, some)[0]
        at_horizons = [min(round(t / PERIOD), columns.shape[1] - 1) for t in HORIZONS]
        columns = columns[:, at_horizons, :POSE] * flight.replay.flight.noise[:POSE, None]
        return (
            self._complete_pose(left), columns[..., random.shape[1] :], columns[..., latent],
        )  # fmt: skip

    def _complete_pose(self, left: Array) -> Array:
        """Return the residuals of the pose with a huge value where a forecast diverges."""
        if self._known is None:
            flight = self._flight
            still = unchanged_vehicle_point(self._nominal, flight.knobs, flight.replay.cut)
            self._known = np.isfinite(compute_forecast_residuals(flight, still, coast=True))
        pose_known, left = self._known[..., :POSE], left[..., :POSE]
        return np.where(pose_known, np.where(np.isfinite(left), left, DIVERGED), np.nan)

    def _build_point(
        self, prepare: Prepare | None, at: Array
    ) -> tuple[LinearizationPoint, Simulate]:
        """Return the point of the forecasts with the flight's own errors, and how to simulate."""
        flight, knobs = self._flight, self._flight.knobs
        vehicle, values = apply_parameters(self._nominal, knobs, at)
        point = LinearizationPoint(vehicle, values, zero_unknowns(flight.replay.cut))
        simulate = build_simulation(flight, vehicle, prepare)
        if self._count:
            # The columns serve all laws and parameters: they differ little
            if self._columns is None:
                self._columns = compute_own_columns(flight, point, self._count)
            own = estimate_own_errors(
                flight, point, self._columns, self._deviations, self._count, simulate
            )
            vehicle, values = apply_parameters(self._nominal, knobs, values + own)
            point = LinearizationPoint(vehicle, values, point.random)
        return point, simulate
