"""What the checks look at: the channels of one flight, and where they say they come from."""

from collections.abc import Mapping
from dataclasses import dataclass, field
import re
from typing import Final, final

from lta_data.bag.channels import all_channels, Channel
from lta_data.bag.flight import Flight
from lta_data.bag.stamps import stamp_of
from lta_data.trust.roles import measured_topic
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
TURNED: Final = re.compile(r'(.*orientation|.*rotation|quaternion)\.yaw$')
FLOWN: Final = ('seed', 'scenario')  # what only a simulator can tell of a flight


@final
@dataclass(frozen=True, slots=True)
class Recording:
    """
    The data to judge; any subset of topics will do.

    Attributes
    ----------
    channels : mapping of str to Channel
        By name, as `lta_data.bag.channels` names them. A quaternion may be there as yaw, pitch
        and roll, as x, y, z and w, or as both.
    provenance : mapping of str to str
        What the recording says of its origin.
    arrivals : mapping of str to ndarray
        Log time of each message by topic, on the channels' clock; what is left out is not judged.
        [s]

    """

    channels: Mapping[str, Channel]
    provenance: Mapping[str, str] = field(default_factory=dict)
    arrivals: Mapping[str, Array] = field(default_factory=dict)

    @property
    def simulated(self) -> bool:
        """Whether the recording says that it was simulated."""
        told = self.provenance
        declared = told.get('data')  # what an import says of its source
        return declared == 'simulated' or (declared is None and all(map(told.__contains__, FLOWN)))


def recording_of(flight: Flight) -> tuple[Recording, list[str]]:
    """Return a flight as the checks want it, and what could not be decoded."""
    found = all_channels(flight)
    channels = dict(found.channels)
    topics = dict.fromkeys(channel.topic for channel in found.channels.values())
    for topic in topics:
        if measured_topic(topic) or topic == 'odom':
            channels |= quaternions(flight, topic, found.channels)
    return Recording(channels, flight.provenance, log_times(flight, list(topics))), found.remarks


def log_times(flight: Flight, topics: list[str]) -> dict[str, Array]:
    """Return the log times of each topic with stamps, since the first of each. [s]"""
    prefix = f'/{flight.robot}/' if flight.robot else '/'
    names = {topic if topic.startswith('/') else prefix + topic: topic for topic in topics}
    times: dict[str, list[int]] = {}
    stamped: dict[str, bool] = {}
    for name, log_time, data in flight.bag.messages(list(names)):
        if name not in stamped:
            stamped[name] = stamp_of(flight.bag.decode(name, data)) is not None
        if stamped[name]:
            times.setdefault(names[name], []).append(log_time)
    return {topic: (np.array(rows) - rows[0]) * 1e-9 for topic, rows in times.items()}


def quaternions(flight: Flight, topic: str, known: Mapping[str, Channel]) -> dict[str, Channel]:
    """Return the raw parts of a topic's quaternions, which its channels tell as angles."""
    paths = [
        match[1]
        for channel in known.values()
        if channel.topic == topic and (match := TURNED.match(channel.field))
    ]
    found: dict[str, Channel] = {}
    if not paths:
        return found
    series = flight.series(topic)
    for path in paths:
        known_there = np.isfinite(known[f'{topic}/{path}.yaw'].values)
        if not known_there.any():
            continue  # declared unknown, or never filled in
        for part in 'xyzw':
            values = np.asarray(series[f'{path}.{part}'], dtype=np.float64)
            name = f'{topic}/{path}.{part}'
            kept = np.where(known_there, values, np.nan)
            found[name] = Channel(name, '1', series.time, kept)
    return found
