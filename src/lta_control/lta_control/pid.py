# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
One PID loop as a pure function.

The derivative acts on the measurement, so that a setpoint step causes no kick. The integral is
reduced by the saturated part of the output, here or further down the chain (back-calculation,
Astrom and Haegglund, PID Controllers, 1995, section 3.5), with the tracking time kp / ki.
"""

import math

from lta_config.settings import setting, Settings
from lta_control.attitude import clamp_symmetric


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
