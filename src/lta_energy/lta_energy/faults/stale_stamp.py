"""Detect readings whose stamps do not advance: an old message is repeated."""

from lta_energy.faults.detector import FaultDetector, Memory, MeterObservation
from lta_graph.health import HealthLevel

REPEATS = 3.0  # a single duplicate is harmless


def _detect_stale_stamp(memory: Memory, observation: MeterObservation) -> tuple[bool, Memory]:
    if observation.before is None or observation.dt > 0.0:
        return False, (0.0,)
    count = memory[0] + 1.0
    return count >= REPEATS, (count,)


def _describe_stale_stamp(observation: MeterObservation) -> str:
    return (
        'the time stamps of the battery messages do not advance: the publisher repeats an old '
        'message'
    )


DETECTOR = FaultDetector(
    'clock',
    _detect_stale_stamp,
    _describe_stale_stamp,
    HealthLevel.ERROR,
    # Such readings never reach the filter, because their stamp is not newer
    spoils=False,
    rise=0.0,
    fall=2.0,
    start=(0.0,),
)
