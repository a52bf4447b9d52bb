# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Make results valid JSON, which has neither NaN nor infinity."""

from base64 import b64decode, b64encode
from collections.abc import Mapping
from dataclasses import asdict, is_dataclass
import math
from typing import Annotated, Any
import zlib

import numpy as np
from numpy.typing import NDArray
from pydantic import PlainSerializer, PlainValidator


def pack_array(array: NDArray[np.float64]) -> dict[str, Any]:
    """Return an array in double precision as compressed JSON data."""
    data = zlib.compress(np.ascontiguousarray(array, np.float64).tobytes())
    return {'shape': list(array.shape), 'data': b64encode(data).decode()}


def unpack_array(content: Any) -> NDArray[np.float64]:
    """Return the array of `pack_array`; an array as it is."""
    if isinstance(content, np.ndarray):
        return content
    flat = np.frombuffer(zlib.decompress(b64decode(content['data'])))
    return flat.reshape(content['shape'])


# A field of a stored result that holds an array exactly
ExactArray = Annotated[
    NDArray[np.float64], PlainValidator(unpack_array), PlainSerializer(pack_array)
]


def replace_nonfinite(value: Any) -> Any:
    """Return a nested value with None for all NaN and infinite numbers."""
    if isinstance(value, Mapping):
        return {key: replace_nonfinite(part) for key, part in value.items()}
    if isinstance(value, list | tuple):
        return [replace_nonfinite(part) for part in value]
    # null is the usual replacement of NaN in JSON
    return None if isinstance(value, float) and not math.isfinite(value) else value


def to_json_value(value: Any) -> Any:
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
