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
    """Input of a detector."""

    reading: MeterReading
    before: MeterReading | None  # the previous reading; None at the first
    dt: float  # time between the two stamps; 0 at the first, negative where stamps go back [s]
    cell: BatteryModel  # the cell of the vehicle file
    surprise: float = 0.0  # voltage innovation in standard deviations; 0 without a prediction
    back: float = 0.0  # by how much the clock was set back at this reading; otherwise 0 [s]


@final
@dataclass(frozen=True, slots=True)
class FaultDetector:
    """One kind of faulty reading."""

    name: str  # name in messages and diagnostics
    # `sees(memory, observation) -> (condition, memory)`
    sees: Callable[[Memory, MeterObservation], tuple[bool, Memory]]
    # `says(observation) -> str`: the message, with what to check
    says: Callable[[MeterObservation], str]
    level: HealthLevel  # at ERROR the energy is unreliable: the drone lands and does not take off
    spoils: bool  # whether a reading that fulfils the condition is unusable for the estimate
    # Time that the condition must hold to report the fault, and be absent to clear it [s]
    rise: float
    fall: float
    start: Memory = ()  # memory before the first reading
