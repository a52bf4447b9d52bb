"""
The cascaded controller of the paper: position loops outside, velocity loops inside.

Altitude -> climb rate -> vertical force; heading -> yaw rate -> yaw moment; forward airspeed ->
surge force with the drag at the wanted speed fed forward. All pure functions of scalars and
tuples: memory in, memory out.
"""

import math
from typing import NamedTuple

from lta_config.settings import setting, Settings
from lta_control.pid import pid_step, PidGains


class CascadeGains(Settings):
    """Gains of all loops. Tuned in simulation and flown unmodified, as in the paper."""

    altitude_kp: float = setting(
        0.6, 'Climb rate asked for each metre below.', unit='1/s', low=0.0, high=10.0
    )
    climb_limit: float = setting(0.2, 'Largest climb rate.', unit='m/s', low=0.01, high=2.0)
    climb: PidGains = setting(
        PidGains(kp=0.8, ki=0.25, limit=0.3), 'Climb rate to vertical force, N per m/s.'
    )
    heading_kp: float = setting(
        0.8, 'Yaw rate asked for each radian of error.', unit='1/s', low=0.0, high=10.0
    )
    yaw_rate_limit: float = setting(0.5, 'Largest yaw rate.', unit='rad/s', low=0.01, high=6.0)
    yaw_rate: PidGains = setting(
        PidGains(kp=0.05, ki=0.02, limit=0.02), 'Yaw rate to yaw moment, N m per rad/s.'
    )
    speed: PidGains = setting(
        PidGains(kp=0.2, ki=0.05, limit=0.2), 'Airspeed to surge force, N per m/s.'
    )


class Measured(NamedTuple):
    """What the cascade acts on, from the estimator."""

    altitude: float  # of the hull centre above the floor [m]
    climb: float  # [m/s]
    heading: float  # [rad]
    yaw_rate: float  # [rad/s]
    speed: float  # forward airspeed [m/s]


class Setpoint(NamedTuple):
    """What the navigator asks for."""

    altitude: float  # [m]
    heading: float  # [rad]
    speed: float  # forward airspeed [m/s]


class Demand(NamedTuple):
    """Force and moment asked of the rotors, body frame."""

    surge: float  # [N]
    heave: float  # [N]
    yaw: float  # [N m]


class CascadeMemory(NamedTuple):
    """Integral terms of the inner loops, and what they asked for last."""

    climb: float = 0.0  # [N]
    yaw_rate: float = 0.0  # [N m]
    speed: float = 0.0  # [N]


def wrap(angle: float) -> float:
    """Return an angle in [-pi, pi]. [rad]."""
    return math.remainder(angle, 2.0 * math.pi)


def drag_force(linear: float, quadratic: float, speed: float) -> float:
    """Return the drag against a speed along one axis, paper F_D. [N]."""
    return (linear + quadratic * abs(speed)) * speed


def pid_gains(gains: PidGains) -> tuple[float, float, float, float]:
    """Return a loop's gains as the tuple that `pid_step` takes."""
    return gains.kp, gains.ki, gains.kd, gains.limit


def cascade_step(
    gains: CascadeGains,
    surge_drag: tuple[float, float],
    memory: CascadeMemory,
    measured: Measured,
    setpoint: Setpoint,
    shortfall: Demand,
    dt: float,
) -> tuple[Demand, CascadeMemory]:
    """
    Return what the rotors should do, and the new memory.

    Parameters
    ----------
    gains : CascadeGains
        Gains of all loops.
    surge_drag : tuple
        Linear [N s/m] and quadratic [N s2/m2] drag along body x, for the feed-forward.
    memory : CascadeMemory
        From the last step.
    measured, setpoint : Measured, Setpoint
        Where the drone is and where it should be.
    shortfall : Demand
        What the rotors gave beyond the last demand; negative when it was too much to ask.
    dt : float
        Time since the last step. [s]

    """
    climb = gains.altitude_kp * (setpoint.altitude - measured.altitude)
    climb = min(max(climb, -gains.climb_limit), gains.climb_limit)
    heave, climb_memory = pid_step(
        pid_gains(gains.climb), memory.climb, climb - measured.climb, 0.0, shortfall.heave, dt
    )
    rate = gains.heading_kp * wrap(setpoint.heading - measured.heading)
    rate = min(max(rate, -gains.yaw_rate_limit), gains.yaw_rate_limit)
    yaw, rate_memory = pid_step(
        pid_gains(gains.yaw_rate),
        memory.yaw_rate,
        rate - measured.yaw_rate,
        0.0,
        shortfall.yaw,
        dt,
    )
    surge, speed_memory = pid_step(
        pid_gains(gains.speed),
        memory.speed,
        setpoint.speed - measured.speed,
        0.0,
        shortfall.surge,
        dt,
    )
    surge += drag_force(*surge_drag, setpoint.speed)
    return Demand(surge, heave, yaw), CascadeMemory(climb_memory, rate_memory, speed_memory)
