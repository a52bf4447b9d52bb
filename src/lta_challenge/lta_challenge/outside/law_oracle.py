"""
Fit and test an oracle that knows the equation of an effect outside the library.

It knows all its parameters but the size, which is regressed as the weight of a law's only term;
its forecasts are made as those of a law. So it shows what any law could reach.
"""

from collections.abc import Mapping
from functools import partial
from typing import Final, final

from lta_challenge.outside import STRANGE
from lta_discovery.finding import ChannelErrors
from lta_discovery.laws.forecast import Prepare
from lta_discovery.laws.forecast_refit import LawModel
from lta_discovery.laws.law_data import LawData
from lta_discovery.laws.proposal import (
    build_refit,
    choose_parameters,
    collect_law_data,
    compare_forecasts,
    list_taught_flights,
)
from lta_discovery.laws.quantities import measured_states
from lta_discovery.laws.selection import SHRUNK
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.quaternions import rotation_matrix
from lta_discovery.replay.flight_linearizer import FlightLinearizer
from lta_discovery.replay.replay import STEPS
from lta_discovery.study import DiscoveryStudy
from lta_model.effects.protocol import Values, VehicleMotion
from lta_model.state import ACTUATORS
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

SIZE: Final = 0.3  # relative; prior deviation of the size about that of the regression


@final
class TrueWrench:
    """The wrench of an effect outside the library along one flight, times a scale."""

    def __init__(
        self,
        name: str,
        parameters: Mapping[str, float],
        scale: float,
        flight: FlightLinearizer,
        nominal: NominalVehicle,
    ) -> None:
        self._effect, self._scale = STRANGE[name].effect, scale
        self._values = tuple(parameters[one.name] for one in self._effect.parameters)
        self._body = tuple(nominal.build_model().body.tolist())
        replay = flight.replay
        ready = replay.compute_body_inputs(replay.build_replay_rows(nominal))
        self._thrust = ready.commands[:, :ACTUATORS]
        self._first, self._dt = replay.first, replay.dt
        # The newest command at each step, with a margin for rounding
        orders, steps = replay.flight.commands, self._dt * np.arange(len(self._thrust))
        time = replay.flight.time[0] + steps + 1e-9
        newest = np.searchsorted(orders.time, time, side='right') - 1
        self._orders = orders.values[np.maximum(newest, 0)]
        self._memories: list[Values] = []
        if self._effect.memory:
            count = len(self._thrust) // STEPS
            begin = tuple(value for _, value in self._effect.memory)
            motion = np.repeat(measured_states(flight, count), STEPS, axis=0)
            self._memories = self._follow(motion, 0, begin)[1]

    def _follow(self, states: Array, first: int, memory: Values) -> tuple[Array, list[Values]]:
        """Return the wrench along states in successive steps, and the memory before each."""
        rotations = rotation_matrix(states[:, 3:7]).reshape(len(states), 9)
        out, memories = np.zeros((len(states), 6)), []
        for k, (state, turn) in enumerate(zip(states.tolist(), rotations.tolist(), strict=True)):
            x, y, z, _, _, _, _, *moving = state
            a, b, c, d, e, f, g, h, i = turn
            u, v, w, p, q, r = moving
            step = min(first + k, len(self._thrust) - 1)
            thrust = tuple(self._thrust[step].tolist())
            motion = VehicleMotion(
                (x, y, z), (a, b, c, d, e, f, g, h, i), (u, v, w), (p, q, r), (u, v, w),
                self._body, tuple(self._orders[step].tolist()), (),
            )  # fmt: skip
            memories.append(memory)
            out[k] = self._effect.wrench(self._values, memory, motion, thrust)
            if memory:
                rates = self._effect.rate(self._values, memory, motion)
                memory = tuple(a + self._dt * b for a, b in zip(memory, rates, strict=True))
        return self._scale * out, memories

    def compute_wrench(self, states: Array) -> Array:
        """Return the wrench in each step of the pieces, shape (S, span, 6), body frame."""
        middle = 0.5 * (states[:, :-1] + states[:, 1:])
        out = np.zeros((*middle.shape[:2], 6))
        for k, (piece, first) in enumerate(zip(middle, self._first, strict=True)):
            last = min(int(first), len(self._memories) - 1)
            memory = self._memories[last] if self._memories else ()
            out[k] = self._follow(piece, int(first), memory)[0]
        return out


def fit_law_oracle(
    study: DiscoveryStudy, name: str, parameters: Mapping[str, float]
) -> tuple[ChannelErrors, ...]:
    """
    Return the forecast errors on held-out flights; `after` are those of the oracle.

    Empty without a held-out flight or a joint fit.
    """
    joint, forecasts = study.joint, study.forecasts
    if joint is None or forecasts is None or not study.finding.held_out:
        return ()
    flights, data = list_taught_flights(study), collect_law_data(study, joint)
    parts = []
    for flight, linear in zip(flights, joint.group.linears, strict=True):
        true = TrueWrench(name, parameters, 1.0, flight, linear.point.nominal)
        wrench = true.compute_wrench(flight.simulate_trajectory(linear.point))
        parts.append(wrench[:, ::STEPS])
    knots = data.project(np.concatenate(parts))
    scale, shared = _regress_size(data, knots)
    push = np.swapaxes(knots, 1, 2).reshape(len(knots), -1, 1)

    def prepare(weights: Array) -> Prepare:
        return partial(TrueWrench, name, parameters, float(weights[0]))

    model = LawModel(
        np.array([scale]), np.array([SIZE]), prepare, lambda _weights: data.split_flights(push)
    )
    free = np.zeros(len(shared), dtype=np.bool_)
    refit = build_refit(study, flights, joint, forecasts, free)
    begun = choose_parameters(study, refit, forecasts, shared, prepare(model.start), free)
    fitted = refit.fit(model, begun)
    return compare_forecasts(
        study, forecasts, prepare(fitted.weights), study.nominal, fitted.shared
    )


def _regress_size(data: LawData, knots: Array) -> tuple[float, Array]:
    """Return the size of a known wrench (S, K, 6), and the shared parameters that go with it."""
    best, solution = -np.inf, (1.0, data.joint.fitted.mean)
    terms = [(knots[..., axis], axis) for axis in range(6) if np.any(knots[..., axis])]
    for share in (1.0, *SHRUNK, SHRUNK[-1] ** 2):
        deviations = data.shrink(data.joint.deviations, range(6), share)
        regression = data.regress('all', deviations)
        products = regression.products(terms)
        inner, right = float(products.inner.sum()) + 1.0, float(products.right.sum()) + 1.0
        # A prior of 1 around the true size
        evidence = regression.base + 0.5 * right**2 / inner - 0.5 * np.log(inner)
        if evidence > best:
            weights = np.full(len(terms), right / inner)
            best, solution = (
                evidence,
                (right / inner, regression.shared_parameters(products, weights)),
            )
    return solution
