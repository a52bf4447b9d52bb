"""What the checks look at: the channels of one flight, and where they say they come from."""

from collections.abc import Mapping
from dataclasses import dataclass, field
import re
from typing import Final, final

from lta_analysis.bag.channels import all_channels, Channel
from lta_analysis.bag.flight import Flight
from lta_analysis.bag.stamps import stamp_of
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
TURNED: Final = re.compile(r'(.*orientation|.*rotation|quaternion)\.yaw$')
SIMULATED: Final = ('seed', 'scenario')  # what only a simulator can tell of a flight


@final
@dataclass(frozen=True, slots=True)
class Recording:
    """
    The data to judge; any subset of topics will do.

    Attributes
    ----------
    channels : mapping of str to Channel
        By name, as `lta_analysis.bag.channels` names them. A quaternion may be there as yaw, pitch
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
        named = told.get('source', '').startswith('simulat')
        return named or all(key in told for key in SIMULATED)


def recording_of(flight: Flight) -> tuple[Recording, list[str]]:
    """Return a flight as the checks want it, and what could not be decoded."""
    found = all_channels(flight)
    channels = dict(found.channels)
    arrivals: dict[str, Array] = {}
    for topic in dict.fromkeys(channel.topic for channel in found.channels.values()):
        stamped = log_times(flight, topic)
        if stamped is not None:
            arrivals[topic] = stamped
        channels |= quaternions(flight, topic, found.channels)
    return Recording(channels, flight.provenance, arrivals), found.remarks


def log_times(flight: Flight, topic: str) -> Array | None:
    """Return the log times of a topic with stamps since the first of them; else None. [s]"""
    name = f'/{flight.robot}/{topic}' if flight.robot and not topic.startswith('/') else topic
    name = name if name.startswith('/') else f'/{name}'
    times: list[int] = []
    for _, log_time, data in flight.bag.messages([name]):
        if not times and stamp_of(flight.bag.decode(name, data)) is None:
            return None
        times.append(log_time)
    return (np.array(times, dtype=np.float64) - times[0]) * 1e-9 if times else None


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
