"""
Fly the seed paper's test of a mount: straight flight at 0.1 m/s in the closed loop.

The drone is held level until its estimator has calibrated the biases. It is then released, rises,
waits, and flies straight. A drone with an unbalanced mount starts to swing about its lean when it
is released level; that swing is reported separately from the swing in flight.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
import math
from typing import final

from lta_control.cascade import Setpoint
from lta_flight.closed_loop import ClosedLoop
from lta_flight.flight_spec import load_spec
from lta_studies.energy.course_flight import build_closed_loop, FlightTrack, fly_until, stop_after
from lta_studies.energy.mounting.mounted_vehicle import MountedVehicle
import numpy as np

SPEED = 0.1  # m/s, seed paper
HELD, LIFT_OFF, AWAY, END = 5.0, 8.0, 40.0, 100.0  # s: release, lift-off, departure, end
RISE = 1.5  # m
SCENE = 'hall'


@final
@dataclass(frozen=True, slots=True)
class StraightFlightResult:
    """Result of a flight."""

    swing: float  # largest deviation from the mean pitch between lift-off and departure [rad]
    lean: float  # mean pitch after departure, nose down positive [rad]
    # Half of the range, and standard deviation, of pitch after departure [rad]
    amplitude: float
    rms: float
    power: float  # mean power after departure, including electronics and radio [W]
    hover: float  # mean power in the last 10 s before departure [W]
    track: FlightTrack


def prepare_flight(mounted: MountedVehicle, gains: str, seed: int) -> ClosedLoop:
    """Return the closed loop before its first step; gains '' are the vehicle's own."""
    # The vehicle is replaced below; gtmab only completes the spec.
    made_of = load_spec('gtmab', SCENE, 'bag', gains)
    scene = made_of.contents['scenario']
    start = {**scene['start'], 'held': f'{HELD} s'}
    contents = {
        **made_of.contents,
        'vehicle': mounted.content,
        'scenario': {**scene, 'start': start},
    }
    base = mounted.vehicle.hull_height_on_floor

    def setpoint_at(time: float) -> Setpoint:
        rise = RISE if time >= LIFT_OFF else 0.0
        return Setpoint(base + rise, 0.0, SPEED if time >= AWAY else 0.0)

    return build_closed_loop(replace(made_of, contents=contents), setpoint_at, seed)


def fly_straight(mounted: MountedVehicle, gains: str, seed: int) -> StraightFlightResult:
    """Fly once and evaluate; gains '' are the vehicle's own."""
    return evaluate_flight(
        mounted, fly_until(prepare_flight(mounted, gains, seed), stop_after(END))
    )


def evaluate_flight(mounted: MountedVehicle, track: FlightTrack) -> StraightFlightResult:
    """Evaluate a flight."""
    loads = mounted.vehicle.loads
    steady = loads.idle + loads.transmitting
    rising, way = track.crop(LIFT_OFF, AWAY), track.crop(AWAY, END)
    # The last 10 s before departure: steady hover, the climb has settled.
    before = track.crop(AWAY - 10.0, AWAY)
    return StraightFlightResult(
        swing=float(np.abs(rising.pitch - rising.pitch.mean()).max()),
        # Pitch is nose up, the lean nose down.
        lean=-float(way.pitch.mean()),
        # Half of peak to peak
        amplitude=0.5 * float(np.ptp(way.pitch)),
        rms=float(way.pitch.std()),
        power=steady + float(way.rotors.mean()),
        hover=steady + float(before.rotors.mean()),
        track=track,
    )


@final
@dataclass(frozen=True, slots=True)
class SeedSpread:
    """Mean over the seeds and the largest deviation from it."""

    mean: float
    off: float


def average_over_seeds(flights: Sequence[StraightFlightResult], name: str) -> SeedSpread:
    """Return mean and spread of an attribute over several flights."""
    values = [float(getattr(each, name)) for each in flights]
    mean = math.fsum(values) / len(values)
    return SeedSpread(mean, max(abs(value - mean) for value in values))
