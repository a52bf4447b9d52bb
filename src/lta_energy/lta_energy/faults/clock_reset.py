"""Detect that the clock of the readings was set back; see `monitoring.clock_shift`."""

from lta_energy.faults.detector import FaultDetector, Memory, MeterObservation
from lta_graph.health import HealthLevel


def _detect_clock_reset(memory: Memory, observation: MeterObservation) -> tuple[bool, Memory]:
    return observation.back > 0.0, memory


def _describe_clock_reset(observation: MeterObservation) -> str:
    return (
        f'the clock of the battery readings was set back by {observation.back:.1f} s: '
        'energy used in that time is not counted'
    )


DETECTOR = FaultDetector(
    'set back',
    _detect_clock_reset,
    _describe_clock_reset,
    HealthLevel.WARN,
    spoils=False,
    # The event is visible in one reading only
    rise=0.0,
    fall=5.0,
)
