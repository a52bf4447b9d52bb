"""A figure of a benchmark."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
import time

from lta_config.machine import count_cores


@dataclass(frozen=True, slots=True)
class Figure:
    """A figure, and the function that measures it."""

    name: str  # `kind.quantity`
    unit: str  # of its value
    measure: Callable[[], float]  # returns one sample; the first may be slow, as it may compile
    about: str = ''  # what it is, for the table
    # Takes the figure from the samples, and the best of peers: `max` for what should be high,
    # `min` for what should be low
    choose: Callable[[Iterable[float]], float] = max
    of: str = ''  # LTA's figure that this one is the peer's of; '' for LTA's own
    peer: str = ''  # program and version of a peer


def measure_pace(count: float, begin: float) -> float:
    """Return a rate on all cores by the processor time since `begin`. [1/s]"""
    return count * count_cores() / (time.process_time() - begin)
