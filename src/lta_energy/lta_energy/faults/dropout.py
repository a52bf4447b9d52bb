"""Detect a meter without output: the drone runs, but the cell reads zero volts."""

from lta_energy.faults.detector import FaultDetector, Memory, MeterObservation
from lta_graph.health import HealthLevel

NOTHING = 0.1  # V; no computer runs at such a voltage, so the reading is wrong


def _detect_dropout(memory: Memory, observation: MeterObservation) -> tuple[bool, Memory]:
    return abs(observation.reading.voltage) < NOTHING, memory


def _describe_dropout(observation: MeterObservation) -> str:
    return (
        f'the power meter reads {observation.reading.voltage:.2f} V for the battery cell: '
        'the supply has failed, or a wire of the meter is broken; check the wiring'
    )


DETECTOR = FaultDetector(
    'dropout',
    _detect_dropout,
    _describe_dropout,
    HealthLevel.ERROR,
    spoils=True,
    rise=0.0,
    fall=2.0,
)
