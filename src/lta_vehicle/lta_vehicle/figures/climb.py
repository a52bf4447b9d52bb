"""
Compute terminal speeds and the time to climb.

Under a constant force F, with the mass M that includes the added mass,

    M v' = F - D1 v - D2 v^2

is integrated by RK4. For D1 = 0 the closed form is t = (M / sqrt(F D2)) acosh(exp(D2 h / M)).
"""

from lta_model.limits import steady_speed

STEP = 0.005  # s; the shortest of these climbs last about 1 s
LONGEST = 600.0  # s; a slower climb is reported as none


def time_to_climb(
    height: float, force: float, mass: float, linear: float, quadratic: float
) -> float | None:
    """
    Return the time to climb a height from rest; None if it exceeds 10 minutes. [s]

    Parameters
    ----------
    height : float
        [m]
    force : float
        Upward thrust minus the carried weight. [N]
    mass : float
        Mass of the vehicle plus its added mass. [kg]
    linear, quadratic : float
        Drag coefficients. [N s/m, N s2/m2]

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
        # Position update of RK4 for a second-order equation whose force depends on the speed only
        rise = STEP * (v + STEP * (a + b + c) / 6.0)
        if z + rise >= height:
            # Interpolate linearly within the last step
            return t + STEP * (height - z) / rise
        z, v, t = z + rise, v + STEP * (a + 2.0 * b + 2.0 * c + d) / 6.0, t + STEP
    return None


def terminal_speed(force: float, linear: float, quadratic: float) -> float | None:
    """Return the speed or rate at which the drag equals a force; None without drag."""
    if linear + quadratic <= 0.0:
        return None
    return steady_speed(force, linear, quadratic) if force > 0.0 else 0.0
