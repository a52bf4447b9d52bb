"""Detect a cell voltage or current that is NaN or outside the range of the meter."""

import math

from lta_energy.faults.detector import FaultDetector, Memory, MeterObservation
from lta_graph.health import HealthLevel


def _detect_not_a_number(memory: Memory, observation: MeterObservation) -> tuple[bool, Memory]:
    return not observation.reading.is_usable, memory


def _describe_not_a_number(observation: MeterObservation) -> str:
    reading = observation.reading
    if math.isfinite(reading.voltage) and math.isfinite(reading.current):
        values = f'{reading.voltage:.3g} V and {reading.current:.3g} A'
        # Finite, but beyond `reading.MOST_VOLTS` or `MOST_AMPERES`
        return f'the battery readings of {values} are impossible: check the power meter'
    return 'the measured voltage or current of the battery is not a number: check the power meter'


DETECTOR = FaultDetector(
    'not a number',
    _detect_not_a_number,
    _describe_not_a_number,
    HealthLevel.ERROR,
    spoils=True,
    rise=0.0,
    fall=2.0,
)
