"""
Find the transients at the ends of a flight: take-off, hand release, catching by hand.

Forces act there that no vehicle file describes, and they would spoil the flight's lift. A vehicle
that stands or is held with idle actuators does not move freely yet. A hand that lets go, or
catches, shows as an acceleration that the rest of the flight never reaches.
"""

from typing import Final, final, NamedTuple

from lta_discovery.flights.free_swings import find_swing_law, smooth_derivative, WINDOW
from lta_discovery.flights.measured_flight import FlightStreams, MeasuredFlight, PERIOD
from lta_discovery.flights.windows import find_usable_runs
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

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
        np.linalg.norm(smooth_derivative(part, 1), axis=1)
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


def _find_hands(flight: MeasuredFlight) -> tuple[float, float]:
    """Return when a hand has released the vehicle, and when one catches it. [s]"""
    pull = np.linalg.norm(smooth_derivative(flight.position, 2), axis=1)
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
