"""Readings by a clock set back; `lta_energy.monitoring.clock_shift` tells when they are."""

from lta_energy.faults.detector import FaultDetector, Memory, MeterObservation
from lta_graph.health import HealthLevel


def _detect_clock_reset(memory: Memory, observation: MeterObservation) -> tuple[bool, Memory]:
    return observation.back > 0.0, memory


def _describe_clock_reset(observation: MeterObservation) -> str:
    return (
        f'the clock was set back by {observation.back:.1f} s: what flowed just then is not counted'
    )


DETECTOR = FaultDetector(
    'set back',
    _detect_clock_reset,
    _describe_clock_reset,
    HealthLevel.WARN,
    spoils=False,
    rise=0.0,
    fall=5.0,
)
