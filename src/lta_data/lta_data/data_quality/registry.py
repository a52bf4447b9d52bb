# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Register the checks by kind of finding, and run them."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, final, NamedTuple, Protocol

from lta_data.data_quality import limits, roles
from lta_data.data_quality.checks import (
    clocks,
    hand_motion,
    impossible_values,
    readings,
    repeated_values,
    units,
)
from lta_data.data_quality.checks.clocks import is_regular
from lta_data.data_quality.checks.repeated_values import is_constant
from lta_data.data_quality.checks.rereadings import find_rereadings, remove_explained_findings
from lta_data.data_quality.checks.units import SIZE_RULES
from lta_data.data_quality.recording import CheckContext, CheckVerdict, QualityFinding, Severity
from lta_data.data_quality.roles import COUNT_CHANNELS, RANGES, SPREAD_CHANNELS, vector_name
from lta_data.even_grid import find_coarse_unit
from lta_data.flight import Channel, Flight
from lta_data.interpretation.commands import is_command_topic
import numpy as np

MISSING_KIND: Final = 'missing'
POSE_PARTS: Final = ('position', 'attitude')  # that a model of a vehicle needs
SENSED_PARTS: Final = ('rates', 'force')
RANGE_RULES: Final = (
    *(one.names for one in RANGES),
    *(one.names for one in SIZE_RULES),
    COUNT_CHANNELS,
    SPREAD_CHANNELS,
)
MOVING_QUANTITIES: Final = ('position', 'attitude', 'velocity', 'rates', 'force')
QUANTITY_WORDS: Final = {'turning': 'rates', 'force': 'acceleration'}


@final
class Coverage(NamedTuple):
    """What was judged and what was not, a sentence each, and what was never measured."""

    judged: tuple[str, ...]
    unjudged: tuple[str, ...]
    missing: tuple[QualityFinding, ...]


def describe_coverage(evidence: CheckContext) -> Coverage:
    """Return what the checks of a recording judged."""
    by_topic: dict[str, list[Channel]] = {}
    for channel in evidence.recording.channels.values():
        by_topic.setdefault(channel.topic, []).append(channel)
    sentences: list[str] = []
    unjudged: list[str] = []
    missing: list[QualityFinding] = []
    ruleless: list[str] = []
    least = limits.LEAST_SAMPLES
    for topic, channels in by_topic.items():
        count = len(channels[0].time)
        if count < least:
            unjudged.append(f"'{topic}' is too short: {count} messages, and {least} are needed.")
            continue
        one = _describe_topic(topic, channels)
        sentences += one.judged
        unjudged += one.unjudged
        missing += one.missing
        ruleless += [] if one.judged else [topic]
    if ruleless:
        unjudged.append(f'No rule is there for the numbers of {", ".join(map(repr, ruleless))}.')
    if not by_topic:
        unjudged.append('It has no message whose numbers can be read.')
    placed = any(pose.position is not None for pose in evidence.poses)
    if placed and all(pose.attitude is None for pose in evidence.poses):
        unjudged.append('It has no attitude: frames, axes and rates are not judged.')
    return Coverage(tuple(sentences), tuple(unjudged), tuple(missing))


def _describe_topic(topic: str, channels: Sequence[Channel]) -> Coverage:
    """Return what was judged of a topic with enough messages."""
    measured: dict[str, bool] = {}
    for channel in channels:
        quantity = roles.match_noisy_quantity(channel)
        if roles.QUATERNION_FIELD.match(channel.field) or roles.ANGLE.match(channel.field):
            quantity = 'attitude'
        # An estimate may be constant or smooth, and is a number all the same
        quantity = 'position' if roles.POSITION_PATTERN.match(channel.field) else quantity
        if quantity is None and any(rule.search(channel.name) for rule in RANGE_RULES):
            quantity = 'range of values'
        if quantity is not None:
            finite = bool(np.isfinite(channel.values).any())
            measured[quantity] = measured.get(quantity, False) or finite
    there = [QUANTITY_WORDS.get(name, name) for name, is_there in measured.items() if is_there]
    expected = (
        SENSED_PARTS if 'force' in measured else POSE_PARTS if 'position' in measured else ()
    )
    absent = [name for name in expected if name in measured and not measured[name]]
    # A setpoint has only what is controlled
    absent = [] if is_command_topic(topic) else absent
    time = channels[0].time
    missing = tuple(
        QualityFinding(
            MISSING_KIND, topic, float(time[0]), float(time[-1]),
            f'The {QUANTITY_WORDS.get(name, name)} {"were" if name == "rates" else "was"} never '
            f'measured: none of the {len(time)} messages has a number for it, so nothing that '
            'needs it is judged.',
            Severity.NOTE,
        )
        for name in absent
    )  # fmt: skip
    if not there:
        return Coverage((), (), missing)
    unjudged = []
    if not is_regular(time):
        unjudged.append(f"The stamps of '{topic}' are irregular: lost messages cannot be counted.")
    span = float(np.ptp(time))
    if span < limits.PAIR_TIME and any(name in measured for name in MOVING_QUANTITIES):
        unjudged.append(
            f"'{topic}' is too short to compare motions (units, axes, clocks): {span:.1f} s, and "
            f'{limits.PAIR_TIME:g} s are needed.'
        )
    coarse = [
        f'{channel.field.rpartition(".")[2]} to {unit:.2g} {channel.unit}'.rstrip()
        for channel in channels
        if roles.match_noisy_quantity(channel)
        and (unit := find_coarse_unit(channel.values))
        and not is_constant(channel)
    ]
    if coarse:
        unjudged.append(
            f"'{topic}' is rounded ({', '.join(coarse)}), which hides its noise: equal, extreme "
            'and repeated values of these are not judged.'
        )
    text = f"{', '.join(there)} of '{topic}' ({len(time)} messages)"
    return Coverage((text,), tuple(unjudged), missing)


class QualityCheck(Protocol):
    """
    One check of a recording.

    A check is pure: it changes nothing, reads no file, and reports what it cannot judge.
    """

    def __call__(self, evidence: CheckContext) -> CheckVerdict:
        """Return the findings and what could not be judged."""
        ...


CHECKS: Final[dict[str, QualityCheck]] = {
    repeated_values.CONSTANT_KIND: repeated_values.find_constant_channels,
    repeated_values.FROZEN: repeated_values.find_freezes,
    repeated_values.CLIPPED: repeated_values.find_clipping,
    repeated_values.DUPLICATE: repeated_values.find_duplication,
    impossible_values.KIND: impossible_values.find_impossible_values,
    impossible_values.FILTERED: impossible_values.find_missing_noise,
    units.KIND: units.find_wrong_units,
    readings.KIND: readings.find_axis_errors,
    clocks.KIND: clocks.find_clock_errors,
    clocks.STAMPS: clocks.find_stamp_errors,
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
        """Return 'findings', 'clean', or 'not checked' if nothing but notes came of it."""
        if not (self.judged or self.is_grave):
            return 'not checked'
        return 'findings' if self.findings else 'clean'

    @property
    def is_grave(self) -> bool:
        """Whether any finding is suspicious or an error."""
        return any(finding.is_grave for finding in self.findings)


@np.errstate(over='ignore', invalid='ignore', divide='ignore')  # damaged readings may overflow
def run_checks(recording: Flight) -> QualityReport:
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
