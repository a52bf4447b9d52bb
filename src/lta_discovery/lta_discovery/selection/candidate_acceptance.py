"""Decide whether a candidate is accepted, from its evidence on two groups of flights."""

from typing import Final, final, NamedTuple

GAIN: Final = 11.0  # nats; training evidence plus the larger confirming evidence
LARGER: Final = 5.0  # nats; of the larger of the two
APART: Final = 5.0  # standard deviations; largest difference of the two values
PART: Final = 0.1  # of the value; a smaller difference is always accepted
HOLDS: Final = 1.5  # nats; gain of the training posterior on the confirming flights
AGAIN: Final = 6.0  # nats; gain of the confirming flights alone, if that posterior does not help
SPOILT: Final = 12.0  # nats; largest loss of that posterior then
TORN: Final = 3.0  # nats; largest loss on one side despite a gain on the other
TIE: Final = 3.0  # nats; candidates closer than this are indistinguishable
# Typical sizes; smaller effects are not named, however significant: a wind of less than
# 4 mm/s is a draught.
TRIFLE: Final = 0.04


@final
class CandidateTrial(NamedTuple):
    """Evidence for one candidate on training and confirming flights."""

    name: str  # of the candidate, or of a generic rival
    gain: float  # gain in log evidence on the training flights, all parameters refitted [nats]
    replicated: float  # the same on the confirming flights alone
    held_out: float  # gain of the training posterior on the confirming flights
    apart: float  # difference of the two values, in standard deviations
    part: float  # the same, relative to the larger value

    @property
    def total_evidence(self) -> float:
        """Evidence of both sides, each alone. [nats]"""
        return self.gain + self.replicated

    @property
    def joint_evidence(self) -> float:
        """Evidence of both sides with common values. [nats]"""
        return self.gain + self.held_out

    @property
    def is_contradictory(self) -> bool:
        """Return whether the two sides contradict each other."""
        # A clear gain on one side and a clear loss on the other, or two values of one constant
        torn = min(self.gain, self.replicated) < -TORN and max(self.gain, self.replicated) > LARGER
        return torn or not self.agrees

    @property
    def agrees(self) -> bool:
        """Return whether both sides have the same value."""
        # Very precise values differ by many deviations, yet only by a few per cent
        return self.apart < APART or self.part < PART

    @property
    def wins_on_both(self) -> bool:
        """Return whether each side alone supports the candidate."""
        return min(self.gain, self.replicated) > LARGER

    @property
    def is_accepted(self) -> bool:
        """
        Return whether the candidate is accepted.

        Tolerances may absorb most of an effect on the training flights, so that their posterior
        does not help the confirming flights. These have to support the effect alone then.
        """
        # Either kind of confirmation is enough
        witness = max(self.replicated, self.held_out)
        strong = self.gain + witness > GAIN and max(self.gain, witness) > LARGER
        holds = self.held_out > HOLDS and self.replicated > -TORN
        again = self.replicated > AGAIN and self.held_out > -SPOILT
        return strong and self.agrees and (holds or again)
