# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Find the law of a swing without commands: when a hand lets it go, and about which tilt it swings.

A free swing returns in proportion to its angle. Held at an angle, or moved slowly, the vehicle
does not. The tilt at rest follows from the balance and the marker frame, and both may change
between flights: a battery is moved, or the rigid body of the tracker is defined again.

Only drag acts along the floor on a free swing. So a point keeps its place that follows from the
masses of the vehicle, and the markers swing about it with the lever arm of their frame.
"""

from collections.abc import Sequence
import math
from typing import Final, final, NamedTuple

from lta_data.even_grid import find_runs
from lta_discovery.flights.bags import AssignedFlight
from lta_discovery.flights.measured_flight import GRID_PERIOD, MeasuredFlight
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.quaternions import (
    quaternion_exponential,
    rotation_matrix,
)
from lta_model.vehicle import Vehicle
import numpy as np
from numpy.typing import NDArray
from scipy.signal import savgol_filter

Array = NDArray[np.float64]

WINDOW: Final = 13  # points of the grid, 0.5 s; smoothing of the accelerations
FREE_SECONDS: Final = 3.0  # s; of the free part of a swing
SWUNG: Final = 0.07  # rad; amplitude of a swing that shows its law
FREE_MISFIT: Final = 0.35  # of the largest angular acceleration of a swing; more is no free swing
SHORTEST_HOLD: Final = 0.2  # s; shortest time that counts as held
ODD: Final = 0.1  # share of a free swing that may differ, by gaps and slips of the tracker
RELEASE_MARGIN: Final = 0.2  # s; margin after the release
SAME_TILT: Final = math.radians(2.0)  # rad; tilts at rest that differ by less are the same
SAME_LEVER_ARM: Final = 0.05  # m; lever arms of the markers that differ by less are the same
CERTAIN_SHIFT: Final = 4.0  # standard deviations of such a difference
UNTURNED: Final = np.array([0.0, 0.0, 0.0, 1.0])  # quaternion x y z w


@final
class SwingLaw(NamedTuple):
    """When a free swing begins, and about which tilt."""

    release: float  # when it begins [s]
    rest: Array  # tilt about which it swings, about x and y of the body, shape (2,) [rad]


@final
class MarkerArm(NamedTuple):
    """Where the markers are on a vehicle that swings freely."""

    place: Array  # from the hull centre, in the marker axes, shape (3,) [m]
    deviation: Array  # standard deviation, shape (3,) [m]


def find_swing_law(flight: MeasuredFlight) -> SwingLaw | None:
    """Return the law of a flight that swings without commands; None for another flight."""
    orders = flight.wrench if flight.wrench is not None else flight.commands
    if orders.values.any():
        return None
    turning, rate, angle = (
        smooth_derivative(measure_tilt(flight.quaternion), order) for order in (2, 1, 0)
    )
    finite = np.isfinite(turning).all(axis=1)
    # Its second half is free
    late = np.flatnonzero(finite)[finite.sum() // 2 :]
    if len(late) * GRID_PERIOD < FREE_SECONDS or np.ptp(angle[late], axis=0).max() < 2.0 * SWUNG:
        return None
    terms = np.column_stack([angle, rate, np.ones(len(angle))])
    law = np.linalg.lstsq(terms[late], turning[late], rcond=None)[0]
    rest = np.linalg.lstsq(law[:2].T, -law[4], rcond=None)[0]
    usual = float(np.linalg.norm(turning[finite], axis=1).max())
    unlike = np.linalg.norm(turning - terms @ law, axis=1) > FREE_MISFIT * usual
    for first, end in find_runs(unlike):
        is_held = end - first >= SHORTEST_HOLD / GRID_PERIOD and end <= late[0]
        if is_held and unlike[end : late[0]].sum() <= ODD * (late[0] - end):
            return SwingLaw(float(flight.time[end]) + RELEASE_MARGIN, rest)
    return SwingLaw(float(flight.time[0]), rest)


def align_swings(
    flights: Sequence[AssignedFlight], vehicle: Vehicle
) -> tuple[list[AssignedFlight], list[str]]:
    """
    Return flights whose swings have the same tilt and lever arm, and a sentence on each change.

    Otherwise one balance and one marker frame would have to explain all of them.
    """
    turned, remarks = _align_tilts(flights)
    moved, more = _align_markers(turned, NominalVehicle.from_vehicle(vehicle))
    return moved, [*remarks, *more]


def _align_tilts(flights: Sequence[AssignedFlight]) -> tuple[list[AssignedFlight], list[str]]:
    """Return flights whose swings are about the same tilt, and a sentence if one was turned."""
    laws = [find_swing_law(flight) for _, _, flight in flights]
    rests = [law.rest for law in laws if law is not None]
    others = [
        np.nanmedian(measure_tilt(flight.quaternion), axis=0)
        for (_, _, flight), law in zip(flights, laws, strict=True) if law is None
    ]  # fmt: skip
    # A vehicle with commands hovers about its tilt at rest
    usual = np.median(others or rests, axis=0) if rests else np.zeros(2)
    turned, most = [], 0.0
    out: list[AssignedFlight] = []
    for (name, role, flight), law in zip(flights, laws, strict=True):
        apart = np.zeros(2) if law is None else law.rest - usual
        if np.linalg.norm(apart) > SAME_TILT:
            turn = quaternion_exponential(np.array([-apart[1], apart[0], 0.0]))
            flight = flight.with_marker_frame(turn, np.zeros(3))
            turned.append(name)
            most = max(most, float(np.linalg.norm(apart)))
        out.append((name, role, flight))
    if not turned:
        return out, []
    return out, [
        f'{", ".join(turned)}: swings about a tilt that differs from that of the other flights, '
        f'by up to {math.degrees(most):.0f}\N{DEGREE SIGN}, as if balance or marker frame had '
        'changed in between. The marker frames are turned to that of the others.'
    ]


def _align_markers(
    flights: Sequence[AssignedFlight], nominal: NominalVehicle
) -> tuple[list[AssignedFlight], list[str]]:
    """Return flights whose swings have the same lever arm, and a sentence if one was moved."""
    arms = [measure_marker_arm(flight, nominal) for _, _, flight in flights]
    usual = _find_usual_arm([arm for arm in arms if arm is not None])
    moved, most = [], 0.0
    out: list[AssignedFlight] = []
    for (name, role, flight), arm in zip(flights, arms, strict=True):
        shift = np.zeros(3)
        if arm is not None:
            apart = arm.place - usual
            # A swing about one axis hardly shows the arm along it
            shift = np.where(np.abs(apart) > CERTAIN_SHIFT * arm.deviation, apart, 0.0)
        if np.linalg.norm(shift) > SAME_LEVER_ARM:
            flight = flight.with_marker_frame(UNTURNED, -shift)
            moved.append(name)
            most = max(most, float(np.linalg.norm(shift)))
        out.append((name, role, flight))
    if not moved:
        return out, []
    return out, [
        f'{", ".join(moved)}: the origin of the marker frame is elsewhere on the vehicle than in '
        f'the other swings, by up to {100.0 * most:.0f} cm, as if the rigid body of the tracker '
        'had been defined again. The positions are moved to the origin of the others.'
    ]


def _find_usual_arm(arms: Sequence[MarkerArm]) -> Array:
    """Return the median lever arm; of each component, over the half that knows it better."""
    if not arms:
        return np.zeros(3)
    places, deviations = (np.array([one[k] for one in arms]) for k in (0, 1))
    good = deviations <= np.median(deviations, axis=0)
    usual: Array = np.nanmedian(np.where(good, places, np.nan), axis=0)
    return usual


def measure_marker_arm(flight: MeasuredFlight, nominal: NominalVehicle) -> MarkerArm | None:
    """Return where the markers of a free swing are on the vehicle; None for another flight."""
    law = find_swing_law(flight)
    if law is None:
        return None
    count = len(flight.time)
    turning = smooth_derivative(rotation_matrix(flight.quaternion).reshape(count, 9), 2)
    pull = smooth_derivative(flight.position, 2)
    good = flight.usable & (flight.time > law.release)
    good &= np.isfinite(turning).all(axis=1) & np.isfinite(pull).all(axis=1)
    if good.sum() * GRID_PERIOD < FREE_SECONDS:
        return None
    # Along each axis of the world: the arm, a constant and a changing force
    free = flight.time[good] - flight.time[good].mean()
    drift = np.kron(np.eye(3), np.column_stack([np.ones_like(free), free]))
    terms = np.hstack([turning[good].reshape(-1, 3, 3).transpose(1, 0, 2).reshape(-1, 3), drift])
    right = pull[good].T.ravel()
    arm = np.linalg.lstsq(terms, right, rcond=None)[0]
    # Neighbours share the points of the filter
    noise = WINDOW * float(np.mean((right - terms @ arm) ** 2))
    deviation = np.sqrt(noise * np.diag(np.linalg.inv(terms.T @ terms))[:3])
    rate = smooth_derivative(measure_tilt(flight.quaternion), 1)[good]
    # In pitch the tilt changes along x, in roll along y
    in_pitch = float(np.nansum(rate[:, 0] ** 2) / np.nansum(rate**2))
    depth = np.array([0.0, 0.0, find_neutral_height(nominal, in_pitch)])
    return MarkerArm(arm[:3] + depth, deviation)


def find_neutral_height(nominal: NominalVehicle, in_pitch: float) -> float:
    """
    Return the height, above the hull centre, of the point that a free swing does not move [m].

    `in_pitch`: share of the swing that is in pitch; the rest is in roll.
    """
    inverse = np.asarray(nominal.build_model().inverse, dtype=np.float64).reshape(6, 6)
    mass = np.linalg.inv(inverse)
    # Where the momentum along the floor is zero
    pitch, roll = mass[0, 4] / mass[0, 0], -mass[1, 3] / mass[1, 1]
    return float(in_pitch * pitch + (1.0 - in_pitch) * roll)


def measure_tilt(quaternion: Array) -> Array:
    """Return where the world's up is in the body, as angles along x and y, shape (n, 2) [rad]."""
    x, y, z, w = quaternion.T
    along = np.column_stack([2.0 * (x * z - w * y), 2.0 * (y * z + w * x)])
    flat = np.linalg.norm(along, axis=1)
    angle = np.arctan2(flat, 1.0 - 2.0 * (x * x + y * y))
    tilt: Array = along * (angle / np.maximum(flat, 1e-9))[:, None]
    return tilt


def smooth_derivative(values: Array, order: int) -> Array:
    """Return a smoothed derivative on the grid; NaN near gaps."""
    out = np.full_like(values, np.nan)
    valid: NDArray[np.bool_] = np.asarray(np.isfinite(values).all(axis=1))
    for begin, end in find_runs(valid):
        if end - begin >= WINDOW:
            smooth = savgol_filter(
                values[begin:end], WINDOW, 3, deriv=order, delta=GRID_PERIOD, axis=0
            )
            # At its ends the filter extrapolates, which amplifies noise
            out[begin + WINDOW // 2 : end - WINDOW // 2] = smooth[WINDOW // 2 : -(WINDOW // 2)]
    return out
