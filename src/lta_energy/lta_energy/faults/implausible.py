"""Detect a voltage that no cell of this kind can have."""

from lta_energy.faults.detector import FaultDetector, Memory, MeterObservation
from lta_energy.faults.dropout import NOTHING
from lta_graph.health import HealthLevel

# [V] Below, a LiPo cell is damaged; 0.25 V above full charge it becomes dangerous.
LOWEST, HIGHEST = 2.0, 4.45


def _detect_implausible_voltage(
    memory: Memory, observation: MeterObservation
) -> tuple[bool, Memory]:
    voltage = observation.reading.voltage
    return NOTHING <= abs(voltage) < LOWEST or voltage > HIGHEST, memory


def _describe_implausible_voltage(observation: MeterObservation) -> str:
    return (
        f'the measured battery voltage of {observation.reading.voltage:.2f} V is outside '
        f'the range of a LiPo cell ({LOWEST:g} to {HIGHEST:g} V): check the power meter '
        'and its unit'
    )


DETECTOR = FaultDetector(
    'implausible',
    _detect_implausible_voltage,
    _describe_implausible_voltage,
    HealthLevel.ERROR,
    spoils=True,
    rise=0.3,
    fall=2.0,
)
