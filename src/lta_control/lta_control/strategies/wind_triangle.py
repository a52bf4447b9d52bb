r"""
Solve the wind triangle: the course through the air that follows a line over the ground.

With the wind w along and across the line, the wanted ground speed g and the highest airspeed V,

.. math::

    a_\perp = -w_\perp, \qquad
    a_\parallel = \min\left(g - w_\parallel, \sqrt{V^2 - a_\perp^2}\right)

Where the cross wind exceeds V, the drone turns into it as far as some speed along the line
remains.
"""

import math

MOST_ACROSS = 0.95  # largest share of the airspeed used against a cross wind
STEERAGE = 0.1  # m/s; below this airspeed a heading is meaningless


def solve_wind_triangle(
    line: tuple[float, float],
    wind: tuple[float, float],
    over_ground: float,
    top_speed: float,
    least: float,
) -> tuple[float, float]:
    """
    Return heading [rad] and airspeed [m/s].

    Parameters
    ----------
    line : tuple of float
        Direction to fly, of any length above 0.
    wind : tuple of float
        Velocity of the air, in the same axes. [m/s]
    over_ground : float
        Wanted speed along the line. [m/s]
    top_speed : float
        Highest airspeed. [m/s]
    least : float
        Least airspeed along the line; negative where the drone may turn around to brake. [m/s]

    """
    away = math.hypot(line[0], line[1])
    cos, sin = line[0] / away, line[1] / away
    along, across = cos * wind[0] + sin * wind[1], cos * wind[1] - sin * wind[0]
    # Cancel the cross wind first; the rest of the airspeed goes along the line.
    left = min(max(-across, -MOST_ACROSS * top_speed), MOST_ACROSS * top_speed)
    # `MOST_ACROSS` below 1 keeps this above zero
    most = math.sqrt(top_speed * top_speed - left * left)
    forward = min(max(over_ground - along, least), most)
    speed = math.hypot(forward, left)
    towards = math.atan2(line[1], line[0])
    if speed < STEERAGE:
        return towards, 0.0
    return towards + math.atan2(left, forward), speed
