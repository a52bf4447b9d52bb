"""
How fast it rises, sinks and turns, and how long it takes to climb.

From rest under a constant force F, with M the mass and the air that rises with it,

    M v' = F - D1 v - D2 v^2

stepped by RK4; with D1 = 0 the closed form is t = (M / sqrt(F D2)) acosh(exp(D2 h / M)).
"""

from lta_model.limits import steady_speed

STEP = 0.005  # s; the shortest of these motions last a second
LONGEST = 600.0  # s


def time_to_climb(
    height: float, force: float, mass: float, linear: float, quadratic: float
) -> float | None:
    """
    Return the time from rest to a height.

    Parameters
    ----------
    height : float
        To climb. [m]
    force : float
        Thrust less what is carried. [N]
    mass : float
        Of the vehicle and the air that moves with it. [kg]
    linear, quadratic : float
        Drag coefficients. [N s/m, N s2/m2]

    Returns
    -------
    float or None
        Time [s]; None if it would take longer than 10 minutes, or never rises.

    """
    if force <= 0.0:
        return None

    def acceleration(speed: float) -> float:
        return (force - (linear + quadratic * abs(speed)) * speed) / mass

    z, v, t = 0.0, 0.0, 0.0
    while t < LONGEST:
        a = acceleration(v)
        b = acceleration(v + 0.5 * STEP * a)
        c = acceleration(v + 0.5 * STEP * b)
        d = acceleration(v + STEP * c)
        rise = STEP * (v + STEP * (a + b + c) / 6.0)
        if z + rise >= height:
            return t + STEP * (height - z) / rise
        z, v, t = z + rise, v + STEP * (a + 2.0 * b + 2.0 * c + d) / 6.0, t + STEP
    return None


def terminal_speed(force: float, linear: float, quadratic: float) -> float | None:
    """Return the speed or rate at which a drag is a force; None where there is no drag."""
    if linear + quadratic <= 0.0:
        return None
    return steady_speed(force, linear, quadratic) if force > 0.0 else 0.0
