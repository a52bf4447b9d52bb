"""Make results valid JSON, which has neither NaN nor infinity."""

from collections.abc import Mapping
import math
from typing import Any


def replace_nonfinite(value: Any) -> Any:  # noqa: ANN401 - what JSON holds
    """Return a nested value with None for all NaN and infinite numbers."""
    if isinstance(value, Mapping):
        return {key: replace_nonfinite(part) for key, part in value.items()}
    if isinstance(value, list | tuple):
        return [replace_nonfinite(part) for part in value]
    # null is the usual replacement of NaN in JSON
    return None if isinstance(value, float) and not math.isfinite(value) else value
