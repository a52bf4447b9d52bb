"""Collect what a law may depend on in jointly fitted flights, and their unexplained wrench."""

from collections.abc import Mapping, Sequence
from typing import Final, final, Literal, NamedTuple

from lta_config.schema.vehicle_law import HiddenState
from lta_discovery.fit.joint_fit import JointFit
from lta_discovery.laws.dictionary import Column, Spread
from lta_discovery.laws.quantities import (
    at_pieces,
    follow_drive,
    input_quantities,
    measured_states,
    middle_states,
    Quantities,
    state_quantities,
)
from lta_discovery.laws.regression import WrenchRegression
from lta_discovery.model.quaternions import rotation_matrix
from lta_discovery.replay.flight_linearizer import FlightLinearizer
from lta_discovery.replay.linearized_flight import AXES, hat_functions, LinearizedFlight
from lta_model.law_arrays import evaluate_product, HIDDEN_QUANTITIES
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Side = Literal['train', 'confirm', 'all']  # flights of a fit: one role, or both

LEAST: Final = 0.1  # noise floors; smallest deviation


@final
class FlightQuantities(NamedTuple):
    """Quantities of one flight, on which a law may depend."""

    pieces: Quantities  # in each grid period of the fitted pieces, shape (S, n)
    whole: Quantities  # of the measured motion over the whole flight, shape (T,)
    first: NDArray[np.int64]  # grid period in which each piece begins, shape (S,)
    rotations: Array  # body to map, at the knots of the pieces, shape (S, K, 3, 3)

    @classmethod
    def from_fit(cls, flight: FlightLinearizer, linear: LinearizedFlight) -> 'FlightQuantities':
        """Return the quantities of a fitted flight."""
        states = flight.simulate_trajectory(linear.point)
        inputs = input_quantities(flight, linear.point.nominal)
        motion = state_quantities(measured_states(flight, len(inputs['time'])))
        index = np.rint(np.linspace(0, states.shape[1] - 1, linear.knots)).astype(int)
        return cls(
            state_quantities(middle_states(states)) | at_pieces(flight, inputs),
            motion | inputs,
            flight.replay.cut.first,
            rotation_matrix(states[:, index, 3:7]),
        )


@final
class LawData:
    """
    Jointly fitted flights as data for laws.

    Parameters
    ----------
    flights : sequence of FlightQuantities
        In the order of the fit: `count` training flights first, then the confirming ones.
    floor : ndarray, shape (6,)
        Noise floor of the wrench. [N, N m]
    reach : mapping of str to tuple of float, optional
        Lowest and highest value that quantities can have, of those with limits. [SI]

    """

    def __init__(
        self,
        joint: JointFit,
        flights: Sequence[FlightQuantities],
        floor: Array,
        count: int,
        reach: Mapping[str, tuple[float, float]] | None = None,
    ) -> None:
        self.reach = reach or {}
        self.joint, self.floor, self._measured = joint, floor, flights
        pieces = [each.pieces for each in flights]
        self.values = {name: np.concatenate([each[name] for each in pieces]) for name in pieces[0]}
        knots = joint.group.linears[0].knots
        self._nearest = np.asarray(np.linalg.pinv(hat_functions(self.values['u'].shape[1], knots)))
        self._offsets = np.cumsum([0, *(len(each['u']) for each in pieces)])
        offsets = self._offsets.tolist()
        self._flights: dict[Side, slice[int, int, None]] = {
            'train': slice(0, count),
            'confirm': slice(count, len(pieces)),
            'all': slice(0, len(pieces)),
        }
        self.rows = {
            side: slice(offsets[some.start], offsets[some.stop])
            for side, some in self._flights.items()
        }
        self.spreads = {
            name: Spread(float(np.std(each)), float(np.mean(each)))
            for name, each in self.values.items()
        }

    def regress(self, side: Side, deviations: Array) -> WrenchRegression:
        """Return the regression of the unexplained wrench in the flights of a side."""
        some = self._flights[side]
        pieces = self.joint.group.pieces[some]
        turns = [each.rotations for each in self._measured[some]]
        return WrenchRegression(self.joint, pieces, turns, deviations, self.floor)

    def follow(self, state: HiddenState) -> Quantities:
        """Return a hidden state and its rate in the pieces."""
        steps = np.arange(self.values['u'].shape[1])
        parts = []
        for each in self._measured:
            both = follow_drive(state, each.whole)
            at = np.minimum(each.first[:, None] + steps, len(both[0]) - 1)
            parts.append([values[at] for values in both])
        return {
            name: np.concatenate([part[k] for part in parts])
            for k, name in enumerate(HIDDEN_QUANTITIES)
        }

    def quantities(self, hidden: HiddenState | None) -> Quantities:
        """Return all quantities in the pieces."""
        return self.values if hidden is None else self.values | self.follow(hidden)

    def basis(self, columns: Sequence[Column]) -> Array:
        """Return columns at the knots, shape (S, K, J)."""
        out, state, quantities = [], None, self.values
        for column in columns:
            # Columns of one hidden state follow each other
            if column.hidden is not state:
                state, quantities = column.hidden, self.quantities(column.hidden)
            out.append(evaluate_product(column.factors, quantities))
        return self.project(np.stack(out, axis=-1))

    def project(self, values: Array) -> Array:
        """Return the knots nearest to values in each grid period, (S, n, J) to (S, K, J)."""
        return np.asarray(np.matmul(self._nearest, values))

    def knots(self, column: Column) -> Array:
        """Return a column at the knots, shape (S, K)."""
        return self.basis([column])[..., 0]

    def body_knots(self, column: Column, axis: int) -> Array:
        """Return a column on an axis as a wrench in the body frame, shape (S, 6 K)."""
        values = self.knots(column)
        out = np.zeros((len(values), AXES, values.shape[1]))
        if axis < AXES:
            out[:, axis] = values
        else:
            turns = np.concatenate([each.rotations for each in self._measured])
            # Row of the rotation: the map axis in the body
            out[:, :3] = np.swapaxes(turns[:, :, axis - AXES], 1, 2) * values[:, None]
        return out.reshape(len(values), -1)

    def split_flights(self, values: Array) -> list[Array]:
        """Return values of all pieces, flight by flight."""
        return np.split(values, self._offsets[1:-1])

    def axis_floor(self, axis: int) -> float:
        """Return the noise floor of an axis of a law."""
        return float(self.floor[axis] if axis < AXES else self.floor[0])

    def shrink(self, deviations: Array, axes: Sequence[int], share: float) -> Array:
        """Return deviations that are smaller on some axes."""
        out, own = deviations.copy(), list(axes)
        least = np.minimum(LEAST * self.floor[own], deviations[own])
        out[own] = np.maximum(share * deviations[own], least)
        return out
