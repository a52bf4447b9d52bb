# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
The photodiodes of a vehicle file: geometry, amplifier and converter.

The defaults are those of an OPT101 and of the Teensy 4.1's converter, or no effect.
"""

import math
from typing import Annotated, Any, Self

from lta_config.files import StrictModel
from lta_config.quantity import Quantity, si_quantity
from pydantic import Field, model_validator

MAX_DIODES = 64  # diodes
LENGTH_TOLERANCE = 1e-3  # tolerance of the length of an axis
Axis = Annotated[list[float], Field(min_length=3, max_length=3)]
DATA_SHEET = 'OPT101 data sheet, SBBS002'


def _default_quantity(value: float, unit: str, source: str) -> Any:
    return Field(default=Quantity(value=value, unit=unit, source=source))


def largest_reading(bits: int, full_scale: float, output_limit: float) -> float:
    """Return the counts at which a converter [V] or the amplifier before it [V] saturates."""
    counts = 2**bits
    return float(min(counts - 1, round(output_limit / full_scale * counts)))


class DiodeAxes(StrictModel):
    """Unit axes of the diodes in the body frame, one per diode."""

    value: Annotated[list[Axis], Field(max_length=MAX_DIODES)]
    source: str

    @model_validator(mode='after')
    def _check_axes(self) -> Self:
        for index, axis in enumerate(self.value):
            length = math.hypot(*axis)
            if not abs(length - 1.0) <= LENGTH_TOLERANCE:  # also true for NaN
                raise ValueError(
                    f'has an axis of length {length:.3g} for the diode {index}, but needs a unit '
                    'vector; divide it by its length'
                )
        return self


class DiodeGains(StrictModel):
    """Gain of each diode, relative to the nominal diode, and where it comes from."""

    value: Annotated[
        list[Annotated[float, Field(gt=0.0, le=10.0)]], Field(min_length=1, max_length=MAX_DIODES)
    ]
    source: str


class PhotodiodesBlock(StrictModel):
    """
    The photodiodes, `radius` out along their axes from a point `height` above the hull centre.

    `feedback` is the resistor of the amplifiers. It is part of the vehicle: light beyond its full
    scale saturates the diodes, in whatever scene. The amplifiers saturate `headroom` below their
    `supply`, the converter at `full_scale`. Without `axes` the diodes are spaced evenly
    around the horizon, the first forward, then counter-clockwise. `gains` are measured gains
    relative to the nominal diode (`lta light calibrate`); the true ones have the relative standard
    deviation `gain_spread` about them.
    """

    count: Annotated[int, Field(ge=1, le=MAX_DIODES)]
    radius: Annotated[Quantity, si_quantity('m', low=0.0, high=20.0, sourced=True)]
    height: Annotated[Quantity, si_quantity('m', low=-5.0, high=5.0, sourced=True)]
    feedback: Annotated[Quantity, si_quantity('ohm', above=0.0, sourced=True)]
    axes: DiodeAxes | None = None
    response: Annotated[Quantity, si_quantity('1', low=0.1, high=20.0, sourced=True)] = (
        _default_quantity(
            1.2,
            '1',
            'assumed: exponent of the cosine, from memory of the plot in the ' + DATA_SHEET,
        )
    )
    response_deviation: Annotated[Quantity, si_quantity('1', low=0.0, high=5.0, sourced=True)] = (
        _default_quantity(
            0.5, '1', 'assumed: exponents of 1 to 2 are possible until it is measured'
        )
    )
    field_of_view: Annotated[
        Quantity, si_quantity('rad', above=0.0, high=math.pi, sourced=True)
    ] = _default_quantity(180.0, 'deg', 'no cover in front of the photodiode')
    gain_spread: Annotated[Quantity, si_quantity('1', low=0.0, high=0.5, sourced=True)] = (
        _default_quantity(0.0, '1', 'equal diodes')
    )
    gains: DiodeGains | None = None
    dead: Annotated[list[Annotated[int, Field(ge=0)]], Field(max_length=MAX_DIODES)] = Field(
        default_factory=list
    )
    bandwidth: Annotated[Quantity, si_quantity('Hz', above=0.0, sourced=True)] = _default_quantity(
        14.0, 'kHz', DATA_SHEET
    )
    noise: Annotated[Quantity, si_quantity('V', low=0.0, high=1.0, sourced=True)] = (
        _default_quantity(300.0, 'uV', DATA_SHEET + ', rms noise with 1 Mohm')
    )
    bits: Annotated[int, Field(ge=1, le=16)] = 12
    full_scale: Annotated[Quantity, si_quantity('V', above=0.0, high=100.0, sourced=True)] = (
        _default_quantity(3.3, 'V', 'Teensy 4.1')
    )
    supply: Annotated[Quantity, si_quantity('V', above=0.0, high=36.0, sourced=True)] = (
        _default_quantity(5.0, 'V', 'assumed: the 5 V rail of the board')
    )
    headroom: Annotated[Quantity, si_quantity('V', low=0.0, high=5.0, sourced=True)] = (
        _default_quantity(1.15, 'V', DATA_SHEET + ', typical: the output ends this far below')
    )
    converter_noise: Annotated[Quantity, si_quantity('1', low=0.0, high=100.0, sourced=True)] = (
        _default_quantity(
            1.0, '1', 'assumed: rms noise in ADC steps; about 10 effective bits of 12'
        )
    )
    clock_error: Annotated[Quantity, si_quantity('1', low=-0.01, high=0.01, sourced=True)] = (
        _default_quantity(0.0, '1', 'no clock error')
    )
    jitter: Annotated[Quantity, si_quantity('s', low=0.0, high=1e-3, sourced=True)] = (
        _default_quantity(0.0, 's', 'no jitter')
    )

    @property
    def output_limit(self) -> float:
        """Highest output of the amplifiers [V]."""
        return self.supply.si - self.headroom.si

    @property
    def largest_reading(self) -> float:
        """Largest reading, at which converter or amplifier saturate [counts]."""
        return largest_reading(self.bits, self.full_scale.si, self.output_limit)

    @model_validator(mode='after')
    def _check_counts(self) -> Self:
        if self.axes is not None and len(self.axes.value) != self.count:
            raise ValueError(
                f'has {len(self.axes.value)} axes for {self.count} diodes; give one for each diode'
            )
        if self.gains is not None and len(self.gains.value) != self.count:
            raise ValueError(
                f'has {len(self.gains.value)} gains for {self.count} diodes; give one for each '
                'diode'
            )
        if not self.output_limit > 0.0:
            raise ValueError(
                f'has a "supply" of {self.supply.si:g} V, of which the amplifier needs '
                f'{self.headroom.si:g} V; give a higher one'
            )
        if strangers := [index for index in self.dead if index >= self.count]:
            raise ValueError(
                f'has the number {strangers[0]} in "dead", but the diodes are numbered from 0 to '
                f'{self.count - 1}; correct the number'
            )
        return self
