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
from lta_control.mission import initial_mission, mission_step, MissionSettings
from lta_control.onboard import OnboardMemory
from lta_control.per_rotor import NONE, PerRotor
from lta_control.phases import Mission, Phase
from lta_control.reserve import FlightPermission, ReserveRule
from lta_control.sighting import DeadReckonedMotion
from lta_control.strategies.homing import STRATEGY
from lta_control.strategies.protocol import LightSight, NavigationStrategy
from lta_flight.batch.flight import initial_supply, is_plausible
from lta_flight.batch.flight_data import FlightConstants
from lta_model.electrical.battery import count_charge
from lta_model.electrical.charger import PowerFlow
from lta_model.electrical.loads import power_demand
from lta_sim.supply_step import advance_supply, SupplyInputs, SupplyState
from lta_sim.termination import is_indoors

State = tuple[float, ...]
MOVED = 1.0  # m of motion after which reflections are computed again
TURNED = math.cos(0.5 * 0.35) ** 2  # the same for a rotation by 0.35 rad
ON_FOOT = 0.02  # m above the standing height that still counts as on the ground

FLYING, DONE, LATE, RESERVE, EMPTY, ESCAPED, STOPPED = range(7)
GO, DWELL, LAND = range(3)  # kinds of leg


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

    """

    kind: int
    limit: float
    reserve: float
    payload: float
    gain: float
    offset: float


class LegState(NamedTuple):
    """
    Everything stored from leg to leg except the state of the model.

    Attributes
    ----------
    onboard, mission : OnboardMemory, Mission
        Memory of the drone.
    asked : Setpoint
        Setpoint of the guidance.
    told, fresh : bool
        Whether there is a setpoint, and whether the controller has not received it yet.
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
    mission: Mission
    asked: Setpoint
    told: bool
    fresh: bool
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
        onboard, initial_mission(STRATEGY), onboard.setpoint, False, False,
        (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0), DeadReckonedMotion(0.0, 0.0, 0.0, 0.0, 0.0), math.nan,
        SupplyState(store, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0), 0.0, counted, 0, 0, 0, 0.0,
        store.voltage, FLYING,
    )  # fmt: skip


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


def guide_leg(
    settings: MissionSettings,
    strategy: NavigationStrategy,
    kind: int,
    mission: Mission,
    sight: LightSight,
    altitude: float,
    rule: ReserveRule,
) -> tuple[Setpoint, Mission]:
    """Return setpoint and mission; the leg, not the energy monitor, decides when to land."""
    if kind == LAND:
        mission = mission._replace(phase=Phase.LAND)
    return mission_step(
        settings, strategy, mission, sight, altitude, FlightPermission.FLY, 1, rule
    )


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
    mission: Mission,
    fed: bool,
    charge: float,
    spent: float,
) -> int:
    """Return the outcome of a leg after a time. [s]"""
    # The order matters: the first condition that holds names the outcome.
    if not fed:
        return EMPTY
    if not is_indoors(constants.goal, state[0], state[1], state[2]):
        return ESCAPED
    if onboard.stopped or not is_plausible(state):
        return STOPPED
    # A landing goes on below the reserve, so it is assessed before the charge.
    if leg.kind == LAND:
        down = state[2] <= constants.place[2] + ON_FOOT and onboard.duties == NONE
        return DONE if down else LATE if spent >= leg.limit else FLYING
    if leg.kind == GO and mission.phase == Phase.ARRIVED:
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
