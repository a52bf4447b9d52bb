"""Define a fault detector: condition, minimum duration and name."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import final, NamedTuple

from lta_energy.monitoring.reading import MeterReading
from lta_graph.health import HealthLevel
from lta_model.electrical.battery import BatteryModel

# Internal state of a detector, whose meaning only that detector knows
Memory = tuple[float, ...]


class MeterObservation(NamedTuple):
    """
    Input of a detector.

    Attributes
    ----------
    before : MeterReading or None
        The previous reading; None at the first.
    dt : float
        Time between the two stamps; 0 at the first, negative where stamps go back. [s]
    cell : BatteryModel
        The cell of the vehicle file.
    surprise : float
        Voltage innovation in standard deviations; 0 without a prediction.
    back : float
        By how much the clock was set back at this reading; otherwise 0. [s]

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
    One kind of faulty reading.

    Parameters
    ----------
    name : str
        Name in messages and diagnostics.
    sees : callable
        `sees(memory, observation) -> (condition, memory)`.
    says : callable
        `says(observation) -> str`: the message, with what to check.
    level : HealthLevel
        At ERROR the energy is unreliable: the drone lands and does not take off.
    spoils : bool
        Whether a reading that fulfils the condition is unusable for the estimate.
    rise, fall : float
        Time that the condition must hold to report the fault, and be absent to clear it. [s]
    start : tuple of float
        Memory before the first reading.

    """

    name: str
    sees: Callable[[Memory, MeterObservation], tuple[bool, Memory]]
    says: Callable[[MeterObservation], str]
    level: HealthLevel
    spoils: bool
    rise: float
    fall: float
    start: Memory = ()
