# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
The cascaded controller of the paper: position loops outside, velocity loops inside.

Altitude -> climb rate -> vertical force; heading -> yaw rate -> yaw moment; forward airspeed ->
surge force. The drag at the wanted speed is fed forward. A pitch-rate term is added to the surge
force, because thrust below the hull also pitches it. The cascade demands a wrench and the
allocation delivers what the rotors can. The shortfall goes back to the cascade, so that no
integral winds up while a rotor is at its limit.

The derivative of a PID loop acts on the measurement, so that a setpoint step causes no kick. The
integral is reduced by the saturated part of the output, here or further down the chain
(back-calculation, Astrom and Haegglund, PID Controllers, 1995, section 3.5), with the tracking
time kp / ki.
"""

import math
from typing import NamedTuple

from lta_config.settings import setting, Settings
from lta_control.allocation import deliver_wrench, NO_ROTORS, PerRotor, Rotors, Scratch
from lta_control.laws.protocol import ControlLaw, Feedback, LawCommand, LawInputs, UNMOVED
from lta_control.motion import CascadeMeasurement, drag_force, measure_motion, Setpoint, wrap_angle
from lta_control.vehicle_parameters import build_rotors, surge_drag_coefficients
from lta_model.vehicle import Vehicle

CLIMB_LOOKAHEAD = 1.0  # s; look-ahead: climb rate times this counts as height
LEAST_SURGE_SHARE = 0.3  # share of the surge force that always remains (tuned)
SLOPE_TIME = 0.1  # s; filter of the derivative terms: less noise against more delay


class PidGains(Settings):
    """
    Gains of one loop.

    Output unit per unit of error, per second and so on; the setting that holds them names the
    units.
    """

    kp: float = setting(..., low=0.0, high=100.0)
    """Proportional gain."""
    ki: float = setting(..., '1/s', 0.0, 100.0)
    """Integral gain."""
    kd: float = setting(..., 's', 0.0, 100.0)
    """Derivative gain, on the measured rate of change."""
    limit: float = setting(..., low=0.0, high=100.0)
    """Largest output in either direction."""


def pid_step(
    gains: PidGains,
    integral: float,
    error: float,
    rate: float,
    shortfall: float,
    dt: float,
    lowest: float = -math.inf,
) -> tuple[float, float]:
    """
    Return the output and the new integral.

    Parameters
    ----------
    integral : float
        Integral term of the last step. [output]
    error : float
        Setpoint minus measurement.
    rate : float
        Rate of the measurement. [error unit / s]
    shortfall : float
        Delivered minus demanded output of the stage below (<= 0 if too much was demanded).
        [output]
    dt : float
        Time since the last step. [s]
    lowest : float
        Lowest output, if it is above minus the limit of the gains.

    """
    unlimited = gains.kp * error + integral - gains.kd * rate
    output = min(max(unlimited, max(lowest, -gains.limit)), gains.limit)
    # Tracking time kp / ki
    unwind = gains.ki / gains.kp if gains.kp > 0.0 else 0.0
    return output, integral + dt * (gains.ki * error + unwind * (output - unlimited + shortfall))


def clamp_symmetric(value: float, limit: float) -> float:
    """Return a value clamped to plus and minus a limit."""
    return min(max(value, -limit), limit)


class ClimbGains(Settings):
    """Gains from altitude to vertical force."""

    altitude_kp: float = setting(..., '1/s', 0.0, 10.0)
    """Commanded climb rate per metre of altitude error."""
    climb_limit: float = setting(..., 'm/s', 0.01, 2.0)
    """Largest commanded climb rate."""
    climb: PidGains = setting(...)
    """PID gains: vertical force (N) per climb rate error (m/s)."""


def lift_step(
    gains: ClimbGains, integral: float, error: float, climb: float, missing: float, dt: float
) -> tuple[float, float]:
    """
    Return the vertical force beyond the weight, and the new integral [N].

    `error` is the altitude setpoint minus the altitude [m], `climb` the upward velocity [m/s],
    and `missing` the delivered minus the demanded force of the last step [N]. The derivative gain
    is not used.
    """
    climb_rate = clamp_symmetric(gains.altitude_kp * error, gains.climb_limit)
    # A measured rate of 0 disables the derivative term
    return pid_step(gains.climb, integral, climb_rate - climb, 0.0, missing, dt)


class CascadeGains(Settings):
    """Gains of all loops; each vehicle has its values in `config/control/`."""

    altitude_kp: float = setting(..., '1/s', 0.0, 10.0)
    """Commanded climb rate per metre of altitude error."""
    climb_limit: float = setting(..., 'm/s', 0.01, 2.0)
    """Largest commanded climb rate."""
    climb: PidGains = setting(...)
    """PID gains: vertical force (N) per climb rate error (m/s)."""
    heading_kp: float = setting(..., '1/s', 0.0, 10.0)
    """Commanded yaw rate per radian of heading error."""
    yaw_rate_limit: float = setting(..., 'rad/s', 0.01, 6.0)
    """Largest commanded yaw rate."""
    yaw_rate: PidGains = setting(...)
    """PID gains: yaw moment (N m) per yaw rate error (rad/s)."""
    speed: PidGains = setting(...)
    """PID gains: forward force (N) per airspeed error (m/s)."""
    turn_first: float = setting(..., 'rad', 0.05, 10.0)
    """Heading error at which the commanded forward speed falls to zero."""
    drift_gain: float = setting(..., 'rad s/m', 0.0, 20.0)
    """Heading correction against sideways drift, per drift speed."""
    drift_limit: float = setting(..., 'rad', 0.0, 1.5)
    """Largest heading correction against sideways drift."""
    speed_limit: float = setting(..., 'm/s', 0.01, 5.0)
    """Largest commanded forward airspeed; above it the hull may rise."""
    rise_limit: float = setting(..., 'm', 0.05, 100.0)
    """Height above the setpoint at which forward thrust is reduced to its minimum."""
    swing_gain: float = setting(..., 'N s/rad', -1.0, 1.0)
    """Forward force per pitch rate, to damp the pitch oscillation of the hull."""


class WrenchDemand(NamedTuple):
    """Demanded force and moment of the rotors, body frame."""

    surge: float  # [N]
    heave: float  # [N]
    yaw: float  # [N m]


class SlopeEstimate(NamedTuple):
    """A measurement and its filtered rate, for the derivative terms."""

    value: float = math.nan  # NaN before the first measurement
    rate: float = 0.0


class CascadeMemory(NamedTuple):
    """Integral terms of the inner loops, and the filtered slopes of their measurements."""

    climb: float = 0.0  # [N]
    yaw_rate: float = 0.0  # [N m]
    speed: float = 0.0  # [N]
    climbing: SlopeEstimate = SlopeEstimate()  # [m/s, m/s2]
    turning: SlopeEstimate = SlopeEstimate()  # [rad/s, rad/s2]
    speeding: SlopeEstimate = SlopeEstimate()  # [m/s, m/s2]


def slope_step(slope: SlopeEstimate, value: float, dt: float) -> SlopeEstimate:
    """Return the slope after one more measurement: a first-order filtered difference."""
    if math.isnan(slope.value):
        return SlopeEstimate(value, 0.0)
    # First-order low-pass (backward Euler)
    share = dt / (SLOPE_TIME + dt)
    return SlopeEstimate(value, slope.rate + share * ((value - slope.value) / dt - slope.rate))


def steer_to_course(
    gains: CascadeGains, measured: CascadeMeasurement, setpoint: Setpoint
) -> tuple[float, float, float, float]:
    """
    Return heading error and commanded speed, and the motion relative to the course.

    A round hull has no keel: turning the nose does not turn the motion. The drone therefore turns
    before it accelerates, and points its nose into the remaining drift across the course. The
    rotors push only along the nose, so only that share of the error along the course is
    corrected. At zero commanded speed the course is the nose direction.

    Returns
    -------
    tuple of float
        Heading error [rad], forward speed [m/s], airspeed along the course [m/s], and the share
        of a force along the nose that acts along the course.

    """
    moving = 1.0 if setpoint.speed > 0.0 else 0.0
    # Angle from the course to the nose
    off = moving * wrap_angle(measured.heading - setpoint.heading)
    cos, sin = math.cos(off), math.sin(off)
    # Airspeed in the axes of the course
    along = cos * measured.speed - sin * measured.sway
    across = sin * measured.speed + cos * measured.sway
    lean = min(max(gains.drift_gain * across, -gains.drift_limit), gains.drift_limit)
    turn = wrap_angle(setpoint.heading - moving * lean - measured.heading)
    target = min(setpoint.speed, gains.speed_limit)
    # Turn first: no forward speed until the heading error is below `turn_first`
    speed = target * max(0.0, 1.0 - abs(turn) / gains.turn_first) if target > 0.0 else target
    return turn, speed, along, cos


def cascade_step(
    gains: CascadeGains,
    surge_drag: tuple[float, float],
    lowest_heave: float,
    sink: float,
    memory: CascadeMemory,
    measured: CascadeMeasurement,
    setpoint: Setpoint,
    shortfall: WrenchDemand,
    dt: float,
) -> tuple[WrenchDemand, CascadeMemory]:
    """
    Return the demand on the rotors, and the new memory.

    Parameters
    ----------
    surge_drag : tuple
        Linear [N s/m] and quadratic [N s2/m2] drag along body x, for the feed-forward.
    lowest_heave : float
        Strongest downward rotor force; 0 where only gravity brings the drone down. [N]
    sink : float
        Heave per newton of surge; negative where the jets pull the hull down. [N/N]
    shortfall : WrenchDemand
        Delivered minus demanded wrench of the last step; negative if too much was demanded.
    dt : float
        Time since the last step. [s]

    """
    turn, speed, along, share = steer_to_course(gains, measured, setpoint)
    rate = min(max(gains.heading_kp * turn, -gains.yaw_rate_limit), gains.yaw_rate_limit)
    climb = gains.altitude_kp * (setpoint.altitude - measured.altitude)
    climb = min(max(climb, -gains.climb_limit), gains.climb_limit)
    turning = slope_step(memory.turning, measured.yaw_rate, dt)
    speeding = slope_step(memory.speeding, measured.speed, dt)
    climbing = slope_step(memory.climbing, measured.climb, dt)
    drag = drag_force(surge_drag[0], surge_drag[1], speed)
    # A hull pushed from below leans back and is lifted by the thrust. Altitude has priority: wind
    # is stronger higher up, and only weight brings the drone down again.
    above = measured.altitude - setpoint.altitude + CLIMB_LOOKAHEAD * measured.climb
    left = min(max(1.0 - above / gains.rise_limit, LEAST_SURGE_SHARE), 1.0)
    yaw, rate_memory = pid_step(
        gains.yaw_rate,
        memory.yaw_rate,
        rate - measured.yaw_rate,
        turning.rate,
        shortfall.yaw,
        dt,
    )
    surge, speed_memory = pid_step(
        gains.speed,
        # What held the speed forward would push on backwards
        memory.speed if setpoint.speed >= 0.0 else 0.0,
        share * (speed - along),
        speeding.rate,
        shortfall.surge,
        dt,
    )
    # The feed-forward comes after the PID, so that its limit bounds the correction only.
    surge += drag
    # Above the setpoint less surge; the damping term afterwards is always kept
    surge *= left
    surge += gains.swing_gain * measured.pitch_rate
    heave, climb_memory = pid_step(
        gains.climb,
        memory.climb,
        climb - measured.climb,
        climbing.rate,
        shortfall.heave,
        dt,
        # The jets' own downward pull extends the reachable heave
        lowest_heave + min(sink * surge, 0.0),
    )
    return WrenchDemand(surge, heave, yaw), CascadeMemory(
        climb_memory, rate_memory, speed_memory, climbing, turning, speeding
    )


class CascadeLawConstants(NamedTuple):
    """Gains, rotors, and drag along body x: linear [N s/m] and quadratic [N s2/m2]."""

    gains: CascadeGains
    rotors: Rotors
    surge_drag: tuple[float, float]


class CascadeLawMemory(NamedTuple):
    """The latest command, the cascade, thrusts [N], and delivered minus demanded wrench."""

    command: LawCommand = LawCommand()
    cascade: CascadeMemory = CascadeMemory()
    thrusts: PerRotor = NO_ROTORS
    shortfall: WrenchDemand = WrenchDemand(0.0, 0.0, 0.0)


def build_constants(gains: CascadeGains, vehicle: Vehicle) -> CascadeLawConstants:
    """Return the values that stay constant during a flight."""
    return CascadeLawConstants(gains, build_rotors(vehicle), surge_drag_coefficients(vehicle))


def step(
    constants: CascadeLawConstants, memory: CascadeLawMemory, inputs: LawInputs, scratch: Scratch
) -> CascadeLawMemory:
    """Return the memory one step later, with the new command in it."""
    measured = measure_motion(inputs.motion)
    return control_step(constants, memory, measured, inputs.setpoint, inputs.dt, scratch)


def control_step(
    constants: CascadeLawConstants,
    memory: CascadeLawMemory,
    measured: CascadeMeasurement,
    setpoint: Setpoint,
    dt: float,
    scratch: Scratch,
) -> CascadeLawMemory:
    """Return the memory one step later; `dt` since the last step [s], `scratch` of `allocate`."""
    demand, cascade = compute_demand(constants, memory, measured, setpoint, dt)
    return deliver_demand(constants.rotors, demand, cascade, memory.thrusts, scratch)


def compute_demand(
    constants: CascadeLawConstants,
    memory: CascadeLawMemory,
    measured: CascadeMeasurement,
    setpoint: Setpoint,
    dt: float,
) -> tuple[WrenchDemand, CascadeMemory]:
    """Return the demand of the cascade and its memory."""
    rotors = constants.rotors
    return cascade_step(
        constants.gains,
        constants.surge_drag,
        rotors.lowest_heave,
        rotors.sink,
        memory.cascade,
        measured,
        setpoint,
        memory.shortfall,
        dt,
    )


def deliver_demand(
    rotors: Rotors,
    demand: WrenchDemand,
    cascade: CascadeMemory,
    thrusts: PerRotor,
    scratch: Scratch,
) -> CascadeLawMemory:
    """
    Return the memory with the duties that deliver a demand best.

    `cascade` is the memory of the cascade after this step, `thrusts` those of the last step [N].
    """
    # Surge, heave and yaw only: sway, roll and pitch are not controlled.
    wrench = (demand.surge, 0.0, demand.heave, 0.0, 0.0, demand.yaw)
    duties, thrusts, delivered = deliver_wrench(rotors, wrench, thrusts, scratch)
    # Delivered minus demanded, for the anti-windup of the next step
    shortfall = WrenchDemand(
        delivered[0] - demand.surge, delivered[2] - demand.heave, delivered[5] - demand.yaw
    )
    return CascadeLawMemory(LawCommand(duties, UNMOVED), cascade, thrusts, shortfall)


CASCADE_LAW = ControlLaw(
    'cascade', CascadeGains, Feedback.ESTIMATOR, build_constants, CascadeLawMemory(), step
)
