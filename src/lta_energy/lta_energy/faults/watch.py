"""All detectors together: what each remembers, and which faults are on."""

from typing import NamedTuple

from lta_energy.faults import (
    brown_out,
    clock,
    dropout,
    frozen,
    gap,
    implausible,
    not_a_number,
    panel_short,
    reversed_sign,
    set_back,
    swapped,
)
from lta_energy.faults.protocol import Detector, Memory, Seen
from lta_energy.monitoring.latch import Latch, latched
from lta_graph.health import Level

# The order is that in which they are told: what explains others comes first.
DETECTORS: tuple[Detector, ...] = (
    not_a_number.DETECTOR,
    dropout.DETECTOR,
    clock.DETECTOR,
    frozen.DETECTOR,
    implausible.DETECTOR,
    reversed_sign.DETECTOR,
    brown_out.DETECTOR,
    swapped.DETECTOR,
    gap.DETECTOR,
    set_back.DETECTOR,
    panel_short.MISSING,
    panel_short.DETECTOR,
    frozen.PANEL,
)
UNTOUCHED = tuple(detector.start for detector in DETECTORS)
SWAPPED = DETECTORS.index(swapped.DETECTOR)


class Fault(NamedTuple):
    """A fault that is on, and what was said of it when it was last seen."""

    name: str
    level: Level
    sentence: str


class Watch(NamedTuple):
    """
    What all detectors know, in their order.

    Attributes
    ----------
    memories : tuple
        What each remembers.
    latches : tuple of Latch
        Whether each is on.
    seen : tuple of bool
        Whether its condition holds for the newest reading.
    sentences : tuple of str
        What each said when its condition last held.

    """

    memories: tuple[Memory, ...] = UNTOUCHED
    latches: tuple[Latch, ...] = (Latch(),) * len(DETECTORS)
    seen: tuple[bool, ...] = (False,) * len(DETECTORS)
    sentences: tuple[str, ...] = ('',) * len(DETECTORS)

    @property
    def spoilt(self) -> bool:
        """Whether the newest reading says nothing of the cell."""
        return any(
            condition and detector.spoils
            for detector, condition in zip(DETECTORS, self.seen, strict=True)
        )

    @property
    def faults(self) -> tuple[Fault, ...]:
        """The faults that are on."""
        return tuple(
            Fault(detector.name, detector.level, sentence)
            for detector, latch, sentence in zip(
                DETECTORS, self.latches, self.sentences, strict=True
            )
            if latch.on
        )

    @property
    def doubtful(self) -> bool:
        """Whether a fault is on that makes the energy doubtful."""
        return any(
            latch.on and detector.level >= Level.ERROR
            for detector, latch in zip(DETECTORS, self.latches, strict=True)
        )


def watched(watch: Watch, seen: Seen) -> Watch:
    """
    Return what the detectors know after one more reading.

    A reading in which one finds a grave fault surprises nobody further down the list.
    """
    rows = []
    for detector, memory, latch, sentence in zip(
        DETECTORS, watch.memories, watch.latches, watch.sentences, strict=True
    ):
        condition, now = detector.sees(memory, seen)
        kept = latched(latch, condition, max(seen.dt, 0.0), detector.rise, detector.fall)
        rows.append((now, kept, condition, detector.says(seen) if condition else sentence))
        if condition and detector.level >= Level.ERROR:
            seen = seen._replace(surprise=0.0)
    memories, latches, conditions, sentences = zip(*rows, strict=True)
    return Watch(memories, latches, conditions, sentences)
