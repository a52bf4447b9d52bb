"""Altitude control for most of the laws: altitude error to climb rate to vertical force."""

from lta_config.settings import setting, Settings
from lta_control.laws.frames import clamp_symmetric
from lta_control.pid import pid_step, PidGains


class ClimbGains(Settings):
    """Gains from altitude to vertical force."""

    altitude_kp: float = setting(
        ..., 'Commanded climb rate per metre of altitude error.', '1/s', 0.0, 10.0
    )
    climb_limit: float = setting(..., 'Largest commanded climb rate.', 'm/s', 0.01, 2.0)
    climb: PidGains = setting(..., 'PID gains: vertical force (N) per climb rate error (m/s).')


def lift_step(
    gains: ClimbGains, integral: float, error: float, climb: float, missing: float, dt: float
) -> tuple[float, float]:
    """
    Return the vertical force beyond the weight, and the new integral. [N]

    `error` is the altitude setpoint minus the altitude [m], `climb` the upward velocity [m/s],
    and `missing` the delivered minus the demanded force of the last step [N]. The derivative gain
    is not used.
    """
    climb_rate = clamp_symmetric(gains.altitude_kp * error, gains.climb_limit)
    # A measured rate of 0 disables the derivative term
    return pid_step(gains.climb, integral, climb_rate - climb, 0.0, missing, dt)
