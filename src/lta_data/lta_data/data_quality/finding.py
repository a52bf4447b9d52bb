"""What a check says of a recording: a finding with its evidence, or why it cannot judge."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import final, NamedTuple


class Severity(StrEnum):
    """
    How much a finding says against a recording.

    A note is a fact to know; a warning limits what can be concluded from the data, which may be
    sound; what is suspicious is most likely wrong; an error cannot be true.
    """

    NOTE = 'note'
    WARNING = 'warning'
    SUSPICIOUS = 'suspicious'
    ERROR = 'error'


GRAVE = frozenset((Severity.SUSPICIOUS, Severity.ERROR))


@final
@dataclass(frozen=True, slots=True)
class QualityFinding:
    """
    One thing that is not as it should be.

    Attributes
    ----------
    kind : str
        Name of the check in `CHECKS`.
    channel : str
        The channel, or a topic or part of one ('imu/angular_velocity') where all of it is meant.
    from_s, to_s : float
        Where it is, since the start of the flight. [s]
    evidence : str
        One sentence with the figures.
    severity : Severity
        How much it weighs.
    values : mapping of str to float
        The figures of the sentence, SI units.

    """

    kind: str
    channel: str
    from_s: float
    to_s: float
    evidence: str
    severity: Severity
    values: Mapping[str, float] = field(default_factory=dict)

    @property
    def is_grave(self) -> bool:
        """Whether the data should not be used as they are."""
        return self.severity in GRAVE


class CheckVerdict(NamedTuple):
    """What one check found, and a sentence for each thing that it could not judge."""

    findings: tuple[QualityFinding, ...] = ()
    unjudged: tuple[str, ...] = ()


def select_first_findings(findings: Iterable[QualityFinding]) -> tuple[QualityFinding, ...]:
    """Return the first finding of each channel: what follows from it need not be told again."""
    one: dict[str, QualityFinding] = {}
    for finding in findings:
        one.setdefault(finding.channel, finding)
    return tuple(one.values())
