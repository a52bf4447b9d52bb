# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
The body of a vehicle: hull, parts in layers, trim, and measured mass properties.

The other half of the schema, and the whole file, is in `vehicle_file`.
"""

from collections.abc import Mapping
from typing import Annotated, Literal

from lta_config.files import StrictModel
from lta_config.quantity import Quantity, si_quantity
from pydantic import model_validator

Length = Annotated[Quantity, si_quantity('m', above=0.0, sourced=True)]
Place = Annotated[Quantity, si_quantity('m', low=-20.0, high=20.0, length=3, sourced=True)]
Mass = Annotated[Quantity, si_quantity('kg', above=0.0, high=100.0, sourced=True)]
Fraction = Annotated[Quantity, si_quantity('1', low=0.0, high=1.0, sourced=True)]

# Required keys of each shape of hull
SHAPE_SIZES: dict[str, tuple[str, ...]] = {
    'balloon': ('diameter', 'height', 'volume_factor', 'purity'),
    'spheroid': ('diameter', 'length', 'axis', 'purity'),
    'sphere': ('diameter', 'purity'),
    'none': (),
}


class PublishedAddedMass(StrictModel):
    """Added mass and inertia of the air that moves with the hull, where they are published."""

    mass: Annotated[Quantity, si_quantity('kg', low=0.0, high=1000.0, length=3, sourced=True)]
    inertia: Annotated[
        Quantity, si_quantity('kg m2', low=0.0, high=1000.0, length=3, sourced=True)
    ]


class HullBlock(StrictModel):
    """
    The envelope, filled with helium of some purity, with its centre at the origin.

    A `balloon` has rotational symmetry about body z: `diameter`, `height`, volume =
    `volume_factor` r3. A `spheroid` has it about `axis`: `diameter` across and `length` along it.
    A `sphere` has a `diameter`. A vehicle without buoyancy has the shape `none`.
    """

    shape: Literal['balloon', 'spheroid', 'sphere', 'none']
    diameter: Length | None = None
    height: Length | None = None
    length: Length | None = None
    axis: Literal['x', 'y', 'z'] | None = None
    volume_factor: Annotated[Quantity, si_quantity('1', above=0.0, sourced=True)] | None = None
    purity: Fraction | None = None
    added_mass: PublishedAddedMass | None = None

    @model_validator(mode='after')
    def _check_shape(self) -> 'HullBlock':
        needed = SHAPE_SIZES[self.shape]
        keys = [
            key
            for key in ('diameter', 'height', 'length', 'axis', 'volume_factor', 'purity')
            if getattr(self, key) is not None
        ]
        if missing := [key for key in needed if key not in keys]:
            raise ValueError(
                f'has the shape {self.shape}, but not its keys {", ".join(missing)}; add them'
            )
        # A key that has no effect is probably a mistake
        if idle := [key for key in keys if key not in needed]:
            raise ValueError(
                f'has keys that the shape {self.shape} does not use: {", ".join(idle)}; remove '
                'them'
            )
        return self


class TrimBlock(StrictModel):
    """
    The net weight of the vehicle, and the place of its ballast.

    With `heaviness`, ballast at `ballast_position` makes up the difference. If the whole vehicle
    was weighed (`measured`), the hull is filled until the net weight is reached. With `ballast:
    none` the weight is that of the parts.
    """

    heaviness: Annotated[Quantity, si_quantity('kg', low=-0.1, high=1.0, sourced=True)] | None = (
        None
    )
    ballast_position: Place | None = None
    ballast: Literal['none'] | None = None
    unstable: Literal['refused', 'allowed'] = 'refused'


class PartDrag(StrictModel):
    """
    Drag of a part by its faces, 0.5 rho Cd A along each axis, and its damping of rotations.

    With `in_aero` the aero block already includes the part's drag, and only the damping is added.
    """

    coefficient: Annotated[Quantity, si_quantity('1', low=0.0, high=3.0, sourced=True)]
    in_aero: bool = False


class PartBlock(StrictModel):
    """A body with mass, centre and outer size: `shell` is a thin ellipsoid, `box` a solid box."""

    shape: Literal['shell', 'box']
    mass: Mass
    position: Place
    size: Annotated[Quantity, si_quantity('m', above=0.0, length=3, sourced=True)]
    drag: PartDrag | None = None


Layer = Mapping[str, PartBlock]


class MeasuredMassBlock(StrictModel):
    """
    Measured mass properties of the whole vehicle with its gas, if the parts are unknown.

    Parts in layers then have no weight, and a moving mass is added.
    """

    mass: Mass
    position: Place  # centre of gravity
    inertia: Annotated[Quantity, si_quantity('kg m2', above=0.0, length=3, sourced=True)]
    # xy, xz and yz of the inertia tensor, about the centre of gravity like the moments
    products: Annotated[Quantity, si_quantity('kg m2', length=3, sourced=True)] | None = None


class MovingMassBlock(StrictModel):
    """A mass that moves for balance or steering; not one of the parts."""

    mass: Mass
    position: Place  # without a command
    low: Place
    high: Place
    time_constant: Annotated[Quantity, si_quantity('s', above=0.0, high=100.0, sourced=True)]

    @model_validator(mode='after')
    def _check_travel(self) -> 'MovingMassBlock':
        ends = zip(self.low.vector, self.position.vector, self.high.vector, strict=True)
        if not all(low <= at <= high for low, at, high in ends):
            raise ValueError(
                'has a "position" outside the range from "low" to "high"; correct one of the three'
            )
        return self
