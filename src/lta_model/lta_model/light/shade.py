"""
Shading of a small source by the vehicle's own hull, seen from a point of the body.

In units of its half axes the hull is a ball, and a ray from p along u meets it if

    D(u) = (p . u)^2 - u^2 (p^2 - 1) > 0   and   p . u < 0.

D over the length of its gradient across u is the angle to the edge of the shade, to first order;
a source of half width w is hidden linearly as it moves from w outside to w inside.
"""

import math

from lta_model.effects.protocol import Vector

# Against the root of a rounding error below zero, and a division by zero
LEAST = 1e-300


def visible_fraction(
    half_axes: Vector, point: Vector, towards: Vector, half_width: float
) -> float:
    """
    Return the share of a small source that a point of the body sees past the hull, 0 to 1.

    Parameters
    ----------
    half_axes : tuple of float
        Of the hull, zeros where there is none. [m]
    point : tuple of float
        Point of view. [m, body]
    towards : tuple of float
        Unit vector to the middle of the source. [body]
    half_width : float
        Half its angular width, above 0. [rad]

    """
    return fraction_past_hull(half_axes, point, towards, half_width) if half_axes[0] > 0.0 else 1.0


def fraction_past_hull(
    half_axes: Vector, point: Vector, towards: Vector, half_width: float
) -> float:
    """Return `visible_fraction` for a vehicle with a hull, without branches."""
    a, b, c = half_axes
    # Scale the ellipsoid to a unit ball
    x, y, z = point[0] / a, point[1] / b, point[2] / c
    i, j, k = towards[0] / a, towards[1] / b, towards[2] / c
    along = x * i + y * j + z * k
    outside = x * x + y * y + z * z - 1.0
    # Discriminant D: positive where the ray hits the hull
    inside = along * along - (i * i + j * j + k * k) * outside
    # Gradient of D with respect to the direction
    p, q, r = (
        2.0 * (along * x - outside * i) / a,
        2.0 * (along * y - outside * j) / b,
        2.0 * (along * z - outside * k) / c,
    )
    ahead = p * towards[0] + q * towards[1] + r * towards[2]
    # Its component perpendicular to the ray
    across = math.sqrt(max(p * p + q * q + r * r - ahead * ahead, LEAST))
    part = min(max(0.5 - 0.5 * inside / (across * half_width), 0.0), 1.0)
    if outside <= 0.0:  # within the hull
        part = 0.0
    # The hull is behind the point
    return 1.0 if along >= 0.0 else part
