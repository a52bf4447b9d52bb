# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Find the transients of a flight: take-off, hand release, catching or carrying by hand, a wall.

Forces act there that no vehicle file describes, and they would spoil the flight's lift. A vehicle
that stands or is held with idle actuators does not move freely yet. A hand that lets go, or
catches, shows as an acceleration that the rest of the flight never reaches. Between the ends, a
hand or a wall shows as one that neither commands nor motion explain.
"""

from typing import Final, final, NamedTuple

from lta_data.even_grid import find_runs
from lta_discovery.flights.free_swings import find_swing_law, smooth_derivative, WINDOW
from lta_discovery.flights.measured_flight import FlightStreams, GRID_PERIOD, MeasuredFlight
from lta_discovery.model.quaternions import rotation_matrix
import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import uniform_filter1d

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

HAND_EDGE: Final = 8.0  # s; length of the ends in which a hand is looked for
LEAST_REST: Final = 6.0  # s; least length of the rest of the flight, which shows what is usual
MEASURED_REST_SHARE: Final = 0.8  # share of that rest whose acceleration has to be known
HARD: Final = 2.5  # times the largest usual acceleration; a hand
SLOW_SWING: Final = 4.0  # s; period of the slowest swing
WEAK_PULL: Final = 0.1  # m/s2; smaller accelerations are no hand
AFTER: Final = 0.5  # s; margin after a release, and before a catch
LIFTED: Final = 1.0  # s; margin after the vehicle leaves the floor
IDLE_COMMAND: Final = 0.02  # of the largest command; smaller commands are none
STANDING: Final = 0.6  # s; shortest time with idle actuators that counts as held
CARRIED: Final = 0.15  # m/s; a vehicle that is faster flies before its first command
CARRIED_RATE: Final = 0.05  # rad/s; the same for its rates: it swings freely
DELAYS: Final = (0.0, 0.1, 0.2, 0.3, 0.4)  # s; of the commands, tried
PUSH: Final = 0.6  # m/s2; smaller unexplained accelerations are no hand and no wall
UNUSUAL: Final = 8.0  # times the median of the unexplained accelerations
LONE: Final = 0.2  # s; shorter ones are outliers of the tracker
STEADY_HAND_TIME: Final = 3.0  # s; a hand may move steadily for so long
LARGEST_HAND_SHARE: Final = 0.5  # of a flight; what covers more is no exception
ABSOLUTE_FIT_ROUNDS: Final = 10  # of a fit of least absolute errors


@final
class Transient(NamedTuple):
    """An end of a flight that is not free flight [s]."""

    from_s: float
    to_s: float
    reason: str


def format_cut(part: Transient, begin: float) -> str:
    """
    Return what is cut of a flight that begins at `begin` [s], and why.

    With a single time in each place, so that such sentences of several flights merge.
    """
    seconds = f'{part.to_s - part.from_s:.1f} s'
    if part.from_s <= begin:
        return f'the first {seconds} are cut: {part.reason}.'
    return f'{seconds} are cut, beginning at {part.from_s:.1f} s: {part.reason}.'


def find_transients(flight: MeasuredFlight, streams: FlightStreams) -> list[Transient]:
    """Return the transients of a flight, in the order of time."""
    begin = float(flight.time[0])
    transients = []
    if (lifted := _find_take_off(flight, streams.floor)) > begin:
        transients.append(
            Transient(begin, lifted + LIFTED, 'the vehicle stands on the floor or takes off')
        )
    held = _find_rest_end(flight)
    released, caught = _find_hands(flight)
    law = find_swing_law(flight)
    released = max(released, begin if law is None else law.release)
    # A hand that lifts the vehicle from the floor disturbs it longer than the floor does
    until = transients[0].to_s if transients else begin
    if released > max(until, held):
        transients = [Transient(begin, released, 'a hand releases the vehicle')]
    elif held > until:
        transients = [
            Transient(begin, held, 'the vehicle is held, or rests before its first command')
        ]
    if caught < flight.time[-1]:
        transients.append(Transient(caught, float(flight.time[-1]), 'a hand catches the vehicle'))
    inside = flight.usable.copy()
    for one in transients:
        inside &= (flight.time < one.from_s) | (flight.time > one.to_s)
    transients += _find_disturbances(flight, inside)
    return sorted(transients)


def _find_take_off(flight: MeasuredFlight, floor: float) -> float:
    """Return when a flight that begins near the floor leaves it; its start if it does not [s]."""
    height = flight.position[:, 2]
    finite = np.flatnonzero(np.isfinite(height))
    above = finite[height[finite] > floor]
    if not len(above) or above[0] == finite[0]:
        return float(flight.time[0])
    return float(flight.time[above[0]])


def _find_rest_end(flight: MeasuredFlight) -> float:
    """
    Return until when the vehicle is held, or at rest, before its first command [s].

    A free vehicle at rest teaches nothing, so both may be cut.
    """
    idle = _mark_idle_points(flight)
    speed, rate = (
        np.linalg.norm(smooth_derivative(part, 1), axis=1)
        for part in (flight.position, 2.0 * flight.quaternion)
    )
    # A gap in the poses continues what was before it
    still = idle & ~(speed > CARRIED) & ~(rate > CARRIED_RATE)
    runs = find_runs(still)
    reach = round(STANDING / GRID_PERIOD)
    # The first points have no smoothed speed, so the run may begin a little later
    if not len(runs) or runs[0][0] > WINDOW or runs[0][1] - runs[0][0] < reach:
        return float(flight.time[0])
    end = min(runs[0][1] + round(AFTER / GRID_PERIOD), len(flight.time) - 1)
    return float(flight.time[end])


def _mark_idle_points(flight: MeasuredFlight) -> Mask:
    """Mark the grid points without a command, in flights that have commands elsewhere."""
    orders = flight.wrench if flight.wrench is not None else flight.commands
    size = np.abs(orders.values).max(axis=1)
    largest = float(size.max(initial=0.0))
    if largest == 0.0:
        return np.zeros(len(flight.time), dtype=np.bool_)
    newest = np.searchsorted(orders.time, flight.time + 1e-9, side='right') - 1
    idle: Mask = (newest < 0) | (size[np.maximum(newest, 0)] < IDLE_COMMAND * largest)
    return idle


def _find_hands(flight: MeasuredFlight) -> tuple[float, float]:
    """Return when a hand has released the vehicle, and when one catches it [s]."""
    pull = np.linalg.norm(smooth_derivative(flight.position, 2), axis=1)
    # A tracker that holds its last pose after the vehicle has left shows no end of the flight
    points = np.flatnonzero(flight.usable)
    begin, end = (points[0], points[-1]) if len(points) else (0, len(pull) - 1)
    pull = pull[begin : end + 1]
    first = _find_release(pull)
    # A catch is a release in reversed time
    last = _find_release(pull[::-1])
    return (
        float(flight.time[0] if first is None else flight.time[begin + first] + AFTER),
        float(flight.time[-1] if last is None else flight.time[end - last] - AFTER),
    )


def _find_release(pull: Array) -> int | None:
    """Return the last point of a hand's disturbance at the beginning; None without any."""
    # A short flight has shorter ends, and less of it shows what is usual
    edge = min(round(HAND_EDGE / GRID_PERIOD), (len(pull) - round(LEAST_REST / GRID_PERIOD)) // 2)
    if edge < 1:
        return None
    rest = pull[edge : len(pull) - edge]
    rest = rest[np.isfinite(rest)]
    if len(rest) < MEASURED_REST_SHARE * LEAST_REST / GRID_PERIOD:
        return None
    usual = max(
        HARD * float(rest.max()), WEAK_PULL if edge == round(HAND_EDGE / GRID_PERIOD) else PUSH
    )
    for k in np.flatnonzero(pull[:edge] > usual)[::-1]:
        # The swings of a free decay also get smaller, but not at once
        later = pull[k + round(AFTER / GRID_PERIOD) : k + round(SLOW_SWING / GRID_PERIOD)]
        if pull[k] > HARD * np.nanmax(later, initial=0.0):
            return int(k)
    return None


def _find_disturbances(flight: MeasuredFlight, inside: Mask) -> list[Transient]:
    """Return where accelerations occur that neither commands nor motion explain."""
    unexplained = _measure_unexplained_acceleration(flight, inside)
    finite = np.isfinite(unexplained)
    if finite.sum() * GRID_PERIOD < LEAST_REST:
        return []
    limit = max(PUSH, UNUSUAL * float(np.median(unexplained[finite])))
    strong = finite & (unexplained > limit)
    idle = _mark_idle_points(flight)
    near, out = round(STEADY_HAND_TIME / GRID_PERIOD), list[tuple[int, int]]()
    for begin, end in find_runs(strong):
        if (end - begin) * GRID_PERIOD < LONE:
            continue
        # Carried from one place to the next, the vehicle gets no command
        if out and (begin - out[-1][1] < near or idle[out[-1][1] : begin].all()):
            out[-1] = (out[-1][0], end)
        else:
            out.append((begin, end))
    if sum(end - begin for begin, end in out) > LARGEST_HAND_SHARE * inside.sum():
        return []
    # A decay is strongest from the first moment on; a hand comes to a vehicle that flies
    begun = int(np.flatnonzero(finite)[0])
    out = [(begin, end) for begin, end in out if begin > begun + near]
    last = len(flight.time) - 1
    margin = round(AFTER / GRID_PERIOD)
    return [
        Transient(
            float(flight.time[max(begin - margin, 0)]),
            float(flight.time[min(end + margin, last)]),
            'a hand or an obstacle moves the vehicle',
        )
        for begin, end in out
    ]


def _measure_unexplained_acceleration(flight: MeasuredFlight, inside: Mask) -> Array:
    """
    Return the acceleration that neither commands nor motion explain; NaN where unknown [m/s2].

    Its law is fitted along the body axes: commands, speed, the direction of gravity, and the lever
    arm of the markers, of which no vehicle file is needed.
    """
    count = len(flight.time)
    rotation = rotation_matrix(flight.quaternion)
    turning = smooth_derivative(rotation.reshape(count, 9), 2).reshape(count, 3, 3)
    pull, speed = (smooth_derivative(flight.position, order) for order in (2, 1))
    pull, speed = (np.einsum('nji,nj->ni', rotation, each) for each in (pull, speed))
    arms = np.einsum('nji,njk->nik', rotation, turning)
    orders = flight.wrench if flight.wrench is not None else flight.commands
    best = np.full(count, np.nan)
    for delay in DELAYS if orders.values.any() else DELAYS[:1]:
        newest = np.searchsorted(orders.time, flight.time - delay + 1e-9, side='right') - 1
        commands = np.where((newest >= 0)[:, None], orders.values[np.maximum(newest, 0)], 0.0)
        # As smooth as the accelerations that they cause
        commands = uniform_filter1d(commands, WINDOW // 2, axis=0)
        plain = [commands[:, commands.any(axis=0)], speed, rotation[:, 2, :]]
        left = np.column_stack(
            [_fit_rest(np.hstack([*plain, arms[:, k]]), pull[:, k], inside) for k in range(3)]
        )
        size = np.linalg.norm(left, axis=1)
        if not np.isfinite(best).any() or np.nanmedian(size) < np.nanmedian(best):
            best = size
    return best


def _fit_rest(terms: Array, values: Array, inside: Mask) -> Array:
    """Return what a linear law leaves of values, by least absolute errors; NaN where unknown."""
    finite = inside & np.isfinite(terms).all(axis=1) & np.isfinite(values)
    out = np.full(len(values), np.nan)
    if finite.sum() <= 2 * terms.shape[1]:
        return out
    table, right = terms[finite], values[finite]
    weights = np.ones(len(right))
    for _ in range(ABSOLUTE_FIT_ROUNDS):
        law = np.linalg.lstsq(table * weights[:, None], right * weights, rcond=None)[0]
        left = right - table @ law
        # Iteratively reweighted least squares
        weights = 1.0 / np.sqrt(np.maximum(np.abs(left), 1e-3))
    out[finite] = left
    return out
