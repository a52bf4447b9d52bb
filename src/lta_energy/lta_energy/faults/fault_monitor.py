"""Run all fault detectors and keep their state."""

from typing import NamedTuple

from lta_energy.faults import (
    brown_out,
    cell_swap,
    clock_reset,
    dropout,
    frozen,
    gap,
    implausible,
    not_a_number,
    panel_short,
    reversed_sign,
    stale_stamp,
)
from lta_energy.faults.detector import FaultDetector, Memory, MeterObservation
from lta_energy.monitoring.latch import Latch, update_latch
from lta_graph.health import HealthLevel

# Order of the messages, and of suppression in `update_detectors`: causes before their symptoms
DETECTORS: tuple[FaultDetector, ...] = (
    not_a_number.DETECTOR,
    dropout.DETECTOR,
    stale_stamp.DETECTOR,
    frozen.DETECTOR,
    implausible.DETECTOR,
    reversed_sign.DETECTOR,
    brown_out.DETECTOR,
    cell_swap.DETECTOR,
    gap.DETECTOR,
    clock_reset.DETECTOR,
    panel_short.MISSING,
    panel_short.DETECTOR,
    frozen.PANEL,
)
UNTOUCHED = tuple(detector.start for detector in DETECTORS)
SWAPPED = DETECTORS.index(cell_swap.DETECTOR)


class MeterFault(NamedTuple):
    """An active fault, with the message from the last time that its condition held."""

    name: str
    level: HealthLevel
    sentence: str


class DetectorStates(NamedTuple):
    """
    State of all detectors; every tuple is in the order of `DETECTORS`.

    Attributes
    ----------
    memories : tuple
        Internal state of each detector.
    latches : tuple of Latch
        Whether each fault is active.
    seen : tuple of bool
        Whether each condition holds for the newest reading.
    sentences : tuple of str
        Message from the last time that each condition held.

    """

    memories: tuple[Memory, ...] = UNTOUCHED
    latches: tuple[Latch, ...] = (Latch(),) * len(DETECTORS)
    seen: tuple[bool, ...] = (False,) * len(DETECTORS)
    sentences: tuple[str, ...] = ('',) * len(DETECTORS)

    @property
    def is_unusable(self) -> bool:
        """Whether the newest reading must not be used to estimate the cell."""
        return any(
            condition and detector.spoils
            for detector, condition in zip(DETECTORS, self.seen, strict=True)
        )

    @property
    def faults(self) -> tuple[MeterFault, ...]:
        """The active faults."""
        return tuple(
            MeterFault(detector.name, detector.level, sentence)
            for detector, latch, sentence in zip(
                DETECTORS, self.latches, self.sentences, strict=True
            )
            if latch.on
        )

    @property
    def is_doubtful(self) -> bool:
        """Whether an active fault makes the energy estimate unreliable."""
        return any(
            latch.on and detector.level >= HealthLevel.ERROR
            for detector, latch in zip(DETECTORS, self.latches, strict=True)
        )


def update_detectors(watch: DetectorStates, observation: MeterObservation) -> DetectorStates:
    """Update all detectors with one reading."""
    rows = []
    for detector, memory, latch, sentence in zip(
        DETECTORS, watch.memories, watch.latches, watch.sentences, strict=True
    ):
        condition, now = detector.sees(memory, observation)
        updated = update_latch(
            # Stamps that go back must not shorten the delay of a latch
            latch,
            condition,
            max(observation.dt, 0.0),
            detector.rise,
            detector.fall,
        )
        rows.append(
            (now, updated, condition, detector.says(observation) if condition else sentence)
        )
        # A grave fault explains the voltage: later detectors (cell swap) must not react to it
        if condition and detector.level >= HealthLevel.ERROR:
            observation = observation._replace(surprise=0.0)
    memories, latches, conditions, sentences = zip(*rows, strict=True)
    return DetectorStates(memories, latches, conditions, sentences)
