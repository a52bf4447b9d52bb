"""
Estimate the attitude from gyroscope and accelerometer.

A complementary filter on the rotation group (Mahony, Hamel and Pflimlin 2008,
doi:10.1109/TAC.2008.923738) without its bias estimate, because the bias is measured at rest
before take-off. Gravity corrects roll and pitch. No onboard sensor corrects the heading, which
drifts with the gyroscope.
"""

import math

Quaternion = tuple[float, float, float, float]  # x, y, z, w; body to odom
Vector = tuple[float, float, float]


def up_in_body(q: Quaternion) -> Vector:
    """Return the world's up direction in the body frame."""
    x, y, z, w = q
    return 2.0 * (x * z - w * y), 2.0 * (y * z + w * x), w * w - x * x - y * y + z * z


def yaw_from_quaternion(q: Quaternion) -> float:
    """Return the yaw of a body-to-world quaternion, REP-103. [rad]."""
    x, y, z, w = q
    return math.atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))


def level_quaternion(yaw: float) -> Quaternion:
    """Return the attitude of a level vehicle with a heading. [rad]"""
    return 0.0, 0.0, math.sin(0.5 * yaw), math.cos(0.5 * yaw)


def attitude_step(
    q: Quaternion, rates: Vector, force: Vector, gain: float, dt: float
) -> Quaternion:
    """
    Return the attitude one step later, as a body-to-odom quaternion x, y, z, w.

    `rates` [rad/s] and the specific force `force` [m/s2, +g up at rest] are in the body frame
    with the bias removed. `gain` is the rate at which gravity corrects roll and pitch. [1/s]
    """
    fx, fy, fz = force
    size = math.sqrt(fx * fx + fy * fy + fz * fz)
    ux, uy, uz = up_in_body(q)
    wx, wy, wz = rates
    if size > 0.0:
        # Correction: cross product of measured and estimated up direction.
        # Normalised: only the direction of the specific force counts
        k = gain / size
        wx += k * (fy * uz - fz * uy)
        wy += k * (fz * ux - fx * uz)
        wz += k * (fx * uy - fy * ux)
    x, y, z, w = q
    # Quaternion kinematics q' = q * (w, 0) / 2, one Euler step
    h = 0.5 * dt
    nx = x + h * (w * wx + y * wz - z * wy)
    ny = y + h * (w * wy + z * wx - x * wz)
    nz = z + h * (w * wz + x * wy - y * wx)
    nw = w - h * (x * wx + y * wy + z * wz)
    # Renormalise, since the Euler step leaves the unit sphere.
    norm = math.sqrt(nx * nx + ny * ny + nz * nz + nw * nw)
    return nx / norm, ny / norm, nz / norm, nw / norm
