"""
One number per rotor, in eight slots.

With a fixed length, one compiled form serves every vehicle. Slots beyond a vehicle's rotors hold
0 and are ignored.
"""

from collections.abc import Iterable
from typing import cast

from lta_config.errors import BadInput

SLOTS = 8

PerRotor = tuple[float, float, float, float, float, float, float, float]
NO_ROTORS: PerRotor = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


def pad_to_slots(values: Iterable[float]) -> PerRotor:
    """
    Return up to eight numbers, padded with zeros.

    Raise `BadInput` if there are more than eight.
    """
    numbers = tuple(values)
    if len(numbers) > SLOTS:
        raise BadInput(
            f'The vehicle has {len(numbers)} rotors, but at most {SLOTS} are supported; remove '
            'some from the vehicle file.'
        )
    return cast('PerRotor', numbers + NO_ROTORS[len(numbers) :])
