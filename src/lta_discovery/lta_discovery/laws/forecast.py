"""
Forecast flights under a law.

The law acts as an outer wrench on the replay. It depends on the motion that it causes, so motion
and wrench are computed in turn until they agree; over some seconds that takes a few rounds.
"""

from collections.abc import Callable
from typing import Final, final, Protocol

from lta_config.schema.vehicle_law import Law
from lta_discovery.fit.bounds import apply_parameters
from lta_discovery.flights.measured_flight import PERIOD
from lta_discovery.forecast.held_out import (
    compute_forecast_residuals,
    count_learning_pieces,
    estimate_own_errors,
)
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
from lta_discovery.replay.flight_linearizer import FlightLinearizer
from lta_discovery.replay.linearized_flight import AXES, LinearizationPoint, zero_unknowns
from lta_discovery.replay.replay import STEPS
from lta_discovery.replay.sensing import transform_to_map
from lta_model.law_arrays import evaluate_drive_fade, evaluate_law, evaluate_product
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

ROUNDS: Final = 12  # most rounds of motion and wrench
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


@final
class LawForecaster:
    """Forecast residuals of one flight under laws, for shared parameters."""

    def __init__(
        self, flight: FlightLinearizer, nominal: NominalVehicle, deviations: Array
    ) -> None:
        self._flight, self._nominal, self._deviations = flight, nominal, deviations
        self._count = count_learning_pieces(flight)
        self._columns: Array | None = None

    def compute_residuals(self, prepare: Prepare | None, at: Array) -> Array:
        """Return measured minus predicted at each horizon, shape (S, H, 14); None is no law."""
        flight, knobs = self._flight, self._flight.knobs
        vehicle, values = apply_parameters(self._nominal, knobs, at)
        point = LinearizationPoint(vehicle, values, zero_unknowns(flight.replay.cut))
        law = prepare(flight, vehicle) if prepare else None

        def simulate(flight: FlightLinearizer, point: LinearizationPoint) -> Array:
            return (
                simulate_under_law(flight, point, law) if law else flight.simulate_forecast(point)
            )

        if self._count:
            # The columns serve all laws and parameters: they differ little
            if self._columns is None:
                self._columns = flight.compute_whitened_columns(point, slice(0, self._count))[0]
            own = estimate_own_errors(
                flight, point, self._columns, self._deviations, self._count, simulate
            )
            vehicle, values = apply_parameters(self._nominal, knobs, values + own)
            point = LinearizationPoint(vehicle, values, point.random)
        return compute_forecast_residuals(flight, point, simulate=simulate)
