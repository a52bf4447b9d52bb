"""
Mass, centre of gravity and inertia of a vehicle as the sum of what it consists of.

Everything about the hull centre, body frame. A solid box has 1/12 of the squares of its sizes, a
thin shell between similar ellipsoids 1/3 and a solid ellipsoid 1/5 of those of its half axes.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import final, Self

from lta_config.schema.vehicle_body import Measured, Part
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Three = tuple[float, float, float]


@final
@dataclass(frozen=True, slots=True)
class Lump:
    """A mass with its centre and its inertia about that centre."""

    mass: float  # [kg]
    position: Array  # [m]
    inertia: Array  # diagonal about its own centre [kg m2]


def part_lump(part: Part) -> Lump:
    """Return a part's mass properties: a box is solid, a shell thin and similar to itself."""
    mass = part.mass.si
    squares = np.square(part.size.vector)
    others = np.array([squares[1] + squares[2], squares[0] + squares[2], squares[0] + squares[1]])
    # Solid box 1/12 of full sizes; thin homothetic ellipsoid 1/3 of half axes: the same number.
    return Lump(mass, np.array(part.position.vector), mass * others / 12.0)


def gas_lump(mass: float, half_axes: Three) -> Lump:
    """Return the gas as a solid ellipsoid in the hull: mass [kg], half axes [m]."""
    squares = np.array(half_axes) ** 2
    gas = mass * np.array(
        [squares[1] + squares[2], squares[0] + squares[2], squares[0] + squares[1]]
    )
    return Lump(mass, np.zeros(3), gas / 5.0)


@final
@dataclass(frozen=True, slots=True)
class Balance:
    """
    What a vehicle weighs and how.

    Parameters
    ----------
    mass : float
        Of everything, gas included. [kg]
    cg : ndarray, shape (3,)
        Centre of gravity from the hull centre. [m]
    inertia : ndarray, shape (3, 3)
        About the centre of gravity. [kg m2]

    """

    mass: float
    cg: Array
    inertia: Array

    @classmethod
    def of(cls, lumps: Sequence[Lump]) -> Self:
        """Return the balance of many lumps (Huygens-Steiner)."""
        mass = sum(lump.mass for lump in lumps)
        cg = np.asarray(np.sum([lump.mass * lump.position for lump in lumps], axis=0) / mass)
        total = np.zeros((3, 3))
        for lump in lumps:
            r = lump.position - cg
            total += np.diag(lump.inertia)
            total += lump.mass * (float(r @ r) * np.eye(3) - np.outer(r, r))
        return cls(mass, cg, total)

    @classmethod
    def measured(cls, measured: Measured) -> Self:
        """Return the balance of a vehicle that was weighed and swung as a whole."""
        inertia = np.diag(measured.inertia.vector)
        if measured.products:
            xy, xz, yz = measured.products.vector
            inertia += np.array([[0.0, xy, xz], [xy, 0.0, yz], [xz, yz, 0.0]])
        return cls(measured.mass.si, np.array(measured.position.vector), inertia)

    def with_lump(self, lump: Lump) -> 'Balance':
        """Return the balance with one more mass."""
        mass = self.mass + lump.mass
        cg = (self.mass * self.cg + lump.mass * lump.position) / mass
        total = self.inertia + np.diag(lump.inertia)
        for m, place in ((self.mass, self.cg), (lump.mass, lump.position)):
            r = place - cg
            total = total + m * (float(r @ r) * np.eye(3) - np.outer(r, r))
        return Balance(mass, cg, total)
