"""Define findings and verdicts of the checks."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import final, NamedTuple


class Severity(StrEnum):
    """
    How serious a finding is.

    A note is information. A warning limits what the data can show, though they may be correct.
    Suspicious data are most likely wrong. An error is impossible data.
    """

    NOTE = 'note'
    WARNING = 'warning'
    SUSPICIOUS = 'suspicious'
    ERROR = 'error'


GRAVE = frozenset((Severity.SUSPICIOUS, Severity.ERROR))


@final
@dataclass(frozen=True, slots=True)
class QualityFinding:
    """One problem in a recording."""

    kind: str  # name of the check in `CHECKS`
    # The channel, or a topic or part of one ('imu/angular_velocity') if all of it is affected
    channel: str
    # Interval since the start of the flight [s]
    from_s: float
    to_s: float
    evidence: str  # one sentence with the figures
    severity: Severity
    # The figures of the sentence, in SI units
    values: Mapping[str, float] = field(default_factory=dict)

    @property
    def is_grave(self) -> bool:
        """Whether the data should not be used as they are."""
        return self.severity in GRAVE


class CheckVerdict(NamedTuple):
    """Findings of one check, and a sentence for each thing that it could not judge."""

    findings: tuple[QualityFinding, ...] = ()
    unjudged: tuple[str, ...] = ()


def select_first_findings(findings: Iterable[QualityFinding]) -> tuple[QualityFinding, ...]:
    """Return the first finding of each channel; later ones usually follow from it."""
    one: dict[str, QualityFinding] = {}
    for finding in findings:
        one.setdefault(finding.channel, finding)
    return tuple(one.values())
