"""
Generate flights of a vehicle whose calibration is hidden: gains, delay, lift, marker frame.

The vehicle is commanded by a wrench, and only the pose of its markers is recorded. Besides its
tolerances it lacks no effect, so that everything found is calibration.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
import math
from typing import Final, final

from lta_challenge.case import CaseFlight
from lta_challenge.other.air import MovingAir, RoomAirMotion
from lta_challenge.other.case_generator import draw_initial_state
from lta_challenge.other.flight import FlightSimulator, TICK
from lta_challenge.other.sensors import SensorSet, STAMPS
from lta_challenge.other.tolerance import perturb_vehicle, scale_randomly, shift_randomly
from lta_challenge.other.truth import build_vehicle_truth, Six, to_triple, VehicleTruth
from lta_challenge.other.wrench_flight import WrenchActuators, WrenchPilot
from lta_model.vehicle import Vehicle
import numpy as np
from scipy.spatial.transform import Rotation

Draw = np.random.Generator

CODE: Final = 7  # part of the random seed
GAINS: Final = (0.2, 3.0)  # range of the size of each commanded gain
MARKER_TURN: Final = math.radians(20.0)  # rad; largest rotation of the marker frame
MARKER_ARM: Final = 0.15  # m; largest distance of its origin from the hull centre
LIFT: Final = 0.025  # N; largest net lift of a flight
TREND: Final = 1e-4  # N/s; largest change of the lift in a flight
DELAY: Final = 0.4  # s; largest delay of the commands
TILT: Final = math.radians(1.0)  # rad; deviation of each tilt of the tracker
# Errors of a vehicle file that nobody weighed or swung: standard deviations
MASS: Final = 0.02  # relative
INERTIA: Final = 0.15  # relative
BALANCE: Final = 5e-3  # m; centre of gravity
DRAG: Final = 0.2  # relative
DRAUGHT: Final = 2e-3  # m/s; rms of the air motion in every second case
SECONDS: Final = (60.0, 100.0)  # s; range of flight lengths
ROLES: Final = ('train', 'train', 'confirm', 'holdout')
COMMANDED: Final = (0, 2, 5)  # axes: surge, heave, yaw


@final
@dataclass(frozen=True, slots=True)
class CalibrationCase:
    """
    Flights of one vehicle, and its hidden calibration.

    Attributes
    ----------
    truth : VehicleTruth
        The vehicle.
    lifts, trends : mapping of str to float
        Net lift at the start of each flight [N], and its growth. [N/s]

    """

    flights: tuple[CaseFlight, ...]
    truth: VehicleTruth
    lifts: Mapping[str, float]
    trends: Mapping[str, float]


def _draw_gains(draw: Draw) -> Six:
    """Return the gains of a commanded wrench; axes without a command keep 1."""
    out = [1.0] * 6
    for axis in COMMANDED:
        size = GAINS[0] * (GAINS[1] / GAINS[0]) ** draw.random()
        out[axis] = float(size * draw.choice([-1.0, 1.0]))
    a, b, c, d, e, f = out
    return a, b, c, d, e, f


def _draw_ball(radius: float, draw: Draw) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    """Return a vector of random direction and a length up to a radius."""
    way = draw.standard_normal(3)
    vector: np.ndarray[tuple[int], np.dtype[np.float64]] = (
        radius * draw.random() * way / np.linalg.norm(way)
    )
    return vector


def hide_calibration(truth: VehicleTruth, draw: Draw) -> VehicleTruth:
    """Return a vehicle with a random calibration."""
    turn = Rotation.from_rotvec(_draw_ball(MARKER_TURN, draw))
    heavier = MASS * truth.mass * float(draw.standard_normal())
    return replace(
        truth,
        mass=truth.mass + heavier,
        displaced=truth.displaced + heavier,
        inertia=scale_randomly(truth.inertia, INERTIA, draw),
        cg=shift_randomly(truth.cg, BALANCE, draw),
        drag=scale_randomly(truth.drag, DRAG, draw),
        turn_square=scale_randomly(truth.turn_square, DRAG, draw),
        wrench_gains=_draw_gains(draw),
        marker_turn=to_triple(turn.as_euler('ZYX')),
        marker_arm=to_triple(_draw_ball(MARKER_ARM, draw)),
        tracker=to_triple([0.0, *(TILT * draw.standard_normal(2))]),
        delay=float(draw.uniform(0.0, DELAY)),
    )


def generate_calibration_case(
    vehicle: Vehicle,
    seed: int,
    number: int,
    roles: Sequence[str] = ROLES,
    seconds: tuple[float, float] = SECONDS,
) -> CalibrationCase:
    """
    Generate a case; it depends on its arguments only.

    Parameters
    ----------
    seed, number : int
        Of the trials and of the case.
    seconds : pair of float
        Range of flight lengths. [s]

    """
    nominal, draw = build_vehicle_truth(vehicle), np.random.default_rng([seed, number, CODE])
    truth = hide_calibration(perturb_vehicle(nominal, draw), draw)
    stamps = STAMPS[int(draw.integers(len(STAMPS)))]
    draughty = number % 2 == 1
    flights, lifts, trends = list[CaseFlight](), dict[str, float](), dict[str, float]()
    for index, role in enumerate(roles):
        own = np.random.default_rng([seed, number, CODE, 10 + index])
        name = f'{role}_{index + 1}'
        lifts[name], trends[name] = own.uniform(-LIFT, LIFT), own.uniform(-TREND, TREND)
        flown = replace(truth, lift=lifts[name], leak=-trends[name])
        length = float(round(own.uniform(*seconds)))
        air: list[MovingAir] = [RoomAirMotion(DRAUGHT, length, own)] if draughty else []
        pilot = WrenchPilot(nominal, truth.wrench_gains, own)
        begin = draw_initial_state(float(own.uniform(-math.pi, math.pi)), own)
        path = FlightSimulator(flown, pilot, air, actuators=WrenchActuators).simulate_flight(
            begin, length
        )
        time = TICK * np.arange(len(path.commands), dtype=np.float64)
        streams = {
            'ground_truth/odom': SensorSet(path, flown, stamps, own).measure_poses(),
            'wrench_command': (time, path.commands),
        }
        flights.append(CaseFlight(name, role, 'wrench', streams))
    return CalibrationCase(tuple(flights), truth, lifts, trends)
