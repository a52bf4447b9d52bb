"""
What a vehicle is made of: hull, parts in layers, trim, and what was weighed instead of computed.

Half of the schema of a vehicle file; the other half, and the file itself, is `vehicle_file`.
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

# What each shape of hull needs, and what more it may have.
SHAPES: dict[str, tuple[str, ...]] = {
    'balloon': ('diameter', 'height', 'volume_factor', 'purity'),
    'spheroid': ('diameter', 'length', 'axis', 'purity'),
    'sphere': ('diameter', 'purity'),
    'none': (),
}


class AddedMassBlock(StrictModel):
    """Mass and inertia of the air that moves with the hull, where somebody published them."""

    mass: Annotated[Quantity, si_quantity('kg', low=0.0, high=1000.0, length=3, sourced=True)]
    inertia: Annotated[
        Quantity, si_quantity('kg m2', low=0.0, high=1000.0, length=3, sourced=True)
    ]


class HullBlock(StrictModel):
    """
    The envelope, filled with helium of some purity, and centred at the origin.

    A `balloon` is of revolution about body z: `diameter`, `height`, volume = `volume_factor` r3. A
    `spheroid` is of revolution about `axis`: `diameter` across and `length` along it. A `sphere`
    has a `diameter`. A vehicle that nothing carries has the shape `none`.
    """

    shape: Literal['balloon', 'spheroid', 'sphere', 'none']
    diameter: Length | None = None
    height: Length | None = None
    length: Length | None = None
    axis: Literal['x', 'y', 'z'] | None = None
    volume_factor: Annotated[Quantity, si_quantity('1', above=0.0, sourced=True)] | None = None
    purity: Fraction | None = None
    added_mass: AddedMassBlock | None = None

    @model_validator(mode='after')
    def _check_shape(self) -> 'HullBlock':
        needed = SHAPES[self.shape]
        given = [
            key
            for key in ('diameter', 'height', 'length', 'axis', 'volume_factor', 'purity')
            if getattr(self, key) is not None
        ]
        if missing := [key for key in needed if key not in given]:
            raise ValueError(
                f'has the shape {self.shape}, which needs {", ".join(missing)}; add it'
            )
        if idle := [key for key in given if key not in needed]:
            raise ValueError(
                f'has the shape {self.shape}, which has no {" and no ".join(idle)}; remove it'
            )
        return self


class TrimBlock(StrictModel):
    """
    How much heavier than air the vehicle is flown, and where the ballast for it goes.

    With `heaviness`, ballast at `ballast_position` makes up the difference; where the whole
    vehicle was weighed (`measured`), the hull is filled until it is that heavy. With `ballast:
    none` the vehicle flies as heavy as its parts are.
    """

    heaviness: Annotated[Quantity, si_quantity('kg', low=-0.1, high=1.0, sourced=True)] | None = (
        None
    )
    ballast_position: Place | None = None
    ballast: Literal['none'] | None = None
    unstable: Literal['refused', 'allowed'] = 'refused'


class PartDrag(StrictModel):
    """
    Drag of a part by its faces, 0.5 rho Cd A along each axis, and its damping of turns.

    With `in_aero` the drag of the aero block has the part in it already, and only turns see it.
    """

    coefficient: Annotated[Quantity, si_quantity('1', low=0.0, high=3.0, sourced=True)]
    in_aero: bool = False


class PartBlock(StrictModel):
    """A body with mass, centre and outer size; `shell` is a thin ellipsoid, `box` a solid box."""

    shape: Literal['shell', 'box']
    mass: Mass
    position: Place
    size: Annotated[Quantity, si_quantity('m', above=0.0, length=3, sourced=True)]
    drag: PartDrag | None = None


Layer = Mapping[str, PartBlock]


class MeasuredBlock(StrictModel):
    """
    The vehicle as weighed and swung, gas included, where its parts are not published.

    Parts in layers then have no weight of their own, and a moving mass comes on top.
    """

    mass: Mass
    position: Place  # centre of gravity
    inertia: Annotated[Quantity, si_quantity('kg m2', above=0.0, length=3, sourced=True)]
    # xy xz yz of the tensor, about the centre of gravity as the moments are.
    products: Annotated[Quantity, si_quantity('kg m2', length=3, sourced=True)] | None = None


class MovingMassBlock(StrictModel):
    """A mass that is moved to balance or steer; not among the parts."""

    mass: Mass
    position: Place  # where it is when nothing is commanded
    low: Place
    high: Place
    time_constant: Annotated[Quantity, si_quantity('s', above=0.0, high=100.0, sourced=True)]

    @model_validator(mode='after')
    def _check_travel(self) -> 'MovingMassBlock':
        ends = zip(self.low.vector, self.position.vector, self.high.vector, strict=True)
        if not all(low <= at <= high for low, at, high in ends):
            raise ValueError('starts outside its travel; put position between low and high')
        return self
