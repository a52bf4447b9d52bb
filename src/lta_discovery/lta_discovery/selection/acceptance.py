"""Whether a candidate has earned its name: by two flights, each in its own words."""

from typing import Final, final, NamedTuple

GAIN: Final = 11.0  # nats; of the one flight and the better witness of the other together
LARGER: Final = 5.0  # nats; of the better of the two
APART: Final = 5.0  # deviations; by which the two values may differ
PART: Final = 0.1  # of the value; by which they may differ however well each is known
HOLDS: Final = 1.5  # nats; that the first flight's posterior wins on the other
AGAIN: Final = 6.0  # nats; of the other flight by itself, where that posterior does not help
SPOILT: Final = 12.0  # nats; and that the posterior may lose then
TORN: Final = 3.0  # nats; that a candidate may lose on one flight while it wins on the other
TIE: Final = 3.0  # nats; nearer than that, names cannot be told apart
# Typical sizes; what is smaller is not worth a name however well it is known: a wind of less than
# 4 mm/s is a draught.
TRIFLE: Final = 0.04


@final
class CandidateTrial(NamedTuple):
    """
    What two flights say of one candidate.

    Attributes
    ----------
    name : str
        Of the candidate, or of what is tried instead.
    gain : float
        Log evidence that it wins on the first flight, all refitted. [nats]
    replicated : float
        The same on the other flight, by itself.
    held_out : float
        What the first flight's posterior with it wins on the other, against that without it.
    apart : float
        Difference of the two values, in deviations.
    part : float
        The same, as a part of the larger one.

    """

    name: str
    gain: float
    replicated: float
    held_out: float
    apart: float
    part: float

    @property
    def total_evidence(self) -> float:
        """Evidence of both flights, each by itself. [nats]"""
        return self.gain + self.replicated

    @property
    def joint_evidence(self) -> float:
        """Evidence of the other flight after the first one, as one. [nats]"""
        return self.gain + self.held_out

    @property
    def is_contradictory(self) -> bool:
        """Tell whether the flights contradict each other."""
        return min(self.gain, self.replicated) < -TORN and max(self.gain, self.replicated) > LARGER

    @property
    def wins_on_both(self) -> bool:
        """Tell whether it wins on each flight by itself."""
        return min(self.gain, self.replicated) > LARGER

    @property
    def is_accepted(self) -> bool:
        """
        Tell whether it has earned its name.

        Tolerances may swallow most of an effect on the first flight, so that its posterior does
        not help the second: then the second must find it by itself.
        """
        witness = max(self.replicated, self.held_out)
        strong = self.gain + witness > GAIN and max(self.gain, witness) > LARGER
        holds = self.held_out > HOLDS and self.replicated > -TORN
        again = self.replicated > AGAIN and self.held_out > -SPOILT
        agree = self.apart < APART or self.part < PART
        return strong and agree and (holds or again)
