"""Altitude, as most of the laws hold it: a climb rate from the error, a force from the rate."""

from lta_config.settings import setting, Settings
from lta_control.cascade import pid_gains
from lta_control.laws.frames import clamp_symmetric
from lta_control.pid import pid_step, PidGains


class ClimbGains(Settings):
    """Gains from altitude to vertical force."""

    altitude_kp: float = setting(
        ..., 'Climb rate asked for each metre below.', unit='1/s', low=0.0, high=10.0
    )
    climb_limit: float = setting(..., 'Largest climb rate.', unit='m/s', low=0.01, high=2.0)
    climb: PidGains = setting(..., 'Climb rate to vertical force, N per m/s.')


def lift_step(
    gains: ClimbGains, integral: float, error: float, climb: float, missing: float, dt: float
) -> tuple[float, float]:
    """
    Return the vertical force beyond the weight, and the new integral.

    Parameters
    ----------
    gains : ClimbGains
        Of both loops; the derivative is not used.
    integral : float
        Of the last step. [N]
    error : float
        Altitude asked for, less where it is. [m]
    climb : float
        Upward velocity. [m/s]
    missing : float
        What the rotors gave beyond the last demand. [N]
    dt : float
        Time since the last step. [s]

    """
    wanted = clamp_symmetric(gains.altitude_kp * error, gains.climb_limit)
    return pid_step(pid_gains(gains.climb), integral, wanted - climb, 0.0, missing, dt)
