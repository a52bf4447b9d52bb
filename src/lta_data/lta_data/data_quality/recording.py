# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Represent what the checks say of a flight, and what several of them derive from it."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from functools import cached_property
from typing import final, NamedTuple

from lta_config.errors import BadInput
from lta_config.schema.vehicle_file import VehicleFile
from lta_data.data_quality.motion import (
    collect_inertials,
    collect_motions,
    collect_poses,
    InertialSeries,
    PoseMotion,
    PoseSeries,
)
from lta_data.flight import Flight
from lta_data.scene import parse_provenance_file


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


@final
class CheckContext:
    """A recording with the derived data that several checks use."""

    def __init__(self, recording: Flight) -> None:
        self.recording = recording

    @cached_property
    def poses(self) -> list[PoseSeries]:
        """Topics with the motion of the vehicle, trackers first."""
        return collect_poses(self.recording.channels)

    @cached_property
    def inertials(self) -> list[InertialSeries]:
        """Inertial sensors."""
        return collect_inertials(self.recording.channels)

    @cached_property
    def adc_full_scale(self) -> float | None:
        """Largest reading of the diodes' ADC; None without a vehicle file [counts]."""
        try:
            vehicle = parse_provenance_file(VehicleFile, self.recording.provenance, 'vehicle_file')
        except BadInput:  # file of another version; the other checks still work
            return None
        return vehicle.sensors.diodes.largest_reading if vehicle else None

    @cached_property
    def motions(self) -> list[PoseMotion]:
        """Poses with an attitude, beside the vectors that follow from them."""
        return collect_motions(self.poses, self.inertials)
