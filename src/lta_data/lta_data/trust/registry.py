"""The checks by the kind of their findings, and how they are put to a recording."""

from dataclasses import dataclass
from typing import Final, final

from lta_data.trust.checks import (
    axes,
    clipped,
    clocks,
    constant,
    duplicated,
    filtered,
    frozen,
    held,
    impossible,
    stamps,
    units,
)
from lta_data.trust.evidence import Evidence
from lta_data.trust.finding import Finding
from lta_data.trust.limits import Limits
from lta_data.trust.protocol import Check
from lta_data.trust.recording import Recording
from lta_data.trust.roles import family
import numpy as np

CHECKS: Final[dict[str, Check]] = {
    constant.KIND: constant.check,
    frozen.KIND: frozen.check,
    clipped.KIND: clipped.check,
    duplicated.KIND: duplicated.check,
    impossible.KIND: impossible.check,
    filtered.KIND: filtered.check,
    units.KIND: units.check,
    axes.KIND: axes.check,
    clocks.KIND: clocks.check,
    stamps.KIND: stamps.check,
    held.KIND: held.check,
}


@final
@dataclass(frozen=True, slots=True)
class Report:
    """
    What the checks say of a recording.

    Attributes
    ----------
    findings : tuple of Finding
        By time.
    unjudged : tuple of str
        What could not be judged, and why.

    """

    findings: tuple[Finding, ...]
    unjudged: tuple[str, ...]

    @property
    def grave(self) -> bool:
        """Whether anything is suspicious or cannot be true."""
        return any(finding.grave for finding in self.findings)


@np.errstate(over='ignore', invalid='ignore', divide='ignore')  # of absurd readings
def checked(recording: Recording, limits: Limits | None = None) -> Report:
    """
    Put every check to a recording.

    Parameters
    ----------
    recording : Recording
        The data; any subset of topics.
    limits : Limits, optional
        Thresholds.

    """
    evidence = Evidence(recording, limits or Limits())
    with np.errstate(invalid='ignore'):  # infinity is data: a range without a return
        verdicts = [check(evidence) for check in CHECKS.values()]
    found = [finding for verdict in verdicts for finding in verdict.findings]
    kept = sorted(without_echoes(found), key=lambda finding: (finding.from_s, finding.channel))
    return Report(tuple(kept), tuple(text for verdict in verdicts for text in verdict.unjudged))


def without_echoes(found: list[Finding]) -> list[Finding]:
    """Leave out what another finding explains: a wrong unit makes values impossible, too."""
    other_unit = {family(finding.channel) for finding in found if finding.kind == units.KIND}
    return [
        finding
        for finding in found
        if finding.kind != impossible.KIND or family(finding.channel) not in other_unit
    ]
