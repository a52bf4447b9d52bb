"""
The photodiodes of a vehicle file: where they sit and look, and how they and their converter read.

What is left out is that of an OPT101 and of the Teensy 4.1's converter, or nothing.
"""

import math
from typing import Annotated, Any, Self

from lta_config.files import Record
from lta_config.quantity import misfit, Quantity, si, UNSOURCED
from pydantic import AfterValidator, Field, model_validator

MOST = 64
UNIT = 1e-3  # by how much the length of an axis may be off 1
Axis = Annotated[list[float], Field(min_length=3, max_length=3)]
DATA_SHEET = 'OPT101 data sheet, SBBS002'


def _given(value: float, unit: str, source: str) -> Any:  # noqa: ANN401 - a default of a field
    return Field(default=Quantity(value=value, unit=unit, source=source))


def _one_or_more(quantity: Quantity) -> Quantity:
    """Return resistors of which one is selected before a flight, the largest first."""
    count = len(quantity.vector)
    if complaint := misfit(quantity, 'ohm', above=0.0, length=max(count, 1)):
        raise ValueError(complaint)
    if not quantity.source:
        raise ValueError(UNSOURCED)
    if list(quantity.vector) != sorted(quantity.vector, reverse=True):
        raise ValueError('lists its resistors in no order; begin with the largest')
    return quantity


class Axes(Record):
    """Unit axes of the diodes in the body frame, one a diode."""

    value: Annotated[list[Axis], Field(max_length=MOST)]
    source: str

    @model_validator(mode='after')
    def _points_somewhere(self) -> Self:
        for index, axis in enumerate(self.value):
            length = math.hypot(*axis)
            if not abs(length - 1.0) <= UNIT:  # also NaN
                raise ValueError(
                    f'has an axis of length {length:.3g} for the diode {index}; divide it by that'
                )
        return self


class Diodes(Record):
    """
    The photodiodes, `radius` out along their axes from a point `height` over the hull centre.

    With several resistors under `feedback` the one is selected that suits the light of the scene.
    Without `axes` they look evenly around the horizon, the first forward, counter-clockwise.
    """

    count: Annotated[int, Field(ge=1, le=MOST)]
    radius: Annotated[Quantity, si('m', low=0.0, high=20.0, sourced=True)]
    height: Annotated[Quantity, si('m', low=-5.0, high=5.0, sourced=True)]
    feedback: Annotated[Quantity, AfterValidator(_one_or_more)]
    axes: Axes | None = None
    response: Annotated[Quantity, si('1', low=0.1, high=20.0, sourced=True)] = _given(
        1.2, '1', 'assumed: exponent of the cosine, from memory of the plot in the ' + DATA_SHEET
    )
    field_of_view: Annotated[Quantity, si('rad', above=0.0, high=math.pi, sourced=True)] = _given(
        180.0, 'deg', 'nothing in front of the package'
    )
    gain_spread: Annotated[Quantity, si('1', low=0.0, high=0.5, sourced=True)] = _given(
        0.0, '1', 'equal diodes'
    )
    dead: Annotated[list[Annotated[int, Field(ge=0)]], Field(max_length=MOST)] = Field(
        default_factory=list
    )
    bandwidth: Annotated[Quantity, si('Hz', above=0.0, sourced=True)] = _given(
        14.0, 'kHz', DATA_SHEET
    )
    noise: Annotated[Quantity, si('V', low=0.0, high=1.0, sourced=True)] = _given(
        300.0, 'uV', DATA_SHEET + ', rms at 1 Mohm'
    )
    bits: Annotated[int, Field(ge=1, le=16)] = 12
    full_scale: Annotated[Quantity, si('V', above=0.0, high=100.0, sourced=True)] = _given(
        3.3, 'V', 'Teensy 4.1'
    )
    converter_noise: Annotated[Quantity, si('1', low=0.0, high=100.0, sourced=True)] = _given(
        1.0, '1', 'assumed: rms, in steps; some 10 effective bits of 12'
    )
    clock_error: Annotated[Quantity, si('1', low=-0.01, high=0.01, sourced=True)] = _given(
        0.0, '1', 'a right clock'
    )
    jitter: Annotated[Quantity, si('s', low=0.0, high=1e-3, sourced=True)] = _given(
        0.0, 's', 'even sampling'
    )

    @property
    def top(self) -> float:
        """Largest reading of the converter. [counts]"""
        return 2.0**self.bits - 1.0

    @model_validator(mode='after')
    def _one_axis_each(self) -> Self:
        if self.axes is not None and len(self.axes.value) != self.count:
            raise ValueError(
                f'has {len(self.axes.value)} axes for {self.count} diodes; give each diode one'
            )
        if strangers := [index for index in self.dead if index >= self.count]:
            raise ValueError(
                f'names the dead diode {strangers[0]}, but has {self.count}, counted from 0; '
                'correct the number'
            )
        return self
