"""Define a fault detector: condition, minimum duration and name."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import final, NamedTuple

from lta_energy.monitoring.reading import MeterReading
from lta_graph.health import HealthLevel
from lta_model.electrical.battery import BatteryModel

Memory = tuple[float, ...]


class MeterObservation(NamedTuple):
    """
    What a detector looks at.

    Attributes
    ----------
    reading, before : Reading, Reading or None
        The newest turn of the meters and the one before it; None at the first.
    dt : float
        Time between their stamps; 0 at the first, negative where stamps go back. [s]
    cell : Battery
        The cell as its file has it.
    surprise : float
        How many standard deviations the voltage was off what was expected; 0 where nothing was.
    back : float
        By how much the clock was found set back with this reading; 0 where it was not. [s]

    """

    reading: MeterReading
    before: MeterReading | None
    dt: float
    cell: BatteryModel
    surprise: float = 0.0
    back: float = 0.0


@final
@dataclass(frozen=True, slots=True)
class FaultDetector:
    """
    One kind of bad reading.

    Parameters
    ----------
    name : str
        What it is called, in messages and diagnostics.
    sees : callable
        `sees(memory, seen) -> (condition, memory)`.
    says : callable
        `says(seen) -> str`: what is wrong, and what to look at.
    level : Level
        ERROR makes the energy doubtful: the drone comes down and does not take off.
    spoils : bool
        Whether a reading of which the condition holds says nothing of the cell.
    rise, fall : float
        How long it must last to be told, and be absent to be taken back. [s]
    start : tuple of float
        What it remembers before the first reading.

    """

    name: str
    sees: Callable[[Memory, MeterObservation], tuple[bool, Memory]]
    says: Callable[[MeterObservation], str]
    level: HealthLevel
    spoils: bool
    rise: float
    fall: float
    start: Memory = ()
