"""
What a wind tunnel says of a vehicle: drag along and about its axes, and the columns of its rotors.

The aero block of a vehicle file; `aero_file` is a file of its own that such a block may name.
"""

from collections.abc import Mapping
from typing import Annotated

from lta_config.files import StrictModel
from lta_config.quantity import Quantity, si_quantity
from pydantic import Field

Force = Annotated[Quantity, si_quantity('1', low=-1.5, high=1.5, length=3, sourced=True)]
Moment = Annotated[Quantity, si_quantity('m', low=-5.0, high=5.0, length=3, sourced=True)]


class DragCoefficients(StrictModel):
    """Drag coefficients along and about x, y, z."""

    force: Quantity
    moment: Quantity


class LinearDrag(DragCoefficients):
    """Proportional to the speed."""

    force: Annotated[Quantity, si_quantity('N s/m', low=0.0, length=3, sourced=True)]
    moment: Annotated[Quantity, si_quantity('N m s', low=0.0, length=3, sourced=True)]


class QuadraticDrag(DragCoefficients):
    """Proportional to the square of the speed."""

    force: Annotated[Quantity, si_quantity('N s2/m2', low=0.0, length=3, sourced=True)]
    moment: Annotated[Quantity, si_quantity('N m s2', low=0.0, length=3, sourced=True)]


class WrenchPerNewton(StrictModel):
    """Force and moment about the hull centre per newton of thrust."""

    force: Force
    moment: Moment


class RotorColumn(WrenchPerNewton):
    """One column of B; `reverse` is the column of reversed thrust where it is another."""

    reverse: WrenchPerNewton | None = None


class RotorCoupling(WrenchPerNewton):
    """What the jets of some rotors make together, per newton of the weakest of them."""

    rotors: Annotated[list[str], Field(min_length=2)]
    reversed: bool = False  # whether it is their reversed jets that meet


class AeroBlock(StrictModel):
    """
    What a wind tunnel says, about the hull centre.

    A rotor without a column in `thrust_allocation` gets it from its place and axis. The torque of
    its motor comes on top of either: a column is of jets without swirl.
    """

    linear_drag: LinearDrag
    quadratic_drag: QuadraticDrag
    thrust_allocation: Mapping[str, RotorColumn] = Field(default_factory=dict)
    coupling: RotorCoupling | None = None
