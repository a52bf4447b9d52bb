"""
Draw the numbers of a file that are not known well, from the ranges that the file gives them.

A draw is uniform between both ends. Numbers whose ranges have the same `range_source` have the
same cause, and move together, from the first end towards the second.
"""

from collections.abc import Iterator, Mapping
from typing import Any, Final, NamedTuple
import zlib

from lta_config.parameter_override import replace_parameter
import numpy as np

RANGE_SOURCE: Final = 'drawn from its range'


class AssumedNumber(NamedTuple):
    """A number with a range: its dotted path in the file, and the quantity as YAML holds it."""

    path: str
    quantity: Mapping[str, Any]


def list_ranges(content: Any, path: str = '') -> list[AssumedNumber]:  # noqa: ANN401 - what YAML holds
    """Return all numbers of a file that have a range, in the order of the file."""
    return list(_iterate_ranges(content, path))


def _iterate_ranges(content: Any, path: str) -> Iterator[AssumedNumber]:  # noqa: ANN401
    if not isinstance(content, Mapping):
        return
    if 'range' in content and 'unit' in content:
        yield AssumedNumber(path, content)
        return
    for key, below in content.items():
        yield from _iterate_ranges(below, f'{path}.{key}' if path else str(key))


def draw_values(content: Any, seed: int, path: str = '') -> dict[str, dict[str, Any]]:  # noqa: ANN401
    """
    Return drawn values of all numbers of a file that have a range, by path.

    Parameters
    ----------
    content : Any
        The whole file as YAML holds it.
    seed : int
        Number of the draw.
    path : str
        Prefix of the paths, such as 'vehicle'.

    Returns
    -------
    dict
        Quantities as YAML holds them, for `FlightSpec.with_values`.

    """
    return {
        entry.path: {
            'value': draw_between(entry.quantity['range'], entry.quantity['range_source'], seed),
            'unit': entry.quantity['unit'],
            'source': RANGE_SOURCE,
        }
        for entry in list_ranges(content, path)
    }


def draw_content(content: Any, seed: int, root: str) -> Any:  # noqa: ANN401 - what YAML holds
    """Return the content of a file with all numbers that have a range drawn."""
    for path, value in draw_values(content, seed).items():
        content = replace_parameter(content, path, value, root)
    return content


def draw_between(ends: Any, cause: str, seed: int) -> Any:  # noqa: ANN401 - a number or a list
    """Return a number or a list between two ends; equal causes and seeds give equal shares."""
    # CRC-32, because Python's own hash of a text differs between processes
    share = np.random.default_rng([seed, zlib.crc32(cause.encode())]).uniform()
    low, high = (np.asarray(end, dtype=float) for end in ends)
    return (low + share * (high - low)).tolist()
