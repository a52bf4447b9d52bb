# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Generate flights of a vehicle whose calibration is hidden: gains, delay, lift, marker frame.

The vehicle is commanded by a wrench or by duties, and only the pose of its markers is recorded.
It lacks no effect, so that everything found is calibration.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
import math
from typing import Any, Final, final

from lta_config.vehicle_edit import set_yaml_values
from lta_model.vehicle import Vehicle
import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from campaigns.challenge.air import MovingAir, RoomAirMotion
from campaigns.challenge.case_generator import CaseFlight, draw_initial_state
from campaigns.challenge.flight import DutyPilot, FlightSimulator, TICK
from campaigns.challenge.pilot import SwingingPilot
from campaigns.challenge.rotors import RotorSet
from campaigns.challenge.sensors import SensorSet, STAMPS
from campaigns.challenge.tolerance import perturb_vehicle, scale_randomly, shift_randomly
from campaigns.challenge.truth import build_vehicle_truth, Six, to_triple, Triple, VehicleTruth
from campaigns.challenge.wrench_flight import (
    ClosedLoopController,
    Course,
    WrenchActuators,
    WrenchPilot,
)

Array = NDArray[np.float64]
Draw = np.random.Generator

CODE: Final = 7  # part of the random seed
GAINS: Final = (0.2, 3.0)  # range of the size of each commanded gain
MARKER_TURN: Final = math.radians(20.0)  # rad; largest rotation of the marker frame
MARKER_ARM: Final = 0.15  # m; largest distance of its origin from the hull centre
LIFT: Final = 0.025  # N; largest net lift of a flight
RISE: Final = 0.01  # N; largest with rotors that cannot push down
TREND: Final = 1e-4  # N/s; largest change of the lift in a flight
DELAY: Final = 0.4  # s; largest delay of the commands
TILT: Final = math.radians(1.0)  # rad; deviation of each tilt of the tracker
# Errors of a vehicle file that nobody weighed or swung: standard deviations. With the tolerances
# of `perturb_vehicle` they are those that a calibration assumes, so that its intervals are tested.
MASS: Final = 0.028  # relative
INERTIA: Final = 0.3  # of its logarithm
BALANCE: Final = 5e-3  # m; centre of gravity
DRAG: Final = 0.3  # relative
ADDED: Final = 0.085  # relative; added mass and inertia
FLOWS: Final = ('added_mass', 'added_inertia', 'drag', 'turn_linear', 'turn_square')
FARTHEST: Final = 2.5  # deviations; largest error of a drag
DRAUGHT: Final = 2e-3  # m/s; rms of the air motion in every second case
SECONDS: Final = (60.0, 100.0)  # s; range of flight lengths
ROLES: Final = ('train', 'train', 'confirm', 'holdout')
COMMANDED: Final = (0, 2, 5)  # axes: surge, heave, yaw
BACKWARDS: Final = 0.25  # share of the rotors that push against the axis in the file
FILE_LIFT: Final = 1e-3  # N; largest net lift of a flight of a vehicle whose file is right
# Of flights in closed loop: what the file has wrong, and what such flights may not show
LAB_GAIN: Final = 0.3
LAB_TURN: Final = math.radians(8.0)  # rad
LAB_ARM: Final = (0.05, 0.0, -0.04)  # m
LAB_DELAY: Final = 0.2  # s
LAB_LIFT: Final = (0.017, 0.023)  # N
LAB_DRAUGHT: Final = 0.01  # m/s; in every second case the controller answers to nothing else
SETTLED: Final = 30.0  # s; after them the log begins, without the answer to the start


@final
@dataclass(frozen=True, slots=True)
class CalibrationCase:
    """Flights of one vehicle, and its hidden calibration."""

    flights: tuple[CaseFlight, ...]
    truth: VehicleTruth
    # Net lift at the start of each flight [N], and its growth [N/s]
    lifts: Mapping[str, float]
    trends: Mapping[str, float]
    # Thrust of each rotor, by that of the vehicle file; negative against its axis there. Empty for
    # a commanded wrench.
    shares: tuple[float, ...] = ()
    is_steered: bool = False  # whether a controller closed the loop, which commands sway, too

    def list_true_values(self, vehicle: Vehicle) -> dict[str, float]:
        """Return the true values by the names of a calibration; factors of those of a vehicle."""
        truth, file = self.truth, build_vehicle_truth(vehicle)
        triples = {
            'marker_offset': (('yaw', 'pitch', 'roll'), truth.marker_turn),
            'marker_offset ': ('xyz', truth.marker_arm),
            'tracker_misalignment': (('pitch', 'roll'), truth.tracker[1:]),
            'cg_offset': ('xy', np.subtract(truth.cg, file.cg)[:2]),
            'cg_height': ('z', np.subtract(truth.cg, file.cg)[2:]),
            'vehicle': (('roll', 'pitch', 'yaw'), np.divide(truth.inertia, file.inertia)),
            'vehicle ': (('mass',), (truth.mass / file.mass,)),
            'quadratic_drag': (('surge', 'sway', 'heave'), truth.drag),
            'rotational_drag': (('roll', 'pitch', 'yaw'), truth.turn_linear),
            'rotational_drag ': (('roll_2', 'pitch_2', 'yaw_2'), truth.turn_square),
            'added_mass': (('surge', 'sway', 'heave'), truth.added_mass),
            'added_inertia': (('roll', 'pitch'), truth.added_inertia[:2]),
            'command_delay': (('delay',), (truth.delay,)),
        }
        out = {
            f'{effect.strip()}.{name}': float(value)
            for effect, (names, values) in triples.items()
            for name, value in zip(names, values, strict=True)
        }
        if self.shares:
            out['motor_lag'] = truth.lag
            return out | {f'rotor_{k}.thrust': each for k, each in enumerate(self.shares, start=1)}
        gains = {'surge': 0, 'heave': 2, 'yaw': 5} | ({'sway': 1} if self.is_steered else {})
        return out | {f'wrench_gain.{axis}': truth.wrench_gains[k] for axis, k in gains.items()}


def _draw_gain(draw: Draw, backwards: float = 0.5) -> float:
    """Return a gain of random size and sign."""
    size = GAINS[0] * (GAINS[1] / GAINS[0]) ** draw.random()
    return float(size * draw.choice([-1.0, 1.0], p=[backwards, 1.0 - backwards]))


def _draw_gains(draw: Draw) -> Six:
    """Return the gains of a commanded wrench; axes without a command keep 1."""
    out = [1.0] * 6
    for axis in COMMANDED:
        out[axis] = _draw_gain(draw)
    a, b, c, d, e, f = out
    return a, b, c, d, e, f


def _draw_ball(radius: float, draw: Draw) -> Array:
    """Return a vector of random direction and a length up to a radius."""
    way = draw.standard_normal(3)
    return np.asarray(radius * draw.random() * way / np.linalg.norm(way))


def _draw_drag(draw: Draw) -> Array:
    """Return factors on a drag along three axes."""
    return 1.0 + DRAG * np.clip(draw.standard_normal(3), -FARTHEST, FARTHEST)


def _scale_triple(values: Triple, factors: Array) -> Triple:
    """Return three numbers times a factor each."""
    return to_triple(np.multiply(values, factors))


def hide_calibration(truth: VehicleTruth, draw: Draw, with_flows: bool = True) -> VehicleTruth:
    """
    Return a vehicle with a random calibration.

    `with_flows`: whether drag and added mass were only estimated, too.
    """
    turn = Rotation.from_rotvec(_draw_ball(MARKER_TURN, draw))
    heavier = MASS * truth.mass * float(draw.standard_normal())
    hidden = replace(
        truth,
        mass=truth.mass + heavier,
        displaced=truth.displaced + heavier,
        inertia=_scale_triple(truth.inertia, np.exp(INERTIA * draw.standard_normal(3))),
        cg=shift_randomly(truth.cg, BALANCE, draw),
        added_mass=scale_randomly(truth.added_mass, ADDED, draw),
        added_inertia=scale_randomly(truth.added_inertia, ADDED, draw),
        drag=_scale_triple(truth.drag, _draw_drag(draw)),
        turn_linear=_scale_triple(truth.turn_linear, _draw_drag(draw)),
        turn_square=_scale_triple(truth.turn_square, _draw_drag(draw)),
        wrench_gains=_draw_gains(draw),
        marker_turn=to_triple(turn.as_euler('ZYX')),
        marker_arm=to_triple(_draw_ball(MARKER_ARM, draw)),
        tracker=to_triple([0.0, *(TILT * draw.standard_normal(2))]),
        delay=float(draw.uniform(0.0, DELAY)),
    )
    return (
        hidden if with_flows else replace(hidden, **{each: getattr(truth, each) for each in FLOWS})
    )


def _hide_lab_calibration(truth: VehicleTruth, draw: Draw) -> VehicleTruth:
    """Return a vehicle of which a third of each command arrives, late, with crooked markers."""
    axis = draw.standard_normal(3)
    turn = Rotation.from_rotvec(LAB_TURN * axis / np.linalg.norm(axis))
    return replace(
        truth,
        wrench_gains=(LAB_GAIN, LAB_GAIN, LAB_GAIN, 1.0, 1.0, LAB_GAIN),
        marker_turn=to_triple(turn.as_euler('ZYX')),
        marker_arm=LAB_ARM,
        delay=LAB_DELAY,
    )


def _cut_beginning(time: Array, values: Array, seconds: float) -> tuple[Array, Array]:
    """Return a stream that begins later."""
    late = time >= seconds
    return time[late] - seconds, values[late]


def misstate_thrusts(text: str, vehicle: Vehicle, gains: Sequence[float]) -> str:
    """
    Return a vehicle file in which the true thrust of each rotor is a gain times the stated one.

    The vehicle itself stays as it can fly; where a gain is negative, the file has the axis of the
    rotor the other way round.
    """
    values: dict[str, Any] = {}
    a, b = vehicle.thrust_curve
    columns = vehicle.file.aero.thrust_allocation
    for (name, rotor), gain in zip(vehicle.file.rotors.items(), gains, strict=True):
        for key, value in (('a', a), ('b', b)):
            number = {'value': value / abs(gain), 'unit': 'N', 'source': 'a wrong data sheet'}
            values[f'rotors.{name}.thrust_curve.{key}'] = number
        if gain < 0.0:
            axis = [-each for each in rotor.axis.vector]
            number = {'value': axis, 'unit': '1', 'source': 'mounted the other way round'}
            values[f'rotors.{name}.axis'] = number
            values[f'aero.thrust_allocation.{name}'] = {
                key: {'value': [-each for each in part.vector], 'unit': unit, 'source': 'as axis'}
                for key, part, unit in (
                    ('force', columns[name].force, 'N/N'),
                    ('moment', columns[name].moment, 'm'),
                )
            }
    return set_yaml_values(text, values)


def draw_calibration(vehicle: Vehicle, seed: int, number: int, rotors: bool) -> tuple[float, ...]:
    """Return the gains of the rotors of a case; empty for a commanded wrench."""
    draw = np.random.default_rng([seed, number, CODE, 1])
    return tuple(_draw_gain(draw, BACKWARDS) for _ in vehicle.file.rotors) if rotors else ()


def generate_calibration_case(
    vehicle: Vehicle,
    seed: int,
    number: int,
    roles: Sequence[str] = ROLES,
    seconds: tuple[float, float] = SECONDS,
    rotors: bool = False,
    with_flows: bool = True,
    is_right: bool = False,
    course: Course | None = None,
) -> CalibrationCase:
    """
    Generate a case; it depends on its arguments only.

    Parameters
    ----------
    seed, number : int
        Of the trials and of the case.
    seconds : pair of float
        Range of flight lengths. [s]
    rotors : bool
        Whether the vehicle is commanded by duties. Its file must state wrong thrusts
        (`misstate_thrusts` with `draw_calibration`).
    with_flows : bool
        Whether drag and added mass are off, too, as a calibration assumes.
    is_right : bool
        Whether the file is right, and nothing to be calibrated: the same vehicle for comparison.
    course : Course, optional
        What a controller follows by the state alone, without dither; what is hidden is then a
        gain of 0.3, 20 mN of lift, markers turned by 8 degrees, and commands 0.2 s late.

    """
    nominal, draw = build_vehicle_truth(vehicle), np.random.default_rng([seed, number, CODE])
    truth = perturb_vehicle(nominal, draw)
    if not is_right:
        truth = (
            _hide_lab_calibration(truth, draw)
            if course
            else hide_calibration(truth, draw, with_flows)
        )
    stamps = STAMPS[int(draw.integers(len(STAMPS)))]
    draughty = number % 2 == 1
    flights, lifts, trends = list[CaseFlight](), dict[str, float](), dict[str, float]()
    for index, role in enumerate(roles):
        own = np.random.default_rng([seed, number, CODE, 10 + index])
        name = f'{role}_{index + 1}'
        lifts[name] = own.uniform(-LIFT, RISE if rotors else LIFT)
        trends[name] = own.uniform(-TREND, TREND)
        if is_right:
            lifts[name], trends[name] = FILE_LIFT * lifts[name] / LIFT, 0.0
        elif course:
            lifts[name], trends[name] = own.uniform(*LAB_LIFT), 0.0
        flight_truth = replace(truth, lift=lifts[name], leak=-trends[name])
        length = float(round(own.uniform(*seconds)))
        unseen = SETTLED if course else 0.0
        draught = LAB_DRAUGHT if course else DRAUGHT
        air: list[MovingAir] = []
        if draughty:
            air.append(RoomAirMotion(draught, unseen + length, own))
        pilot: DutyPilot = WrenchPilot(nominal, truth.wrench_gains, own)
        if rotors:
            pilot = SwingingPilot(length, nominal, own)
        elif course:
            pilot = ClosedLoopController(nominal, truth.wrench_gains, own, course)
        begin = draw_initial_state(float(own.uniform(-math.pi, math.pi)), own)
        path = FlightSimulator(
            flight_truth, pilot, air, actuators=RotorSet if rotors else WrenchActuators
        ).simulate_flight(begin, unseen + length)
        time = TICK * np.arange(len(path.commands), dtype=np.float64)
        streams = {
            'ground_truth/odom': SensorSet(path, flight_truth, stamps, own).measure_poses(),
            'motors' if rotors else 'wrench_command': (time, path.commands),
        }
        streams = {topic: _cut_beginning(*each, unseen) for topic, each in streams.items()}
        flights.append(CaseFlight(name, role, streams))
    gains = draw_calibration(vehicle, seed, number, rotors)
    shares = tuple(
        truth.thrust * own * gain for own, gain in zip(truth.gains, gains, strict=bool(gains))
    )
    return CalibrationCase(tuple(flights), truth, lifts, trends, shares, course is not None)
