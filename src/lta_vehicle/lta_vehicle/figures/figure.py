# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Define a figure derived from a vehicle file, with its source and inputs."""

from dataclasses import dataclass
import math
from typing import final

MISSING_FIGURE = '\N{EN DASH}'
NEVER = 'none'
LARGE = 1000.0  # from this value on, the next larger unit is shown
LARGER = {'g': 'kg', 'mN': 'N', 'mN m': 'N m', 'g m²': 'kg m²'}


@final
@dataclass(frozen=True, slots=True)
class DerivedFigure:
    """A derived number."""

    key: str  # identifier, used in JSON and in comparisons
    group: str  # heading of the table that shows it
    words: str  # label
    value: float | None  # value in `unit`; None if it does not exist, and `note` gives the reason
    unit: str  # display unit, such as 'g', 'cm' or 'm/s'
    source: str  # rule of the derivation
    rests: tuple[str, ...] = ()  # paths of the inputs in the vehicle file
    digits: int = 1  # number of significant decimals
    note: str = ''  # remark shown with the figure

    @property
    def value_with_unit(self) -> str:
        """Value and unit as text."""
        if self.value is None:
            return MISSING_FIGURE
        # An infinite limit, such as a tumbling speed, means that there is none
        if math.isinf(self.value):
            return NEVER
        value, unit, digits = self.value, self.unit, self.digits
        if abs(value) >= LARGE and unit in LARGER:
            value, unit, digits = value / LARGE, LARGER[unit], 3
        text = f'{value:.{digits}f}'
        # Avoid '-0.0' for values that round to zero
        if float(text) == 0.0:
            text = text.removeprefix('-')
        text = text.replace('-', '\N{MINUS SIGN}')
        # Degrees follow the number without a space; other units with one
        gap = '' if unit.startswith('°') or not unit else ' '
        return f'{text}{gap}{unit}'
