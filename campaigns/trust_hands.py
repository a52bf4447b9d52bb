"""A hand that holds the craft, put into a clean flight."""

from lta_data.data_quality.motion import collect_attitudes
from lta_data.data_quality.recording import ChannelRecording
import numpy as np
from numpy.random import Generator
from scipy.spatial.transform import Rotation

from campaigns.trust_case import Array, changed, Corrupted, FORCE, PLACE, SPEED, TRUTH, whole


def hand(time: Array, rng: Generator, tremor: float, carry: float) -> Array:
    """
    Return how a hand moves a craft over a stretch: slow carrying and a tremor. [m]

    Parameters
    ----------
    time : ndarray, shape (n,)
        [s]
    rng : Generator
        Of the path and of the tremor.
    tremor : float
        RMS acceleration of the tremor, all axes together, at a frequency of 7 to 11 Hz that
        wanders by 5 %. [m/s2]
    carry : float
        Size of the carrying, at 0.2 to 0.6 Hz. [m]

    """
    since, length = time - time[0], float(time[-1] - time[0])
    fade = np.clip(np.minimum(since, length - since) / 0.5, 0.0, 1.0) ** 2
    path = np.zeros((len(time), 3))
    for axis in range(3):
        slow = 2.0 * np.pi * rng.uniform(0.2, 0.6) * since + rng.uniform(0.0, 6.0)
        tone = 2.0 * np.pi * rng.uniform(7.0, 11.0)
        wander = np.cumsum(rng.normal(0.0, 0.03, len(time))) * np.sqrt(np.gradient(since) / 0.01)
        size = tremor / np.sqrt(3.0) * np.sqrt(2.0) / tone**2
        path[:, axis] = carry * np.sin(slow) + size * np.sin(tone * since + wander)
    return path * fade[:, None]


def held(flight: ChannelRecording, rng: Generator) -> Corrupted | None:
    """
    A hand holds the craft for 3.5 to 6 s: before, after (rotors idle) or during the flight.

    It carries the craft 0.1 to 0.4 m where rotors are idle, 0.02 m in flight, and trembles there
    by 0.3 to 0.8 m/s2 where there is an IMU, by 1.5 to 3 m/s2 where a tracker alone sees it.
    """
    if f'{PLACE}.x' not in flight.channels:
        return None
    place = flight.channels[f'{PLACE}.x']
    period = float(np.median(np.diff(place.time)))
    inertial, driven = f'{FORCE}.x' in flight.channels, 'motors' in topics_of(flight)
    way = int(rng.integers(3)) if driven else 2
    if way == 2 and not inertial and period > 0.025:
        return None  # nothing could see a tremor
    begin, end = whole(place)
    length = float(rng.uniform(3.5, 6.0))
    start = (
        begin + 0.1
        if way == 0
        else end - length - 0.1
        if way == 1
        else float(rng.uniform(begin + 1.0, end - length - 1.0))
    )
    if way < 2:
        tremor = float(rng.uniform(0.15, 0.6))
    else:
        tremor = float(rng.uniform(0.3, 0.8) if inertial else rng.uniform(1.5, 3.0))
    carry = float(rng.uniform(0.1, 0.4)) if way < 2 else 0.02
    new = moved(flight, start, start + length, rng, tremor, carry)
    if way < 2:
        idle = {}
        for name, channel in flight.channels.items():
            if channel.topic == 'motors':
                inside = (channel.time >= start) & (channel.time <= start + length)
                idle[name] = np.where(inside, 0.0, channel.values)
        new = changed(new, idle)
    word = ('before', 'after', 'during')[way]
    names = (PLACE, FORCE)
    return Corrupted(new, names, start, start + length, f'{word} {tremor:.2f} m/s2 {carry:.2f} m')


def topics_of(flight: ChannelRecording) -> set[str]:
    return {channel.topic for channel in flight.channels.values()}


def moved(
    flight: ChannelRecording, start: float, end: float, rng: Generator, tremor: float, carry: float
) -> ChannelRecording:
    """Return a flight in which a hand moves the craft, in all that feels it."""
    fine = np.arange(start, end, 0.002)
    path = hand(fine, rng, tremor, carry)
    speed = np.gradient(path, 0.002, axis=0)
    pull = np.gradient(speed, 0.002, axis=0)
    new: dict[str, Array] = {}
    for name, table, in_body in (
        (PLACE, path, False), (SPEED, speed, True), (FORCE, pull, True),
    ):  # fmt: skip
        if f'{name}.x' not in flight.channels:
            continue
        time = flight.channels[f'{name}.x'].time
        added = np.stack([np.interp(time, fine, column, 0.0, 0.0) for column in table.T], axis=1)
        if in_body:
            turn = collect_attitudes(flight.channels)[TRUTH]
            at = np.stack([np.interp(time, turn.time, column) for column in turn.values.T], axis=1)
            added = Rotation.from_quat(at).inv().apply(added)
        for index, axis in enumerate('xyz'):
            new[f'{name}.{axis}'] = flight.channels[f'{name}.{axis}'].values + added[:, index]
    return changed(flight, new)
