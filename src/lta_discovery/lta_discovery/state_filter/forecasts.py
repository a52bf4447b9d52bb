# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Forecast flights from what they have shown so far, and measure the errors.

`lta calibrate` and `lta simulate --commands --forecasts` judge vehicles by these. A forecast
begins at the estimate of a filter through the model that has seen the readings up to there and
none after it. The commands that were given later are known. What differs from flight to flight is
learned on the way: biases by the filter, and lift and the strength of the commands from those
forecasts that have ended by then. The unexplained wrench goes on and decays.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final, final

from lta_discovery.flights.measured_flight import GRID_PERIOD, MeasuredFlight
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import apply_parameters, FreeParameter, NET_LIFT_FORCE
from lta_discovery.model.quaternions import (
    quaternion_conjugate,
    quaternion_exponential,
    quaternion_logarithm,
    quaternion_product,
    rotate_vectors,
    rotation_matrix,
)
from lta_discovery.parallel import map_parallel
from lta_discovery.replay.replay import FlightReplay, STEPS_PER_PERIOD
from lta_discovery.replay.sensing import predict_pose
from lta_discovery.replay.state_changes import apply_state_changes, STATE_WIDTH
from lta_discovery.state_filter.forecast_noise import (
    FIT_FORECAST_INTERVAL,
    HORIZONS,
    list_starts,
    settle_own,
    weigh_errors,
)
from lta_discovery.state_filter.kalman import describe_noise, filter_flight
from lta_discovery.state_filter.likelihood import ParameterPrior
from lta_discovery.state_filter.linear_flight import FlightSystem, LinearFlight, POSE_SIZE
from lta_discovery.state_filter.noise_model import NoiseModel, wrench_floor
from lta_discovery.state_filter.smoothing import filter_run, WRENCH_STATES
from lta_model.vehicle import Vehicle
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

FORECAST_INTERVAL: Final = 1.5  # s; between the starts of forecasts
COASTING_PERIODS: Final = 12  # grid periods; coasting goes straight through half a second
# Relative standard deviation of the strength of a command between flights: batteries and trim
# differ. Half and twice of it change the errors on real flights by about 4 and 8 % after 3 and 8 s
VARIES: Final = 0.3
LEAST_COASTING: Final = 4  # poses of that line
LEAK_RATE: Final = 'helium_leak.rate'


@final
@dataclass(frozen=True, slots=True)
class FlightForecasts:
    """Forecasts of one flight."""

    starts: Array  # times, shape (S,) [s]
    horizons: tuple[float, ...]  # [s]
    # Measured less forecast pose at each horizon: position in the map and rotation vector; NaN
    # where no pose was measured, infinite where a forecast diverges. Shape (S, H, 6) [m, rad]
    errors: Array
    coasting: Array  # the same at constant velocity and rates
    headings: Array  # of the nose at each start, shape (S,) [rad]
    # Standard deviation of these errors with a perfect model, shape (S, H, 6)
    floor: Array


def forecast_flights(
    vehicle: Vehicle,
    nominal: NominalVehicle,
    flights: Sequence[MeasuredFlight],
    parameters: Sequence[FreeParameter],
    noise: Sequence[NoiseModel],
    horizons: Sequence[float] = HORIZONS,
    apart: float = FORECAST_INTERVAL,
) -> list[FlightForecasts]:
    """
    Forecast flights with a vehicle.

    Parameters
    ----------
    nominal : NominalVehicle
        The vehicle to judge.
    parameters : sequence of FreeParameter
        What a flight may have of its own, with tolerances: see `list_flight_parameters`.
    noise : sequence of NoiseModel
        Of each flight.
    horizons : sequence of float
        How far ahead, rising. [s]
    apart : float
        Time between the starts. [s]

    """

    def judge(one: tuple[MeasuredFlight, NoiseModel]) -> FlightForecasts:
        system = FlightSystem(vehicle, one[0], parameters, with_future=False)
        # A forecast may diverge
        with np.errstate(all='ignore'):
            return _forecast_flight(system, nominal, one[1], tuple(horizons), apart)

    return map_parallel(judge, list(zip(flights, noise, strict=True)))


def list_flight_parameters(
    nominal: NominalVehicle, parameters: Sequence[FreeParameter]
) -> list[FreeParameter]:
    """
    Return what a flight may have of its own: what differs per flight, and strengths of commands.

    The strength of a command of the vehicle has a relative deviation of `VARIES`. A trend of the
    lift is not among them: until a flight has told it, the flight is over.
    """
    out = []
    for one in parameters:
        if one.per_flight and one.name != LEAK_RATE:
            out.append(one)
        elif share := _strength(nominal, one):
            out.append(replace(one, tolerance=VARIES * share))
    return out


def _strength(nominal: NominalVehicle, one: FreeParameter) -> float:
    """Return how strong a command is, by the unit of its parameter; 0 for another one."""
    effect, _, part = one.name.partition('.')
    if effect == 'wrench_gain' and not part.startswith(('exponent', 'reverse', 'reference')):
        return abs(nominal.parameter_value(effect, part))
    return 1.0 if part == 'thrust' else 0.0


def _forecast_flight(
    system: FlightSystem,
    nominal: NominalVehicle,
    noise: NoiseModel,
    horizons: tuple[float, ...],
    apart: float,
) -> FlightForecasts:
    """Forecast one flight."""
    linear = system.linearize(nominal, np.zeros(len(system.parameters)))
    starts = list_starts(linear.runs, apart)
    coasting = coast(system.flight, starts, horizons)
    # Whatever the model, a force of this size acts
    quiet = replace(noise, wrench=wrench_floor(nominal))
    try:
        values, states = _estimate_starts(linear, noise, system.parameters, starts)
        errors = _fly_forecasts(system, nominal, linear, starts, values, states, noise, horizons)
        floor = predict_deviations(linear, quiet, starts, horizons)
    except np.linalg.LinAlgError:
        # So unstable that a filter loses it
        errors = np.where(np.isnan(coasting), np.nan, np.inf)
        floor = np.full_like(errors, np.nan)
    headings = _compute_headings(linear.motion[starts])
    return FlightForecasts(system.flight.time[starts], horizons, errors, coasting, headings, floor)


def _estimate_starts(
    linear: LinearFlight,
    noise: NoiseModel,
    parameters: Sequence[FreeParameter],
    starts: NDArray[np.int64],
) -> tuple[Array, Array]:
    """Return the flight's own parameters and the filter's state at each start."""
    prior = ParameterPrior.of(parameters)
    # Any force that the model lacks looks like lift from one reading to the next, and less so over
    # the seconds of a forecast; until one has ended, the most probable noise tells them apart
    lift = np.array([one.name == NET_LIFT_FORCE for one in parameters], dtype=np.bool_)
    without_lift = prior._replace(own=prior.own & ~lift)
    seen, early = (filter_flight(linear, one, starts) for one in (noise.ahead, noise))
    values, is_told = _learn_from_ended(linear, noise.ahead, without_lift, starts)
    for s in range(len(starts)):
        at, sums = (without_lift, seen.sums) if is_told[s] else (prior, early.sums)
        values[s] = _join_own(sums[s], at, values[s])
    full = np.column_stack([values, np.ones(len(starts))])
    return values, np.einsum('szk,sk->sz', seen.states, full)


def _learn_from_ended(
    linear: LinearFlight, noise: NoiseModel, prior: ParameterPrior, starts: NDArray[np.int64]
) -> tuple[Array, NDArray[np.bool_]]:
    """
    Return what ended forecasts tell of the flight at each start, shape (S, K).

    0 for parameters that the filter learns. Also returns whether any forecast has ended, (S,).
    """
    out, which = np.zeros((len(starts), len(prior.own))), np.flatnonzero(~prior.own)
    begun = list_starts(linear.runs, FIT_FORECAST_INTERVAL)
    errors = settle_own(filter_flight(linear, noise, begun, HORIZONS), prior)
    ends = begun[:, None] + np.rint(np.array(HORIZONS) / GRID_PERIOD).astype(np.int64)
    limits = np.diag(prior.deviation[which] ** -2.0)
    is_told = np.array([(ends <= start).any() for start in starts], dtype=np.bool_)
    for s in np.flatnonzero(is_told):
        ended = ends <= starts[s]
        past = np.where(ended[..., None, None], errors, np.nan)
        table = weigh_errors(past[ended[:, 0]])[0].reshape(-1, errors.shape[-1])
        inner = table[:, which].T @ table[:, which] + limits
        out[s, which] = -np.linalg.solve(inner, table[:, which].T @ table[:, -1])
    return np.clip(out, prior.low, prior.high), is_told


def _join_own(sums: Array, prior: ParameterPrior, others: Array) -> Array:
    """Return all parameters of a flight: those that its readings tell, beside the others."""
    own, out = np.flatnonzero(prior.own), others.copy()
    if len(own):
        inner = sums[np.ix_(own, own)] + np.diag(prior.deviation[own] ** -2.0)
        pull = sums[own, -1] + sums[own, :-1] @ others
        out[own] = np.clip(-np.linalg.solve(inner, pull), prior.low[own], prior.high[own])
    return out


def _fly_forecasts(
    system: FlightSystem,
    nominal: NominalVehicle,
    linear: LinearFlight,
    starts: NDArray[np.int64],
    values: Array,
    states: Array,
    noise: NoiseModel,
    horizons: tuple[float, ...],
) -> Array:
    """Fly the model from each start without further readings; return the errors."""
    flight, count = system.flight, round(horizons[-1] / GRID_PERIOD)
    begun = apply_state_changes(linear.motion[starts], states[:, :STATE_WIDTH])
    replay = FlightReplay(flight, starts, count, system.vehicle.pack_command(()))
    time = GRID_PERIOD / STEPS_PER_PERIOD * (np.arange(replay.span) + 0.5)
    memory = noise.ahead.memory
    faded = np.exp(-time[:, None] / memory)
    out = np.full((len(starts), len(horizons), POSE_SIZE), np.nan)
    base = nominal.build_replay_rows()
    usual = replay.compute_body_inputs(replay.adapt_rows(nominal, base))
    # Rotors are simulated again only where a flight has thrusts or delays of its own
    moves_rotors = any(
        one.reaches not in ('wrench', 'body', 'reading') or replay.delays_commands(one)
        for one in system.parameters
    )
    for s, start in enumerate(starts):
        there, _ = apply_parameters(nominal, system.parameters, values[s])
        rows = replay.adapt_rows(there, there.update_replay_rows(nominal, base))
        ready = (
            replay.compute_body_inputs(rows) if moves_rotors else replay.update_wrench(rows, usual)
        )
        wrench = (states[s, STATE_WIDTH : STATE_WIDTH + len(memory)] * faded)[None]
        motion = replay.integrate_pieces(
            rows, ready, begun[s : s + 1], np.ascontiguousarray(wrench), slice(s, s + 1)
        )[:, ::STEPS_PER_PERIOD]
        # One state more, in which a late pose would end
        grid = np.concatenate([motion, motion[:, -1:]], axis=1)
        stamps = flight.time[start] + GRID_PERIOD * np.arange(count + 1)[None]
        position, quaternion = predict_pose(grid, stamps, rows.acting)
        for h, horizon in enumerate(horizons):
            ahead = round(horizon / GRID_PERIOD)
            if (at := start + ahead) >= len(flight.time):
                continue
            turn = quaternion_logarithm(
                quaternion_product(
                    quaternion_conjugate(quaternion[0, ahead]), flight.quaternion[at]
                )
            )
            out[s, h] = np.concatenate([flight.position[at] - position[0, ahead], turn])
            # Known poses that no finite forecast meets
            lost = np.isfinite(flight.position[at]).all() & ~np.isfinite(out[s, h])
            out[s, h][lost] = np.inf
    return out


def predict_deviations(
    linear: LinearFlight,
    noise: NoiseModel,
    starts: NDArray[np.int64],
    horizons: Sequence[float],
) -> Array:
    """
    Return standard deviations of the errors of forecasts where model and noise are right.

    A forecast begins at what noisy readings tell, unexplained forces go on to change, and it is
    compared with a noisy reading. Shape (S, H, 6); NaN past the end of a run. [m, rad]
    """
    _, added, fading = describe_noise(noise)
    out = np.full((len(starts), len(horizons), POSE_SIZE), np.nan)
    no_columns = np.zeros((linear.moved.shape[2] + 1, 1))
    for k, (begin, end) in enumerate(linear.runs):
        spread = filter_run(linear, noise, k, no_columns).spread
        for h, horizon in enumerate(horizons):
            ahead = round(horizon / GRID_PERIOD)
            which = np.flatnonzero((starts >= begin) & (starts + ahead < end))
            last = starts[which] + ahead
            # How the last reading depends on the state at a point further and further back
            rows = np.zeros((len(which), POSE_SIZE, len(fading)))
            rows[..., :STATE_WIDTH] = linear.read[last, :POSE_SIZE]
            rows[..., WRENCH_STATES] = linear.felt[last, :POSE_SIZE]
            rows[..., WRENCH_STATES.stop : -1] = np.eye(POSE_SIZE)
            variance = noise.white[:POSE_SIZE] ** 2 / np.maximum(linear.count[last, None], 1.0)
            for at in last - np.arange(1, ahead + 1)[:, None]:
                variance += rows**2 @ added
                motion = rows[..., :STATE_WIDTH]
                rows = rows * fading
                rows[..., WRENCH_STATES] += motion @ linear.push[at]
                rows[..., :STATE_WIDTH] = motion @ linear.step[at]
            variance += np.einsum('spi,sij,spj->sp', rows, spread[last - ahead - begin], rows)
            out[which, h] = np.sqrt(variance)
    return out


def coast(flight: MeasuredFlight, starts: NDArray[np.int64], horizons: Sequence[float]) -> Array:
    """
    Return the errors of constant body velocity and rates, shape (S, H, 6).

    Both are those of straight lines through the poses of the half second before each start.
    """
    out = np.full((len(starts), len(horizons), POSE_SIZE), np.nan)
    place, attitude, velocity, rates = _fit_lines(flight, starts)
    ends = np.rint(np.asarray(horizons) / GRID_PERIOD).astype(np.int64)
    turn = quaternion_exponential(GRID_PERIOD * rates)
    for k in range(1, int(ends[-1]) + 1):
        # To second order: the velocity in the middle of the period
        middle = quaternion_product(attitude, quaternion_exponential(0.5 * GRID_PERIOD * rates))
        place = place + GRID_PERIOD * rotate_vectors(middle, velocity)
        attitude = quaternion_product(attitude, turn)
        for h in np.flatnonzero(ends == k):
            at = np.minimum(starts + k, len(flight.time) - 1)
            out[:, h, :3] = flight.position[at] - place
            out[:, h, 3:] = quaternion_logarithm(
                quaternion_product(quaternion_conjugate(attitude), flight.quaternion[at])
            )
            out[starts + k >= len(flight.time), h] = np.nan
    return out


def _fit_lines(
    flight: MeasuredFlight, starts: NDArray[np.int64]
) -> tuple[Array, Array, Array, Array]:
    """Return position, attitude, body velocity and rates by lines through the past half second."""
    out = np.full((len(starts), 13), np.nan)
    for s, start in enumerate(starts):
        rows = np.arange(max(start - COASTING_PERIODS, 0), start + 1)
        middle = flight.quaternion[start]
        away = np.broadcast_to(quaternion_conjugate(middle), (len(rows), 4))
        turn = quaternion_logarithm(quaternion_product(away, flight.quaternion[rows]))
        table = np.column_stack([flight.position[rows], turn])
        measured = np.isfinite(table).all(axis=1)
        if measured.sum() < LEAST_COASTING:
            continue
        late = flight.time[rows] - flight.time[start]
        slope, here = np.polyfit(late[measured], table[measured], 1)
        attitude = quaternion_product(middle, quaternion_exponential(here[3:]))
        # The line gives the mean velocity, where the nose was in the middle of it
        between = here[3:] + late.mean() * slope[3:]
        then = quaternion_product(middle, quaternion_exponential(between))
        velocity = rotate_vectors(quaternion_conjugate(then), slope[:3])
        out[s] = np.concatenate([here[:3], attitude, velocity, slope[3:]])
    return out[:, :3], out[:, 3:7], out[:, 7:10], out[:, 10:]


def _compute_headings(motion: Array) -> Array:
    """Return the heading of the nose in each state [rad]."""
    nose = rotation_matrix(motion[:, 3:7])[:, :2, 0]
    headings: Array = np.arctan2(nose[:, 1], nose[:, 0])
    return headings
