# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Mass, centre of gravity and inertia of a vehicle, and the air that moves with its hull.

Everything about the hull centre, body frame. A solid box has 1/12 of the squares of its sizes, a
thin shell between similar ellipsoids 1/3 and a solid ellipsoid 1/5 of those of its half axes. The
film of a foil balloon has 1 % less about the vertical (`test_mass.py`).

Rigid body about an origin O that is not its centre of gravity (Fossen 2011, Handbook of Marine
Craft Hydrodynamics and Motion Control, eq. 3.44), with S(a) b = a x b and r the CG seen from O:

    M = | m 1      -m S(r)             |
        | m S(r)   I_cg - m S(r) S(r)  |

Added mass of a spheroid (Lamb 1932, Hydrodynamics, articles 114 and 115), per displaced mass of
air:

    g = abc int_0^inf dl / ((c^2 + l) D),  a + b + g = 2,  k_c = g / (2 - g),
    k' = (b^2 - c^2)^2 (g - b) / (5 (2 (b^2 - c^2) + (b^2 + c^2) (b - g)))

with c the half axis of symmetry and b the radius in the formula of k'.

The gas inside is an ideal fluid as well: it does not turn with a hull about its axis of symmetry,
and about another axis only as far as the hull displaces it. In an ellipsoid that turns about x,
with half axes b and c across, the potential is w (b^2 - c^2) / (b^2 + c^2) y z, so that the gas of
mass m adds m (b^2 - c^2)^2 / (5 (b^2 + c^2)) to the inertia (Lamb 1932, article 110). Frozen, it
would have m (b^2 + c^2) / 5. Its boundary layer does turn along: that is the effect
`gas_rotation`.
"""

from collections.abc import Sequence
from dataclasses import dataclass
import math
from typing import final, Literal, Self

from lta_config.constants import HELIUM_TO_AIR
from lta_config.errors import BadInput
from lta_config.quantity import Quantity
from lta_config.schema.vehicle_body import HullBlock, MeasuredMassBlock, PartBlock
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


Array = NDArray[np.float64]
Three = tuple[float, float, float]


@final
@dataclass(frozen=True, slots=True)
class MassElement:
    """A mass with its centre and its inertia about that centre."""

    mass: float  # [kg]
    position: Array  # [m]
    inertia: Array  # diagonal about its own centre [kg m2]


def build_part_element(part: PartBlock) -> MassElement:
    """Return a part's mass properties: a solid box, or a thin shell between similar ellipsoids."""
    mass = part.mass.si
    squares = np.square(part.size.vector)
    others = np.array([squares[1] + squares[2], squares[0] + squares[2], squares[0] + squares[1]])
    # Solid box 1/12 of full sizes; thin homothetic ellipsoid 1/3 of half axes: the same number.
    return MassElement(mass, np.array(part.position.vector), mass * others / 12.0)


def build_gas_element(mass: float, half_axes: Three) -> MassElement:
    """Return the gas as an ideal fluid in an ellipsoid: mass [kg], half axes [m]."""
    squares = np.array(half_axes) ** 2
    b, c = np.roll(squares, -1), np.roll(squares, -2)
    return MassElement(mass, np.zeros(3), mass * (b - c) ** 2 / (5.0 * (b + c)))


def frozen_gas_inertia(mass: float, half_axes: Three) -> Three:
    """
    Return what the gas would have more of inertia if it turned with the hull. [kg m2].

    For a mass [kg] in an ellipsoid of half axes [m]: that of a solid less that of an ideal fluid,
    4 m b^2 c^2 / (5 (b^2 + c^2)).
    """
    squares = np.array(half_axes) ** 2
    b, c = np.roll(squares, -1), np.roll(squares, -2)
    x, y, z = 0.8 * mass * b * c / (b + c)
    return (float(x), float(y), float(z))


@final
@dataclass(frozen=True, slots=True)
class MassProperties:
    """Mass, centre of gravity and inertia of a vehicle."""

    mass: float
    cg: Array
    inertia: Array

    @classmethod
    def from_elements(cls, elements: Sequence[MassElement]) -> Self:
        """Return the properties of several elements together (parallel axis theorem)."""
        mass = sum(lump.mass for lump in elements)
        cg = np.asarray(np.sum([lump.mass * lump.position for lump in elements], axis=0) / mass)
        total = np.zeros((3, 3))
        for lump in elements:
            r = lump.position - cg
            total += np.diag(lump.inertia)
            # Parallel axis theorem
            total += lump.mass * (float(r @ r) * np.eye(3) - np.outer(r, r))
        return cls(mass, cg, total)

    @classmethod
    def from_measurement(cls, measurement: MeasuredMassBlock) -> Self:
        """Return the properties of a vehicle that was weighed and swung as a whole."""
        # Diagonal of the tensor, then its products
        inertia = np.diag(measurement.inertia.vector)
        if measurement.products:
            xy, xz, yz = measurement.products.vector
            inertia += np.array([[0.0, xy, xz], [xy, 0.0, yz], [xz, yz, 0.0]])
        return cls(measurement.mass.si, np.array(measurement.position.vector), inertia)

    def with_element(self, element: MassElement) -> 'MassProperties':
        """Return the properties with one more element."""
        mass = self.mass + element.mass
        cg = (self.mass * self.cg + element.mass * element.position) / mass
        total = self.inertia + np.diag(element.inertia)
        for m, place in ((self.mass, self.cg), (element.mass, element.position)):
            r = place - cg
            total = total + m * (float(r @ r) * np.eye(3) - np.outer(r, r))
        return MassProperties(mass, cg, total)


def _length_or_zero(quantity: Quantity | None) -> float:
    """Return a length validated by the reader; 0 where the shape has none."""
    return 0.0 if quantity is None else quantity.si


def hull_volume(hull: HullBlock) -> float:
    """Return the volume of the hull. [m3]."""
    if hull.shape == 'balloon':
        # Mylar balloon: its volume is a factor times the cube of the flat radius
        return _length_or_zero(hull.volume_factor) * (0.5 * _length_or_zero(hull.diameter)) ** 3
    a, b, c = half_axes(hull)
    return 4.0 / 3.0 * math.pi * a * b * c


def gas_mass(hull: HullBlock, air_density: float) -> float:
    """Return the mass of the gas [kg], in air of a density [kg/m3]."""
    purity = hull.purity.si if hull.purity else 0.0
    # Mixture of helium and air at the same temperature and pressure
    return hull_volume(hull) * air_density * (1.0 - purity * (1.0 - HELIUM_TO_AIR))


def half_axes(hull: HullBlock) -> tuple[float, float, float]:
    """Return half the size along x, y, z; zeros where there is no hull. [m]."""
    radius = 0.5 * _length_or_zero(hull.diameter)
    axes = [radius, radius, radius]
    if hull.shape == 'balloon':
        # A balloon is flat along body z
        axes[2] = 0.5 * _length_or_zero(hull.height)
    elif hull.shape == 'spheroid':
        axes['xyz'.index(hull.axis or 'z')] = 0.5 * _length_or_zero(hull.length)
    return (axes[0], axes[1], axes[2])


def added_mass(hull: HullBlock, air_density: float) -> Six:
    """
    Return the added mass and inertia: as published, or that of a spheroid (Lamb 1932).

    Along x y z [kg] and about x y z [kg m2], for an air density [kg/m3]; published values are
    taken as they are. A balloon counts as the spheroid of its diameter and height.
    """
    if hull.added_mass:
        x, y, z = hull.added_mass.mass.vector
        k, m, n = hull.added_mass.inertia.vector
        return (x, y, z, k, m, n)
    if hull.shape == 'none':
        return (0.0,) * 6
    axis = hull.axis or 'z'
    axes = half_axes(hull)
    # Index - 1 is another axis, and the two others are equal
    along, across = axes['xyz'.index(axis)], axes['xyz'.index(axis) - 1]
    # Beyond these ratios a size is certainly wrong, for example in its unit
    if not 0.01 < along / across < 100.0:
        raise BadInput(
            f'The hull is {2 * along:g} m long and {2 * across:g} m wide, which is '
            'implausible; correct diameter, height or length under hull.'
        )
    return spheroid_added_mass(across, along, air_density, axis)
