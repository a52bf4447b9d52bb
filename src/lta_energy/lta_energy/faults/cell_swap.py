"""Detect an exchanged cell: a voltage jump that neither charge nor load explains."""

from lta_energy.faults.detector import FaultDetector, Memory, MeterObservation
from lta_graph.health import HealthLevel

SURPRISE = 5.0  # standard deviations


def _detect_cell_swap(memory: Memory, observation: MeterObservation) -> tuple[bool, Memory]:
    # A hanging current meter makes the voltage look surprising: distrust a repeated current
    now, before = observation.reading, observation.before
    repeats = before is not None and now.current == before.current
    return observation.surprise > SURPRISE and not repeats, memory


def _describe_cell_swap(observation: MeterObservation) -> str:
    return (
        'the battery voltage jumped by more than charge and load can explain: was the '
        'cell replaced? The estimate of the charge starts again'
    )


DETECTOR = FaultDetector(
    'swapped',
    _detect_cell_swap,
    _describe_cell_swap,
    HealthLevel.ERROR,
    spoils=True,
    # Three readings at 10 Hz, so that one outlier does not reset the charge
    rise=0.3,
    fall=10.0,
)
