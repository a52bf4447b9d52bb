"""
Mass matrices: of the rigid body about the hull centre, and of the air around a spheroid.

Rigid body about an origin O that is not its centre of gravity (Fossen 2011, Handbook of Marine
Craft Hydrodynamics and Motion Control, eq. 3.44), with S(a) b = a x b and r the CG seen from O:

    M = | m 1      -m S(r)             |
        | m S(r)   I_cg - m S(r) S(r)  |

Added mass of a spheroid (Lamb 1932, Hydrodynamics, articles 114 and 115), per displaced mass of
air:

    g = abc int_0^inf dl / ((c^2 + l) D),  a + b + g = 2,  k_c = g / (2 - g),
    k' = (b^2 - c^2)^2 (g - b) / (5 (2 (b^2 - c^2) + (b^2 + c^2) (b - g)))

with c the half axis of symmetry and b the radius in the formula of k'.
"""

import math
from typing import Literal

import numpy as np
from numpy.typing import NDArray

Matrix = NDArray[np.float64]
Six = tuple[float, float, float, float, float, float]


def skew_matrix(vector: Matrix) -> Matrix:
    """Return S with S b = vector x b, shape (3, 3)."""
    x, y, z = vector
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def rigid_mass_matrix(mass: float, cg: Matrix, inertia: Matrix) -> Matrix:
    """
    Return the mass matrix of a rigid body about the body origin, shape (6, 6).

    From mass [kg], centre of gravity in the body frame [m], and inertia about it [kg m^2].
    """
    # m S(r), the coupling of translation and rotation
    lever = mass * skew_matrix(cg)
    return np.block(
        [
            [mass * np.eye(3), -lever],
            [lever, inertia - lever @ skew_matrix(cg)],
        ]
    )


def _lamb_series(t: float) -> float:
    """Return sum t^n / (2 n + 3), the ill-conditioned part of Lamb's integral near a sphere."""
    # The closed form cancels near a sphere; 20 terms reach double precision
    if abs(t) < 0.1:
        return sum(t**n / (2 * n + 3) for n in range(20))
    root = math.sqrt(abs(t))
    return ((math.atanh(root) if t > 0 else math.atan(root)) / root - 1.0) / t


def spheroid_added_mass(
    radius: float, half_axis: float, density: float, axis: Literal['x', 'y', 'z'] = 'z'
) -> Six:
    """
    Return added mass along x y z [kg] and added inertia about x y z [kg m^2] of a spheroid.

    In unbounded potential flow: no walls, no separation (Lamb 1932, articles 114 and 115).

    Parameters
    ----------
    radius : float
        Radius of the circular section. [m]
    half_axis : float
        Half length along the axis of symmetry; smaller than the radius is oblate. [m]
    density : float
        Density of the air. [kg/m^3]
    axis : {'x', 'y', 'z'}
        Body axis of symmetry: z for a flat balloon, x for a cigar.

    """
    displaced = density * 4.0 / 3.0 * math.pi * radius**2 * half_axis
    # Negative for an oblate spheroid
    t = 1.0 - (radius / half_axis) ** 2
    along = 2.0 * (1.0 - t) * _lamb_series(t)
    # From a + b + g = 2 with a = b
    across = 1.0 - 0.5 * along
    mass_along = displaced * along / (2.0 - along)
    mass_across = displaced * across / (2.0 - across)
    inertia = 0.0
    # A sphere has no added inertia (0 / 0 in Lamb's formula)
    if radius != half_axis:
        difference, total = radius**2 - half_axis**2, radius**2 + half_axis**2
        below = 2.0 * difference + total * (across - along)
        inertia = displaced * difference**2 * (along - across) / (5.0 * below)
    masses, inertias = [mass_across] * 3, [inertia] * 3
    masses['xyz'.index(axis)] = mass_along
    inertias['xyz'.index(axis)] = 0.0
    return (*masses, *inertias)  # type: ignore[return-value]
