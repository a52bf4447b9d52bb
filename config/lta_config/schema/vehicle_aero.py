"""
The aero block of a vehicle file: drag along and about the axes, and the rotor columns.

The block may also name a separate file (`aero_file`).
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
    """Drag proportional to the speed."""

    force: Annotated[Quantity, si_quantity('N s/m', low=0.0, length=3, sourced=True)]
    moment: Annotated[Quantity, si_quantity('N m s', low=0.0, length=3, sourced=True)]


class QuadraticDrag(DragCoefficients):
    """Drag proportional to the square of the speed."""

    force: Annotated[Quantity, si_quantity('N s2/m2', low=0.0, length=3, sourced=True)]
    moment: Annotated[Quantity, si_quantity('N m s2', low=0.0, length=3, sourced=True)]


class WrenchPerNewton(StrictModel):
    """Force and moment about the hull centre per newton of thrust."""

    force: Force
    moment: Moment


class RotorColumn(WrenchPerNewton):
    """One column of B; `reverse` is that of reversed thrust, if it differs."""

    reverse: WrenchPerNewton | None = None


class RotorCoupling(WrenchPerNewton):
    """The joint effect of the jets of some rotors, per newton of the weakest of them."""

    rotors: Annotated[list[str], Field(min_length=2)]
    reversed: bool = False  # whether it applies to reversed thrust


class AeroCoefficients(StrictModel):
    """
    Aerodynamic coefficients about the hull centre.

    A rotor without a column in `thrust_allocation` gets it from its position and axis. The motor's
    torque is added in both cases, because a column describes jets without swirl.
    """

    linear_drag: LinearDrag
    quadratic_drag: QuadraticDrag
    thrust_allocation: Mapping[str, RotorColumn] = Field(default_factory=dict)
    coupling: RotorCoupling | None = None
