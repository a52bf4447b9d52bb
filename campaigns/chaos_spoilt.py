# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Messages that cannot be meant, made from the type of any topic."""

from array import array
from collections.abc import Callable
from copy import deepcopy
import math
from typing import Any, Final

from lta_graph.ros.stamps import from_stamp, to_stamp
import numpy as np

AGE_NS: Final = 100_000_000_000  # by which a stamp is wrong
ODD: Final = 3  # elements of a sequence that should have others
NONSENSE: Final = 'no such thing'


def over_fields(message: Any, change: Callable[[Any], Any]) -> Any:
    """Return a message with every plain value and sequence of it changed, its header kept."""
    for name in message.get_fields_and_field_types():
        value = getattr(message, name)
        if name == 'header':
            continue
        if hasattr(value, 'get_fields_and_field_types'):
            over_fields(value, change)
        elif isinstance(value, list) and value and hasattr(value[0], 'get_fields_and_field_types'):
            for item in value:
                over_fields(item, change)
            if (changed := change(value)) is not value:
                setattr(message, name, changed)
        else:
            setattr(message, name, change(value))
    return message


def nan(value: Any) -> Any:
    """Return NaN for each real number."""
    if isinstance(value, float):
        return math.nan
    if isinstance(value, array) and value.typecode in 'fd':
        return array(value.typecode, [math.nan] * len(value))
    if isinstance(value, np.ndarray) and value.dtype.kind == 'f':
        return np.full_like(value, math.nan)
    return value


def long(value: Any) -> Any:
    """Return a sequence of a wrong length; what has a fixed one keeps it."""
    if isinstance(value, array | list):
        # Parts and numbers of equal length would fit each other: a lamp's peaks at three diodes
        parts = value and hasattr(value[0], 'get_fields_and_field_types')
        odd = ODD - 1 if parts else ODD
        return value[:odd] if len(value) > odd else (value * (odd + 1))[:odd] or value
    return value


def named(value: Any) -> Any:
    """Return nonsense for each text."""
    if isinstance(value, str):
        return NONSENSE
    if isinstance(value, list) and value and isinstance(value[0], str):
        return [NONSENSE] * len(value)
    return value


def stamped(message: Any, by_ns: int) -> Any:
    """Return a message with its stamp moved, not before time 0 [ns]."""
    if hasattr(message, 'header'):
        message.header.stamp = to_stamp(max(0, from_stamp(message.header.stamp) + by_ns))
    return message


SPOILT: Final[dict[str, tuple[str, Callable[[Any], Any]]]] = {
    'nan': ('NaN in every number', lambda message: over_fields(message, nan)),
    'lengths': ('wrong lengths', lambda message: over_fields(message, long)),
    'names': ('wrong names', lambda message: over_fields(message, named)),
    'stale': ('stamps 100 s old', lambda message: stamped(message, -AGE_NS)),
    'future': ('stamps 100 s ahead', lambda message: stamped(message, AGE_NS)),
    'empty': ('no content', lambda message: type(message)()),
}


def spoil(kind: str, message: Any) -> Any:
    """Return a spoilt copy of a message."""
    return SPOILT[kind][1](deepcopy(message))
