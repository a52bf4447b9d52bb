"""
Find the transients at the ends of a flight: take-off, hand release, catching by hand.

Forces act there that no vehicle file describes, and they would spoil the flight's lift. A vehicle
that stands or is held with idle actuators does not move freely yet. A hand that lets go, or
catches, shows as an acceleration that the rest of the flight never reaches.
"""

from typing import Final, final, NamedTuple

from lta_discovery.flights.measured_flight import FlightStreams, MeasuredFlight, PERIOD
from lta_discovery.flights.windows import find_usable_runs
import numpy as np
from numpy.typing import NDArray
from scipy.signal import savgol_filter

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

WINDOW: Final = 13  # points of the grid, 0.5 s; smoothing of the accelerations
EDGE: Final = 8.0  # s; length of the ends in which a hand is looked for
REST: Final = 6.0  # s; least length of the rest of the flight, which shows what is usual
HARD: Final = 2.5  # times the largest usual acceleration; a hand
SWING: Final = 4.0  # s; period of the slowest swing
SMALLEST: Final = 0.1  # m/s2; smaller accelerations are no hand
AFTER: Final = 0.5  # s; margin after a release, and before a catch
LIFTED: Final = 1.0  # s; margin after the vehicle leaves the floor
IDLE: Final = 0.02  # of the largest command; smaller commands are none
STANDING: Final = 0.6  # s; shortest time with idle actuators that counts as held
CARRIED: Final = 0.15  # m/s; a vehicle that is faster flies before its first command
TURNED: Final = 0.05  # rad/s; the same for its rates: it swings freely
SWUNG: Final = 0.07  # rad; amplitude of a swing that shows when it began
FREE: Final = 0.35  # of the largest angular acceleration of a swing; more is no free swing
HELD: Final = 0.2  # s; shortest time that counts as held
ODD: Final = 0.1  # share of a free swing that may differ, by gaps and slips of the tracker
SETTLED: Final = 0.2  # s; margin after the release of a swing


@final
class Transient(NamedTuple):
    """An end of a flight that is not free flight. [s]"""

    from_s: float
    to_s: float
    reason: str


def find_transients(flight: MeasuredFlight, streams: FlightStreams) -> list[Transient]:
    """Return the transients of a flight, at most one at each end."""
    begin = float(flight.time[0])
    transients = []
    if (lifted := _find_take_off(flight, streams.floor)) > begin:
        transients.append(
            Transient(begin, lifted + LIFTED, 'the vehicle stands on the floor or takes off')
        )
    held = _find_rest_end(flight)
    released, caught = _find_hands(flight)
    released = max(released, _find_swing_begin(flight))
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
    return transients


def _find_take_off(flight: MeasuredFlight, floor: float) -> float:
    """Return when a flight that begins near the floor leaves it; its start if it does not. [s]"""
    height = flight.position[:, 2]
    finite = np.flatnonzero(np.isfinite(height))
    above = finite[height[finite] > floor]
    if not len(above) or above[0] == finite[0]:
        return float(flight.time[0])
    return float(flight.time[above[0]])


def _find_rest_end(flight: MeasuredFlight) -> float:
    """
    Return until when the vehicle is held, or at rest, before its first command. [s]

    A free vehicle at rest teaches nothing, so both may be cut.
    """
    idle = _mark_idle_points(flight)
    speed, rate = (
        np.linalg.norm(_smooth_derivative(part, 1), axis=1)
        for part in (flight.position, 2.0 * flight.quaternion)
    )
    # A gap in the poses continues what was before it
    still = idle & ~(speed > CARRIED) & ~(rate > TURNED)
    runs = find_usable_runs(still)
    reach = round(STANDING / PERIOD)
    # The first points have no smoothed speed, so the run may begin a little later
    if not runs or runs[0][0] > WINDOW or runs[0][1] - runs[0][0] < reach:
        return float(flight.time[0])
    end = min(runs[0][1] + round(AFTER / PERIOD), len(flight.time) - 1)
    return float(flight.time[end])


def _mark_idle_points(flight: MeasuredFlight) -> Mask:
    """Mark the grid points without a command, in flights that have commands elsewhere."""
    orders = flight.wrench if flight.wrench is not None else flight.commands
    size = np.abs(orders.values).max(axis=1)
    largest = float(size.max(initial=0.0))
    if largest == 0.0:
        return np.zeros(len(flight.time), dtype=np.bool_)
    newest = np.searchsorted(orders.time, flight.time + 1e-9, side='right') - 1
    idle: Mask = (newest < 0) | (size[np.maximum(newest, 0)] < IDLE * largest)
    return idle


def _find_swing_begin(flight: MeasuredFlight) -> float:
    """
    Return when a hand lets go a swing without commands; the start of the flight if none does. [s]

    A free swing returns in proportion to its angle, also when it is large. Held at an angle, or
    moved slowly, the vehicle does not.
    """
    begin = float(flight.time[0])
    orders = flight.wrench if flight.wrench is not None else flight.commands
    if orders.values.any():
        return begin
    tilt = _measure_tilt(flight.quaternion)
    turning, rate, angle = (_smooth_derivative(tilt, order) for order in (2, 1, 0))
    known = np.isfinite(turning).all(axis=1)
    # Its second half is free
    late = np.flatnonzero(known)[known.sum() // 2 :]
    if len(late) * PERIOD < 0.5 * REST or np.ptp(tilt[late], axis=0).max() < 2.0 * SWUNG:
        return begin
    terms = np.column_stack([angle, rate, np.ones(len(angle))])
    law = np.linalg.lstsq(terms[late], turning[late], rcond=None)[0]
    usual = float(np.linalg.norm(turning[known], axis=1).max())
    unlike = np.linalg.norm(turning - terms @ law, axis=1) > FREE * usual
    runs = [run for run in find_usable_runs(unlike) if run[1] - run[0] >= HELD / PERIOD]
    for _, end in runs:
        if end <= late[0] and unlike[end : late[0]].sum() <= ODD * (late[0] - end):
            return float(flight.time[end]) + SETTLED
    return begin


def _measure_tilt(quaternion: Array) -> Array:
    """Return the tilt as a rotation vector about horizontal axes of the body, shape (n, 2)."""
    x, y, z, w = quaternion.T
    # The world's up in body axes
    up = np.column_stack([2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1 - 2.0 * (x * x + y * y)])
    flat = np.linalg.norm(up[:, :2], axis=1)
    stretch = np.arctan2(flat, up[:, 2]) / np.maximum(flat, 1e-9)
    return up[:, :2] * stretch[:, None]


def _find_hands(flight: MeasuredFlight) -> tuple[float, float]:
    """Return when a hand has released the vehicle, and when one catches it. [s]"""
    pull = np.linalg.norm(_smooth_derivative(flight.position, 2), axis=1)
    first = _find_release(pull)
    # A catch is a release in reversed time
    last = _find_release(pull[::-1])
    begin, end = float(flight.time[0]), float(flight.time[-1])
    return (
        begin if first is None else begin + PERIOD * first + AFTER,
        end if last is None else end - PERIOD * last - AFTER,
    )


def _find_release(pull: Array) -> int | None:
    """Return the last point of a hand's disturbance at the beginning; None without any."""
    edge = round(EDGE / PERIOD)
    rest = pull[edge : len(pull) - edge]
    rest = rest[np.isfinite(rest)]
    if len(rest) < REST / PERIOD:
        return None
    usual = HARD * max(float(rest.max()), SMALLEST / HARD)
    for k in np.flatnonzero(pull[:edge] > usual)[::-1]:
        # The swings of a free decay also get smaller, but not at once
        later = pull[k + round(AFTER / PERIOD) : k + round(SWING / PERIOD)]
        if pull[k] > HARD * np.nanmax(later, initial=0.0):
            return int(k)
    return None


def _smooth_derivative(values: Array, order: int) -> Array:
    """Return a smoothed derivative of the positions; NaN near gaps."""
    out = np.full_like(values, np.nan)
    valid: Mask = np.asarray(np.isfinite(values).all(axis=1))
    for begin, end in find_usable_runs(valid):
        if end - begin >= WINDOW:
            smooth = savgol_filter(values[begin:end], WINDOW, 3, deriv=order, delta=PERIOD, axis=0)
            # At its ends the filter extrapolates, which amplifies noise
            out[begin + WINDOW // 2 : end - WINDOW // 2] = smooth[WINDOW // 2 : -(WINDOW // 2)]
    return out
