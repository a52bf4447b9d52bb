"""
Compute mass, centre of gravity and inertia of a vehicle from its components.

Everything about the hull centre, body frame. A solid box has 1/12 of the squares of its sizes, a
thin shell between similar ellipsoids 1/3 and a solid ellipsoid 1/5 of those of its half axes. The
film of a foil balloon has 1 % less about the vertical (`test_mass.py`).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import final, Self

from lta_config.schema.vehicle_body import MeasuredMassBlock, PartBlock
import numpy as np
from numpy.typing import NDArray

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
    """Return the gas as a solid ellipsoid in the hull: mass [kg], half axes [m]."""
    # Solid ellipsoid: m (b^2 + c^2) / 5
    squares = np.array(half_axes) ** 2
    gas = mass * np.array(
        [squares[1] + squares[2], squares[0] + squares[2], squares[0] + squares[1]]
    )
    return MassElement(mass, np.zeros(3), gas / 5.0)


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
