"""
Define the state of one leg of a mission, and pure functions that advance and assess it.

A leg is a climb and flight to a beacon, a dwell there, or a landing. It works like a batch flight
(`lta_flight.batch`) that can be resumed: `LegState` holds the whole memory of drone and world. The
drone flies by homing (`lta_control.strategies.homing`), with bearings fitted to the amplitudes of
the diodes; no ADC blocks are simulated.
"""

import math
from typing import NamedTuple

from lta_control.attitude import yaw_from_quaternion
from lta_control.cascade import Setpoint
from lta_control.mission import MissionSettings
from lta_control.onboard import OnboardMemory
from lta_control.per_rotor import NONE, PerRotor
from lta_control.sighting import DeadReckonedMotion
from lta_control.strategies.homing import HomingMemory, start, steer, watch
from lta_control.strategies.protocol import LightSight
from lta_flight.batch.flight import initial_supply, is_plausible
from lta_flight.batch.flight_data import FlightConstants
from lta_model.electrical.battery import count_charge
from lta_model.electrical.charger import PowerFlow
from lta_model.electrical.loads import power_demand
from lta_sim.supply_step import advance_supply, SupplyInputs, SupplyState
from lta_vlc.direction_fit import DirectionFit

State = tuple[float, ...]
Amplitudes = tuple[float, ...]
MOVED = 1.0  # m of motion after which reflections are computed again
TURNED = math.cos(0.5 * 0.35) ** 2  # the same for a rotation by 0.35 rad
ON_FOOT = 0.02  # m above the standing height that still counts as on the ground

FLYING, DONE, LATE, RESERVE, EMPTY, ESCAPED, STOPPED = range(7)
GO, DWELL, LAND = range(3)  # kinds of leg
REST, CLIMB, SEEK = range(3)  # phases


class LegPlan(NamedTuple):
    """
    Plan of the next leg.

    Attributes
    ----------
    kind : int
        `GO` ends on arrival, `DWELL` after its time, `LAND` on the ground.
    limit : float
        Time limit of the leg. [s]
    reserve : float
        Charge estimate at which the leg is broken off. [1]
    payload : float
        Power of the payload: sensor and its radio. [W]
    gain, offset : float
        Errors of the current meter: factor, and offset in A.
    half_length, half_width, height : float
        Size of the room. [m]

    """

    kind: int
    limit: float
    reserve: float
    payload: float
    gain: float
    offset: float
    half_length: float
    half_width: float
    height: float


class LegState(NamedTuple):
    """
    Everything stored from leg to leg except the state of the model.

    Attributes
    ----------
    onboard, homing : OnboardMemory, HomingMemory
        Memory of the drone.
    asked : Setpoint
        Setpoint of the guidance.
    told, fresh : bool
        Whether there is a setpoint, and whether the controller has not received it yet.
    phase : int
        `REST`, `CLIMB` or `SEEK`.
    middle : tuple of float
        True position and attitude at the middle of the current light block.
    reckoned : DeadReckonedMotion
        The drone's motion estimate at that time.
    distance : float
        Newest range. [m]
    supply : SupplyState
        State of the power path, and energy since take-off.
    irradiance : float
        Irradiance on the panel. [W/m2]
    charge : float
        Charge estimate of the drone. [1]
    step, ticks, begun : int
        Control periods and integration steps since take-off, and the period at which this leg
        began.
    path : float
        Horizontal path since take-off. [m]
    lowest : float
        Lowest voltage since take-off. [V]
    outcome : int
        `FLYING` or how the leg ended.

    """

    onboard: OnboardMemory
    homing: HomingMemory
    asked: Setpoint
    told: bool
    fresh: bool
    phase: int
    middle: tuple[float, float, float, float, float, float, float]
    reckoned: DeadReckonedMotion
    distance: float
    supply: SupplyState
    irradiance: float
    charge: float
    step: int
    ticks: int
    begun: int
    path: float
    lowest: float
    outcome: int


def initial_leg_state(charge: float, counted: float) -> LegState:
    """Return the state on the ground from the true and the estimated charge."""
    return ground_leg_state(initial_supply(charge).flow, counted)


def ground_leg_state(store: PowerFlow, counted: float) -> LegState:
    """Return the state on the ground from the state of the power path."""
    onboard = OnboardMemory()
    return LegState(
        onboard, start(0.0), onboard.setpoint, False, False, REST,
        (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0), DeadReckonedMotion(0.0, 0.0, 0.0, 0.0, 0.0), math.nan,
        SupplyState(store, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0), 0.0, counted, 0, 0, 0, 0.0,
        store.voltage, FLYING,
    )  # fmt: skip


def reckon_motion(onboard: OnboardMemory) -> DeadReckonedMotion:
    """Return the drone's estimate of its motion."""
    measured, place_ = onboard.measured, onboard.estimate.position
    return DeadReckonedMotion(
        measured.heading, place_[0], place_[1], measured.speed, measured.sway
    )


def unreachable_pose() -> tuple[float, float, float, float, float, float, float]:
    """Return an infinitely distant pose, which makes `has_moved` true."""
    return (math.inf, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0)


def has_moved(pose: State, gathered: State) -> bool:
    """Return whether reflections must be computed again (direct light always is)."""
    x, y, z = pose[0] - gathered[0], pose[1] - gathered[1], pose[2] - gathered[2]
    # Negated, so that an infinite or NaN distance counts as motion.
    if not x * x + y * y + z * z < MOVED * MOVED:
        return True
    # The dot product of two quaternions is the cosine of half the angle between them;
    # squared, because q and -q are the same attitude.
    same = 0.0
    for k in range(3, 7):
        same += pose[k] * gathered[k]
    return same * same < TURNED


def lamp_strength(cosines: Amplitudes, sines: Amplitudes, amplitudes: Amplitudes) -> float:
    """Return the reading of a diode that faces the lamp, as in `sighting`. [counts]"""
    forward = left = 0.0
    for k in range(len(amplitudes)):
        forward += amplitudes[k] * cosines[k]
        left += amplitudes[k] * sines[k]
    # A max(cos, 0) cos, summed over an even ring of n cosine diodes, is A n / 4.
    return 4.0 * math.hypot(forward, left) / len(amplitudes)


def sight_from_fit(
    lamp: DirectionFit,
    detected: bool,
    strength: float,
    reckoned: DeadReckonedMotion,
    interval: float,
) -> LightSight:
    """Return the sighting of a light block from a direction fit."""
    bearing = deviation = 0.0
    if detected:
        bearing = math.atan2(lamp.y, lamp.x)
        deviation = math.sqrt(max(lamp.azimuth_variance, 0.0))
    return LightSight(
        detected, bearing, reckoned.heading, (0.0,), interval, deviation,
        strength if detected else 0.0, 0.0,
        (reckoned.x, reckoned.y), (reckoned.forward, reckoned.left),
    )  # fmt: skip


def guide_leg(
    settings: MissionSettings,
    kind: int,
    phase: int,
    homing: HomingMemory,
    sight: LightSight,
    ready: bool,
    altitude: float,
) -> tuple[tuple[float, float, float], int, HomingMemory]:
    """Return setpoint, phase and memory: `mission.mission_step` for homing to one lamp."""
    if not ready:
        return (0.0, sight.heading, 0.0), phase, homing
    # The calibration at rest has ended; hold the heading of that moment in the climb.
    if phase == REST:
        phase, homing = CLIMB, start(sight.heading)
    if phase == CLIMB and altitude > settings.altitude - settings.reached:
        phase = SEEK
    if kind == LAND:
        return (settings.landing, homing.heading, 0.0), phase, homing
    if phase == SEEK:
        course, homing = steer(settings, homing, sight)
        return (settings.altitude, course.heading, course.speed), phase, homing
    # While climbing, only follow the sightings, so that the wind estimate starts early.
    homing = watch(settings, homing, sight)
    return (settings.altitude, homing.heading, 0.0), phase, homing


def step_leg_supply(
    constants: FlightConstants,
    leg: LegPlan,
    supply: SupplyState,
    irradiance: float,
    thrusts: PerRotor,
    dt: float,
) -> SupplyState:
    """Advance the supply by a control period; light in W/m2, thrusts in N, time in s."""
    demand = (
        power_demand(constants.power.loads, thrusts, True) + constants.power.looking + leg.payload
    )
    meantime = SupplyInputs(irradiance, demand, dt, False, False)
    return advance_supply(constants.power.parts, supply, meantime, 0.0)


def meter_charge(
    constants: FlightConstants, leg: LegPlan, charge: float, current: float, dt: float
) -> float:
    """Advance the drone's charge estimate with the errors of its current meter."""
    return count_charge(
        charge, leg.gain * current + leg.offset, constants.power.parts.cell.capacity, dt
    )


def assess_leg(
    constants: FlightConstants,
    leg: LegPlan,
    state: State,
    onboard: OnboardMemory,
    homing: HomingMemory,
    phase: int,
    fed: bool,
    charge: float,
    spent: float,
) -> int:
    """Return the outcome of a leg after a time. [s]"""
    # The order matters: the first condition that holds names the outcome.
    if not fed:
        return EMPTY
    # The origin is the centre of the floor.
    inside = abs(state[0]) <= leg.half_length and abs(state[1]) <= leg.half_width
    if not (inside and state[2] <= leg.height):
        return ESCAPED
    if onboard.stopped or not is_plausible(state):
        return STOPPED
    # A landing goes on below the reserve, so it is assessed before the charge.
    if leg.kind == LAND:
        down = state[2] <= constants.place[2] + ON_FOOT and onboard.duties == NONE
        return DONE if down else LATE if spent >= leg.limit else FLYING
    if leg.kind == GO and phase == SEEK and homing.arrived:
        return DONE
    if charge <= leg.reserve:
        return RESERVE
    if spent < leg.limit:
        return FLYING
    # A dwell ends by its time; every other leg that reaches its limit is late.
    return DONE if leg.kind == DWELL else LATE


def state_heading(state: State) -> float:
    """Return the heading of a state. [rad]"""
    return yaw_from_quaternion((state[3], state[4], state[5], state[6]))
