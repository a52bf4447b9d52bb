"""
One number for each rotor, in eight slots, as the kernel has them.

A fixed length makes one compiled form serve every vehicle. Slots beyond a vehicle's rotors hold 0
and the cores do not look at them.
"""

from collections.abc import Iterable
from typing import cast

from lta_config.errors import BadInput

SLOTS = 8

PerRotor = tuple[float, float, float, float, float, float, float, float]
NONE: PerRotor = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


def pad_to_slots(values: Iterable[float]) -> PerRotor:
    """
    Return up to eight numbers with zeros behind them.

    Raises
    ------
    BadInput
        If there are more than eight.

    """
    given = tuple(values)
    if len(given) > SLOTS:
        raise BadInput(f'There are {len(given)} rotors, but a vehicle has at most {SLOTS}.')
    return cast('PerRotor', given + NONE[len(given) :])
