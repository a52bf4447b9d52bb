r"""
The wind triangle: how to fly through the air to go along a line over the ground.

With the wind w along and across the line, the wanted speed over the ground g and the fastest
airspeed V,

.. math::

    a_\perp = -w_\perp, \qquad
    a_\parallel = \min\left(g - w_\parallel, \sqrt{V^2 - a_\perp^2}\right)

Where the wind across is more than V can hold, the drone turns into it as far as leaves it some
speed along the line.
"""

import math

MOST_ACROSS = 0.95  # of the airspeed, against a wind across that is stronger
STEERAGE = 0.1  # m/s of airspeed below which a heading means nothing


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
        Where to go, of any length above 0.
    wind : tuple of float
        Where the air goes to, in the same axes. [m/s]
    over_ground : float
        Wanted speed along the line. [m/s]
    top_speed : float
        Fastest airspeed. [m/s]
    least : float
        Least airspeed along the line; negative where the drone may turn away from it to brake.
        [m/s]

    """
    away = math.hypot(line[0], line[1])
    cos, sin = line[0] / away, line[1] / away
    along, across = cos * wind[0] + sin * wind[1], cos * wind[1] - sin * wind[0]
    left = min(max(-across, -MOST_ACROSS * top_speed), MOST_ACROSS * top_speed)
    most = math.sqrt(top_speed * top_speed - left * left)
    forward = min(max(over_ground - along, least), most)
    speed = math.hypot(forward, left)
    towards = math.atan2(line[1], line[0])
    if speed < STEERAGE:
        return towards, 0.0
    return towards + math.atan2(left, forward), speed
