"""Detect a gap between readings, during which the charge flow is unknown."""

from lta_energy.faults.detector import FaultDetector, Memory, MeterObservation
from lta_graph.health import HealthLevel

LONGEST = 1.0  # s; ten periods of the meters, as long as the navigator waits by default


def _detect_gap(memory: Memory, observation: MeterObservation) -> tuple[bool, Memory]:
    return observation.dt > LONGEST, memory


def _describe_gap(observation: MeterObservation) -> str:
    return (
        f'no battery reading for more than {LONGEST:g} s: the estimate of the charge is less '
        'certain'
    )


DETECTOR = FaultDetector(
    'gap', _detect_gap, _describe_gap, HealthLevel.WARN, spoils=False, rise=0.0, fall=5.0
)
