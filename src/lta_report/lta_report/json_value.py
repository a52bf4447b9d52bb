"""Make results valid JSON, which has neither NaN nor infinity."""

from collections.abc import Mapping
from dataclasses import asdict, is_dataclass
import math
from typing import Annotated, Any

import numpy as np
from pydantic import BeforeValidator, PlainSerializer

# A field of a stored result that holds an array in single precision, or None
StoredArray = Annotated[
    Any,
    BeforeValidator(lambda value: None if value is None else np.array(value, np.float32)),
    PlainSerializer(lambda value: None if value is None else value.tolist()),
]


def replace_nonfinite(value: Any) -> Any:  # noqa: ANN401 - what JSON holds
    """Return a nested value with None for all NaN and infinite numbers."""
    if isinstance(value, Mapping):
        return {key: replace_nonfinite(part) for key, part in value.items()}
    if isinstance(value, list | tuple):
        return [replace_nonfinite(part) for part in value]
    # null is the usual replacement of NaN in JSON
    return None if isinstance(value, float) and not math.isfinite(value) else value


def to_json_value(value: Any) -> Any:  # noqa: ANN401 - what JSON holds
    """Convert data classes, arrays and NumPy numbers as well, with text as keys."""
    if is_dataclass(value) and not isinstance(value, type):
        value = asdict(value)
    if isinstance(value, np.generic | np.ndarray):
        value = value.tolist()
    if isinstance(value, Mapping):
        return {str(key): to_json_value(part) for key, part in value.items()}
    if isinstance(value, list | tuple):
        return [to_json_value(part) for part in value]
    return replace_nonfinite(value)
