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
    """State of all detectors; every tuple is in the order of `DETECTORS`."""

    memories: tuple[Memory, ...] = UNTOUCHED  # internal state of each detector
    latches: tuple[Latch, ...] = (Latch(),) * len(DETECTORS)  # whether each fault is active
    # Whether each condition holds for the newest reading
    seen: tuple[bool, ...] = (False,) * len(DETECTORS)
    # Message from the last time that each condition held
    sentences: tuple[str, ...] = ('',) * len(DETECTORS)
    faults: tuple[MeterFault, ...] = ()  # the active faults
    is_unusable: bool = False  # whether the newest reading must not be used to estimate the cell
    is_doubtful: bool = False  # whether an active fault makes the energy estimate unreliable


def update_detectors(watch: DetectorStates, observation: MeterObservation) -> DetectorStates:
    """Update all detectors with one reading."""
    memories, seen, sentences = [], [], []
    for detector, before, sentence in zip(DETECTORS, watch.memories, watch.sentences, strict=True):
        condition, memory = detector.sees(before, observation)
        memories.append(memory)
        seen.append(condition)
        sentences.append(detector.says(observation) if condition else sentence)
        # A grave fault explains the voltage: later detectors (cell swap) must not react to it
        if condition and detector.level >= HealthLevel.ERROR:
            observation = observation._replace(surprise=0.0)
    # Stamps that go back must not shorten the delay of a latch
    dt = max(observation.dt, 0.0)
    latches, faults = [], []
    is_unusable = is_doubtful = False
    for detector, latch, condition, sentence in zip(
        DETECTORS, watch.latches, seen, sentences, strict=True
    ):
        updated = update_latch(latch, condition, dt, detector.rise, detector.fall)
        latches.append(updated)
        is_unusable |= condition and detector.spoils
        if updated.on:
            faults.append(MeterFault(detector.name, detector.level, sentence))
            is_doubtful |= detector.level >= HealthLevel.ERROR
    return DetectorStates(
        tuple(memories), tuple(latches), tuple(seen), tuple(sentences), tuple(faults),
        is_unusable, is_doubtful,
    )  # fmt: skip
