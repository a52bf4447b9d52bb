"""Detect a cell below its cut-off voltage, where the electronics may reset at any moment."""

from lta_energy.faults.detector import FaultDetector, Memory, MeterObservation
from lta_energy.faults.dropout import NOTHING
from lta_graph.health import HealthLevel


def _detect_brown_out(memory: Memory, observation: MeterObservation) -> tuple[bool, Memory]:
    # Below `NOTHING` it is a dropout, which has its own detector
    return NOTHING <= observation.reading.voltage <= observation.cell.discharge_cutoff, memory


def _describe_brown_out(observation: MeterObservation) -> str:
    return (
        f'brown-out: the battery cell has {observation.reading.voltage:.2f} V under a load '
        f'of {-observation.reading.current:.2f} A, at or below its cut-off voltage of '
        f'{observation.cell.discharge_cutoff:.2f} V; land and charge it'
    )


DETECTOR = FaultDetector(
    'brown-out',
    _detect_brown_out,
    _describe_brown_out,
    HealthLevel.ERROR,
    # The reading itself is correct and still informs the filter
    spoils=False,
    # Two readings at 10 Hz
    rise=0.2,
    fall=5.0,
)
