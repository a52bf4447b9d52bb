"""One figure that follows from a vehicle file: what, how much, and from what it follows."""

from dataclasses import dataclass
import math
from typing import final

MISSING = '\N{EN DASH}'
NEVER = 'none'
LARGE = 1000.0  # from here on the next unit reads better
LARGER = {'g': 'kg', 'mN': 'N', 'mN m': 'N m', 'g m²': 'kg m²'}


@final
@dataclass(frozen=True, slots=True)
class DerivedFigure:
    """
    A derived number.

    Attributes
    ----------
    key : str
        For scripts and for comparing two vehicles.
    group : str
        Heading under which it stands.
    words : str
        What it is.
    value : float or None
        In `unit`; None where the vehicle has none, and then `note` says why.
    unit : str
        As it is shown: 'g', 'cm', 'm/s'.
    source : str
        By what rule it follows.
    rests : tuple of str
        Places of the file that it rests on, for counting what is assumed of them.
    digits : int
        Decimals that mean something.
    note : str
        What belongs to it.

    """

    key: str
    group: str
    words: str
    value: float | None
    unit: str
    source: str
    rests: tuple[str, ...] = ()
    digits: int = 1
    note: str = ''

    @property
    def text(self) -> str:
        """The number with its unit, as people read it."""
        if self.value is None:
            return MISSING
        if math.isinf(self.value):
            return NEVER
        value, unit, digits = self.value, self.unit, self.digits
        if abs(value) >= LARGE and unit in LARGER:
            value, unit, digits = value / LARGE, LARGER[unit], 3
        text = f'{value:.{digits}f}'
        if float(text) == 0.0:
            text = text.removeprefix('-')
        text = text.replace('-', '\N{MINUS SIGN}')
        gap = '' if unit.startswith('°') or not unit else ' '
        return f'{text}{gap}{unit}'
