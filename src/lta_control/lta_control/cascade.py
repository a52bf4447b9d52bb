"""
The cascaded controller of the paper: position loops outside, velocity loops inside.

Altitude -> climb rate -> vertical force; heading -> yaw rate -> yaw moment; forward airspeed ->
surge force with the drag at the wanted speed fed forward, and a share of the pitch rate, since
what pushes below the hull also pitches it. All pure functions of scalars and
tuples: memory in, memory out.
"""

import math
from typing import NamedTuple

from lta_config.settings import setting, Settings
from lta_control.pid import pid_step, PidGains

SOON = 1.0  # s; how far ahead a climb counts as height
LEAST_PUSH = 0.3
SLOPE_TIME = 0.1  # s; noise of the rates against delay of the derivative terms


class CascadeGains(Settings):
    """Gains of all loops; the values are a vehicle's, from `config/control/`."""

    altitude_kp: float = setting(
        ..., 'Climb rate asked for each metre below.', unit='1/s', low=0.0, high=10.0
    )
    climb_limit: float = setting(..., 'Largest climb rate.', unit='m/s', low=0.01, high=2.0)
    climb: PidGains = setting(..., 'Climb rate to vertical force, N per m/s.')
    heading_kp: float = setting(
        ..., 'Yaw rate asked for each radian of error.', unit='1/s', low=0.0, high=10.0
    )
    yaw_rate_limit: float = setting(..., 'Largest yaw rate.', unit='rad/s', low=0.01, high=6.0)
    yaw_rate: PidGains = setting(..., 'Yaw rate to yaw moment, N m per rad/s.')
    speed: PidGains = setting(..., 'Airspeed to surge force, N per m/s.')
    turn_first: float = setting(
        ...,
        'Heading error at which forward flight waits for the turn.',
        unit='rad',
        low=0.05,
        high=10.0,
    )
    drift_gain: float = setting(
        ..., 'Angle of the nose against sideways drift.', unit='rad s/m', low=0.0, high=20.0
    )
    drift_limit: float = setting(..., 'Largest such angle.', unit='rad', low=0.0, high=1.5)
    speed_limit: float = setting(
        ..., 'Largest forward airspeed; faster, the hull may rise.', unit='m/s', low=0.01, high=5.0
    )
    rise_limit: float = setting(
        ...,
        'Height above the wanted one at which the push forward is given up.',
        unit='m',
        low=0.05,
        high=100.0,
    )
    swing_gain: float = setting(
        ...,
        'Surge force against the pitch rate: rotors below the hull stop its swing.',
        unit='N s/rad',
        low=-1.0,
        high=1.0,
    )


class CascadeMeasurement(NamedTuple):
    """What the cascade acts on, from the estimator."""

    altitude: float  # of the hull centre above the floor [m]
    climb: float  # [m/s]
    heading: float  # [rad]
    yaw_rate: float  # [rad/s]
    speed: float  # forward airspeed [m/s]
    sway: float  # airspeed to the left [m/s]
    pitch_rate: float  # nose down [rad/s]


class Setpoint(NamedTuple):
    """What the navigator asks for."""

    altitude: float  # [m]
    heading: float  # [rad]
    speed: float  # forward airspeed [m/s]


class WrenchDemand(NamedTuple):
    """Force and moment asked of the rotors, body frame."""

    surge: float  # [N]
    heave: float  # [N]
    yaw: float  # [N m]


class SlopeEstimate(NamedTuple):
    """A measurement and its smoothed rate, for the derivative terms."""

    value: float = math.nan  # NaN before the first measurement
    rate: float = 0.0


class CascadeMemory(NamedTuple):
    """Integral terms of the inner loops, and the slopes of what they measure."""

    climb: float = 0.0  # [N]
    yaw_rate: float = 0.0  # [N m]
    speed: float = 0.0  # [N]
    climbing: SlopeEstimate = SlopeEstimate()  # [m/s, m/s2]
    turning: SlopeEstimate = SlopeEstimate()  # [rad/s, rad/s2]
    speeding: SlopeEstimate = SlopeEstimate()  # [m/s, m/s2]


def slope_step(slope: SlopeEstimate, value: float, dt: float) -> SlopeEstimate:
    """Return a slope after one more measurement: the difference behind a first-order filter."""
    if math.isnan(slope.value):
        return SlopeEstimate(value, 0.0)
    share = dt / (SLOPE_TIME + dt)
    return SlopeEstimate(value, slope.rate + share * ((value - slope.value) / dt - slope.rate))


def wrap_angle(angle: float) -> float:
    """Return an angle in [-pi, pi). [rad]"""
    return angle - 2.0 * math.pi * math.floor((angle + math.pi) / (2.0 * math.pi))


def drag_force(linear: float, quadratic: float, speed: float) -> float:
    """Return the drag against a speed along one axis, paper F_D. [N]."""
    return (linear + quadratic * abs(speed)) * speed


def pid_gains(gains: PidGains) -> tuple[float, float, float, float, float]:
    """Return a loop's gains as the tuple that `pid_step` takes."""
    return gains.kp, gains.ki, gains.kd, -gains.limit, gains.limit


def steer_to_course(
    gains: CascadeGains, measured: CascadeMeasurement, setpoint: Setpoint
) -> tuple[float, float, float, float]:
    """
    Return heading and speed to ask for, and how the drone stands to its course.

    A round hull has no keel: turning the nose does not turn the motion. So the drone turns first
    and flies then, and leans its nose against the drift that is left across the course. The rotors
    push along the nose only: of what lacks along the course, just their share is theirs. A drone
    that is to go nowhere has no course but its nose.

    Returns
    -------
    tuple of float
        Heading [rad], forward speed [m/s], present airspeed along the course [m/s], and the share
        of a push along the nose that goes along the course.

    """
    moving = 1.0 if setpoint.speed > 0.0 else 0.0
    off = moving * wrap_angle(measured.heading - setpoint.heading)
    cos, sin = math.cos(off), math.sin(off)
    along = cos * measured.speed - sin * measured.sway
    across = sin * measured.speed + cos * measured.sway
    lean = min(max(gains.drift_gain * across, -gains.drift_limit), gains.drift_limit)
    heading = setpoint.heading - moving * lean
    error = abs(wrap_angle(heading - measured.heading))
    wanted = min(setpoint.speed, gains.speed_limit)
    speed = wanted * max(0.0, 1.0 - error / gains.turn_first)
    return heading, speed, along, cos


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
    Return what the rotors should do, and the new memory.

    Parameters
    ----------
    gains : CascadeGains
        Gains of all loops.
    surge_drag : tuple
        Linear [N s/m] and quadratic [N s2/m2] drag along body x, for the feed-forward.
    lowest_heave : float
        Strongest push downwards that the rotors have; 0 where gravity alone brings it down. [N]
    sink : float
        Heave that comes with a newton of surge, negative where jets draw the hull down. [N/N]
    memory : CascadeMemory
        From the last step.
    measured, setpoint : Measured, Setpoint
        Where the drone is and where it should be.
    shortfall : Demand
        What the rotors gave beyond the last demand; negative when it was too much to ask.
    dt : float
        Time since the last step. [s]

    """
    heading, speed, along, share = steer_to_course(gains, measured, setpoint)
    rate = _clamp_symmetric(
        gains.heading_kp * wrap_angle(heading - measured.heading), gains.yaw_rate_limit
    )
    turning = slope_step(memory.turning, measured.yaw_rate, dt)
    yaw, rate_memory = pid_step(
        pid_gains(gains.yaw_rate),
        memory.yaw_rate,
        rate - measured.yaw_rate,
        turning.rate,
        shortfall.yaw,
        dt,
    )
    speeding = slope_step(memory.speeding, measured.speed, dt)
    surge, speed_memory = pid_step(
        pid_gains(gains.speed),
        memory.speed,
        share * (speed - along),
        speeding.rate,
        shortfall.surge,
        dt,
    )
    surge += drag_force(surge_drag[0], surge_drag[1], speed)
    surge *= _surge_share(gains, measured, setpoint)
    surge += gains.swing_gain * measured.pitch_rate
    climb = gains.altitude_kp * (setpoint.altitude - measured.altitude)
    climb = _clamp_symmetric(climb, gains.climb_limit)
    climbing = slope_step(memory.climbing, measured.climb, dt)
    kp, ki, kd, low, high = pid_gains(gains.climb)
    lowest = lowest_heave + min(sink * surge, 0.0)
    heave, climb_memory = pid_step(
        (kp, ki, kd, max(lowest, low), high),
        memory.climb,
        climb - measured.climb,
        climbing.rate,
        shortfall.heave,
        dt,
    )
    return WrenchDemand(surge, heave, yaw), CascadeMemory(
        climb_memory, rate_memory, speed_memory, climbing, turning, speeding
    )


def _surge_share(gains: CascadeGains, measured: CascadeMeasurement, setpoint: Setpoint) -> float:
    """
    Return the share of the surge force that is left to a drone above its altitude.

    Pushed from below, a hull leans back and is lifted by what pushes it. Height goes first: above
    it winds are stronger, and nothing but weight brings the drone down again.
    """
    above = measured.altitude - setpoint.altitude + SOON * measured.climb
    return min(max(1.0 - above / gains.rise_limit, LEAST_PUSH), 1.0)


def _clamp_symmetric(value: float, limit: float) -> float:
    return min(max(value, -limit), limit)
