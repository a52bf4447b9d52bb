"""Detect an illuminated panel without voltage (shorted), and a panel that is not measured."""

import math

from lta_energy.faults.detector import FaultDetector, Memory, MeterObservation
from lta_graph.health import HealthLevel

LIGHT = 500.0  # lx; an office
LEAST_VOLTAGE = 0.3  # V; less than half of what one silicon cell gives in that light


def _detect_short(memory: Memory, observation: MeterObservation) -> tuple[bool, Memory]:
    reading = observation.reading
    # NaN (not measured) makes either comparison false
    return reading.illuminance > LIGHT and reading.panel_voltage < LEAST_VOLTAGE, memory


def _describe_short(observation: MeterObservation) -> str:
    reading = observation.reading
    return (
        f'the solar panel has only {reading.panel_voltage:.2f} V at '
        f'{reading.illuminance:.0f} lx: the panel or its charger is short-circuited; check '
        'the wiring'
    )


def _detect_missing_panel(memory: Memory, observation: MeterObservation) -> tuple[bool, Memory]:
    return not math.isfinite(observation.reading.panel_power), memory


def _describe_missing_panel(observation: MeterObservation) -> str:
    return 'the power of the solar panel is not measured and counts as 0 W'


DETECTOR = FaultDetector(
    'panel short',
    _detect_short,
    _describe_short,
    HealthLevel.WARN,
    spoils=False,
    rise=1.0,
    fall=2.0,
)
MISSING = FaultDetector(
    'panel not measured',
    _detect_missing_panel,
    _describe_missing_panel,
    HealthLevel.WARN,
    spoils=False,
    rise=0.0,
    fall=1.0,
)
