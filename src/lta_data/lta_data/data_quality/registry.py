"""Register the checks by kind of finding, and run them."""

from dataclasses import dataclass
from typing import Final, final, Protocol

from lta_data.data_quality.checks import (
    axes,
    clocks,
    hand_motion,
    impossible_values,
    noise_floor,
    repeated_values,
    stamps,
    units,
)
from lta_data.data_quality.checks.rereadings import find_rereadings, remove_explained_findings
from lta_data.data_quality.coverage import describe_coverage
from lta_data.data_quality.finding import CheckVerdict, QualityFinding
from lta_data.data_quality.recording import ChannelRecording, CheckContext
from lta_data.data_quality.roles import vector_name
import numpy as np


class QualityCheck(Protocol):
    """
    One check of a recording.

    A check is pure: it changes nothing, reads no file, and reports what it cannot judge.
    """

    def __call__(self, evidence: CheckContext) -> CheckVerdict:
        """Return the findings and what could not be judged."""
        ...


CHECKS: Final[dict[str, QualityCheck]] = {
    repeated_values.CONSTANT: repeated_values.find_constant_channels,
    repeated_values.FROZEN: repeated_values.find_freezes,
    repeated_values.CLIPPED: repeated_values.find_clipping,
    repeated_values.DUPLICATE: repeated_values.find_duplication,
    impossible_values.KIND: impossible_values.find_impossible_values,
    noise_floor.KIND: noise_floor.find_missing_noise,
    units.KIND: units.find_wrong_units,
    axes.KIND: axes.find_axis_errors,
    clocks.KIND: clocks.find_clock_errors,
    stamps.KIND: stamps.find_stamp_errors,
    hand_motion.KIND: hand_motion.find_hand_motion,
}


@final
@dataclass(frozen=True, slots=True)
class QualityReport:
    """Result of all checks of a recording."""

    findings: tuple[QualityFinding, ...]  # by time
    unjudged: tuple[str, ...]  # what could not be judged, and why
    judged: tuple[str, ...] = ()  # quantities, topic by topic

    @property
    def status(self) -> str:
        """'findings', 'clean', or 'not checked' if nothing but notes came of it."""
        if not (self.judged or self.is_grave):
            return 'not checked'
        return 'findings' if self.findings else 'clean'

    @property
    def is_grave(self) -> bool:
        """Whether any finding is suspicious or an error."""
        return any(finding.is_grave for finding in self.findings)


@np.errstate(over='ignore', invalid='ignore', divide='ignore')  # damaged readings may overflow
def run_checks(recording: ChannelRecording) -> QualityReport:
    """Run all checks on a recording."""
    evidence = CheckContext(recording)
    with np.errstate(invalid='ignore'):  # infinity is data: a range without a return
        verdicts = [check(evidence) for check in CHECKS.values()]
        rereadings = find_rereadings(evidence)
        coverage = describe_coverage(evidence)
    findings = [*rereadings, *(one for verdict in verdicts for one in verdict.findings)]
    remaining = sorted(
        [*coverage.missing, *remove_explained_findings(remove_implied_findings(findings))],
        key=lambda finding: (finding.from_s, finding.channel),
    )
    unjudged = [text for verdict in verdicts for text in verdict.unjudged]
    return QualityReport(tuple(remaining), (*coverage.unjudged, *unjudged), coverage.judged)


def remove_implied_findings(findings: list[QualityFinding]) -> list[QualityFinding]:
    """Drop findings that another one explains: a wrong unit also makes values impossible."""
    other_unit = {
        vector_name(finding.channel) for finding in findings if finding.kind == units.KIND
    }
    return [
        finding
        for finding in findings
        if finding.kind != impossible_values.KIND or vector_name(finding.channel) not in other_unit
    ]
