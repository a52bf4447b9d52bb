"""Represent the data of one flight for the checks, with what several of them derive from it."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from functools import cached_property
import re
from typing import Final, final, NamedTuple

from lta_config.errors import BadInput
from lta_config.schema.vehicle_file import VehicleFile
from lta_data.bag.channels import read_all_channels, SignalChannel
from lta_data.bag.columns import extract_stamp
from lta_data.bag.recorded_flight import RecordedFlight
from lta_data.data_quality.motion import (
    collect_inertials,
    collect_motions,
    collect_poses,
    InertialSeries,
    PoseMotion,
    PoseSeries,
)
from lta_data.data_quality.roles import is_instrument_topic
from lta_data.scene import parse_provenance_file
import numpy as np
from numpy.typing import NDArray


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


Array = NDArray[np.float64]
TURNED: Final = re.compile(r'(.*orientation|.*rotation|quaternion)\.yaw$')
FLOWN: Final = ('seed', 'scenario')  # provenance keys that only a simulator writes


@final
@dataclass(frozen=True, slots=True)
class ChannelRecording:
    """The data to check; any subset of topics will do."""

    # By name, as in `lta_data.bag.channels`. A quaternion may be given as yaw, pitch and roll, as
    # x, y, z and w, or as both.
    channels: Mapping[str, SignalChannel]
    provenance: Mapping[str, str] = field(default_factory=dict)  # as stored in the recording
    # Log time of each message by topic, since the topic's first; missing topics are not judged [s]
    arrivals: Mapping[str, Array] = field(default_factory=dict)

    @property
    def is_simulated(self) -> bool:
        """Whether the recording declares itself simulated."""
        provenance = self.provenance
        declared = provenance.get('data')  # set by an import
        return declared == 'simulated' or (
            declared is None and all(map(provenance.__contains__, FLOWN))
        )


def read_recording(flight: RecordedFlight) -> tuple[ChannelRecording, list[str]]:
    """Return a flight for the checks, and what could not be decoded."""
    decoded = read_all_channels(flight)
    channels = dict(decoded.channels)
    topics = dict.fromkeys(channel.topic for channel in decoded.channels.values())
    for topic in topics:
        if is_instrument_topic(topic) or topic == 'odom':
            channels |= read_quaternions(flight, topic, decoded.channels)
    return ChannelRecording(
        channels, flight.provenance, read_log_times(flight, list(topics))
    ), decoded.remarks


def read_log_times(flight: RecordedFlight, topics: list[str]) -> dict[str, Array]:
    """Return the log times of each topic with stamps, since the first of each. [s]"""
    prefix = f'/{flight.robot}/' if flight.robot else '/'
    names = {topic if topic.startswith('/') else prefix + topic: topic for topic in topics}
    times: dict[str, list[int]] = {}
    stamped: dict[str, bool] = {}
    for name, log_time, data in flight.bag.iterate_messages(list(names)):
        if name not in stamped:
            # The first message decides: the type is the same for all
            stamped[name] = extract_stamp(flight.bag.decode(name, data)) is not None
        # Without stamps there is nothing to compare log times with.
        if stamped[name]:
            times.setdefault(names[name], []).append(log_time)
    return {topic: (np.array(rows) - rows[0]) * 1e-9 for topic, rows in times.items()}


def read_quaternions(
    flight: RecordedFlight, topic: str, channels: Mapping[str, SignalChannel]
) -> dict[str, SignalChannel]:
    """Return the raw components of a topic's quaternions, whose channels are Euler angles."""
    paths = [
        match[1]
        for channel in channels.values()
        if channel.topic == topic and (match := TURNED.match(channel.field))
    ]
    quaternions: dict[str, SignalChannel] = {}
    if not paths:
        return quaternions
    series = flight.read_series(topic)
    for path in paths:
        # The angle is NaN where the covariance marks the attitude as unknown
        known_there = np.isfinite(channels[f'{topic}/{path}.yaw'].values)
        if not known_there.any():
            continue  # declared unknown, or never filled in
        for part in 'xyzw':
            values = np.asarray(series[f'{path}.{part}'], dtype=np.float64)
            name = f'{topic}/{path}.{part}'
            masked = np.where(known_there, values, np.nan)
            quaternions[name] = SignalChannel(name, '1', series.time, masked)
    return quaternions


@final
class CheckContext:
    """A recording with the derived data that several checks use."""

    def __init__(self, recording: ChannelRecording) -> None:
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
        """Largest reading of the diodes' ADC; None without a vehicle file. [counts]"""
        try:
            vehicle = parse_provenance_file(VehicleFile, self.recording.provenance, 'vehicle_file')
        except BadInput:  # file of another version; the other checks still work
            return None
        return vehicle.sensors.diodes.largest_reading if vehicle else None

    @cached_property
    def motions(self) -> list[PoseMotion]:
        """Poses with an attitude, beside the vectors that follow from them."""
        return collect_motions(self.poses, self.inertials)
