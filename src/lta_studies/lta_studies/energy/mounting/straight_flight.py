# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Fly the seed paper's test of a mount, straight at 0.1 m/s, and release a mount tilted.

In the closed loop, the drone is held level until its estimator has calibrated the biases. It is
then released, rises, waits, and flies straight. A drone with an unbalanced mount starts to swing
about its lean when it is released level; that swing is reported separately from the swing in
flight.

A vehicle that is released tilted, motors off, is neutrally buoyant, so that it neither sinks nor
rises. The motion comes from the simulator's kernel; `lta_vehicle.figures.stability` has the
linearised analytical solution.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
import math
from typing import final

from lta_flight.closed_loop import ClosedLoop
from lta_flight.flight_spec import load_spec
from lta_model.model import VehicleModel
from lta_model.state import pack_state, QUATERNION
from lta_model.vehicle import Vehicle
from lta_report.result_table import Spread
from lta_sim.simulated_vehicle import SimulatedVehicle
from lta_studies.energy.course_flight import (
    build_closed_loop,
    build_course,
    FlightTrack,
    fly_until,
    stop_after,
)
from lta_studies.energy.mounting.mounted_vehicle import MountedVehicle
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
SWING_INTEGRATION_STEP, STEPS_PER_SAMPLE = (
    2e-3,
    10,
)  # integration step [s], and steps per recorded sample
FIELD_HEIGHT = 1000.0  # m, far from any floor
OVERTURNED_TILT = math.radians(90.0)  # tilt beyond which it counts as turned over


@final
@dataclass(frozen=True, slots=True)
class Release:
    """Tilt of the body's z axis from the vertical [rad] over time [s]."""

    time: Array
    tilt: Array

    @property
    def overturn_time(self) -> float | None:
        """Time at which it overturned; None if it did not [s]."""
        over = np.nonzero(np.abs(self.tilt) > OVERTURNED_TILT)[0]
        return float(self.time[over[0]]) if len(over) else None

    @property
    def peaks(self) -> tuple[Array, Array]:
        """Return the times [s] and tilts [rad] of the maxima on the initial side."""
        inner = self.tilt[1:-1]
        # ">=" on one side counts a plateau of two equal samples once.
        peak_indices = np.nonzero(
            (inner > self.tilt[:-2]) & (inner >= self.tilt[2:]) & (inner > 0.0)
        )[0]
        # The release itself is the first maximum.
        times, tilts = [0.0], [float(self.tilt[0])]
        # Indices of `inner` are one less than those of `tilt`.
        for k in peak_indices + 1:
            time, tilt = _parabola_vertex(self.time[k - 1 : k + 2], self.tilt[k - 1 : k + 2])
            times.append(time)
            tilts.append(tilt)
        return np.array(times), np.array(tilts)

    @property
    def period(self) -> float | None:
        """Mean period of the first three swings; None if there are fewer [s]."""
        times, _ = self.peaks
        return float(times[3] / 3.0) if len(times) > 3 else None

    @property
    def damping_ratio(self) -> float | None:
        """Damping ratio over the first three swings; None if there are fewer."""
        times, tilts = self.peaks
        if len(times) <= 3:
            return None
        decay = math.log(tilts[0] / tilts[3]) / 3.0
        # Damping ratio from the logarithmic decrement d: d / sqrt(d^2 + 4 pi^2)
        return decay / math.hypot(decay, 2.0 * math.pi)


def _parabola_vertex(time: Array, tilt: Array) -> tuple[float, float]:
    """Return the vertex of a parabola through three points."""
    a, b, c = np.polyfit(time - time[1], tilt, 2).tolist()
    at = -0.5 * b / a
    return float(time[1]) + at, (a * at + b) * at + c


def simulate_release(
    vehicle: Vehicle, tilt: float, seconds: float, height: float | None = None
) -> Release:
    """
    Release a vehicle with its nose up.

    `tilt`: initial tilt [rad]. `seconds`: duration [s]. `height`: height of the centre of gravity
    above the hull centre; by default unchanged [m].
    """
    cg = vehicle.cg if height is None else np.array([0.0, 0.0, height])
    model = VehicleModel.build(
        vehicle.collect_effects(), mass=vehicle.mass, cg=cg, inertia=vehicle.inertia,
        # The displaced mass equals the vehicle's: neutral buoyancy
        displaced=vehicle.mass,
        rotors=[(rotor.place, rotor.axis) for rotor in vehicle.rotors],
    )  # fmt: skip
    craft = SimulatedVehicle(model)
    rigid = pack_state((0.0, 0.0, FIELD_HEIGHT))
    # Nose up is a negative rotation about y (z up, y left).
    rigid[QUATERNION] = (0.0, -math.sin(0.5 * tilt), 0.0, math.cos(0.5 * tilt))
    craft.state[:] = 0.0
    craft.state[: len(rigid)] = rigid
    count = round(seconds / (SWING_INTEGRATION_STEP * STEPS_PER_SAMPLE))
    tilts = np.empty(count + 1)
    for k in range(count + 1):
        x, y, z, w = craft.state[QUATERNION].tolist()
        # Ratio of two rotation-matrix entries; unlike asin it is valid beyond 90 degrees.
        tilts[k] = math.atan2(2.0 * (x * z - w * y), w * w - x * x - y * y + z * z)
        craft.advance(SWING_INTEGRATION_STEP, STEPS_PER_SAMPLE)
    times: Array = np.linspace(0.0, count * SWING_INTEGRATION_STEP * STEPS_PER_SAMPLE, count + 1)
    unwrapped: Array = np.unwrap(tilts).astype(np.float64)
    return Release(times, unwrapped)


FLIGHT_SPEED = 0.1  # m/s, seed paper
RELEASE_TIME, LIFT_OFF_TIME, MOUNTING_DEPARTURE, FLIGHT_END = (
    5.0,
    8.0,
    40.0,
    100.0,
)  # s: release, lift-off, departure, end
MOUNTING_ALTITUDE = 1.5  # m
MOUNTING_SCENE = 'hall'


@final
@dataclass(frozen=True, slots=True)
class StraightFlightResult:
    """Result of a flight."""

    swing: float  # largest deviation from the mean pitch between lift-off and departure [rad]
    # Half of the range, and standard deviation, of pitch after departure [rad]
    amplitude: float
    rms: float
    power: float  # mean power after departure, including electronics and radio [W]
    hover: float  # mean power in the last 10 s before departure [W]
    track: FlightTrack


def prepare_flight(mounted: MountedVehicle, gains: str, seed: int) -> ClosedLoop:
    """Return the closed loop before its first step; gains '' are the vehicle's own."""
    # The vehicle is replaced below; gtmab only completes the spec.
    made_of = load_spec('gtmab', MOUNTING_SCENE, 'bag', gains)
    scene = made_of.contents['scenario']
    start = {**scene['start'], 'held': f'{RELEASE_TIME} s'}
    contents = {
        **made_of.contents,
        'vehicle': mounted.content,
        'scenario': {**scene, 'start': start},
    }
    course = build_course(
        mounted.vehicle.hull_height_on_floor, MOUNTING_ALTITUDE, LIFT_OFF_TIME,
        MOUNTING_DEPARTURE, FLIGHT_SPEED,
    )  # fmt: skip
    return build_closed_loop(replace(made_of, contents=contents), course, seed)


def fly_straight(mounted: MountedVehicle, gains: str, seed: int) -> StraightFlightResult:
    """Fly once and evaluate; gains '' are the vehicle's own."""
    return evaluate_flight(
        mounted, fly_until(prepare_flight(mounted, gains, seed), stop_after(FLIGHT_END))
    )


def evaluate_flight(mounted: MountedVehicle, track: FlightTrack) -> StraightFlightResult:
    """Evaluate a flight."""
    loads = mounted.vehicle.loads
    steady = loads.idle + loads.transmitting
    rising, way = (
        track.crop(LIFT_OFF_TIME, MOUNTING_DEPARTURE),
        track.crop(MOUNTING_DEPARTURE, FLIGHT_END),
    )
    # The last 10 s before departure: steady hover, the climb has settled.
    before = track.crop(MOUNTING_DEPARTURE - 10.0, MOUNTING_DEPARTURE)
    return StraightFlightResult(
        swing=float(np.abs(rising.pitch - rising.pitch.mean()).max()),
        # Half of peak to peak
        amplitude=0.5 * float(np.ptp(way.pitch)),
        rms=float(way.pitch.std()),
        power=steady + float(way.rotors.mean()),
        hover=steady + float(before.rotors.mean()),
        track=track,
    )


def average_over_seeds(flights: Sequence[StraightFlightResult], name: str) -> Spread:
    """Return the mean of an attribute over flights, and the largest deviation from it."""
    values = [float(getattr(each, name)) for each in flights]
    mean = math.fsum(values) / len(values)
    return Spread(mean, max(abs(value - mean) for value in values))
