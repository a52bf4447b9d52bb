"""Corruptions that two ways of knowing a motion give away: axes, frames and clocks."""

from dataclasses import replace

from lta_data.data_quality import roles
from lta_data.data_quality.motion import collect_attitudes
from lta_data.data_quality.recording import ChannelRecording
from lta_data.data_quality.smoothing import hann_kernel, smooth_columns
from lta_model.attitude import to_euler_angles
import numpy as np
from numpy.random import Generator
from scipy.spatial.transform import Rotation

from campaigns.trust_case import (
    Array,
    changed,
    Corrupted,
    FORCE,
    GYRO,
    PLACE,
    scaled,
    SPEED,
    SPIN,
    TRUTH,
    TURN,
    whole,
)
from campaigns.trust_flights import piece


def judged(flight: ChannelRecording) -> list[str]:
    """Return the vectors that have a tracked pose beside them."""
    if f'{TURN}.x' not in flight.channels:
        return []
    return [vector for vector in (SPIN, GYRO, SPEED) if f'{vector}.x' in flight.channels]


def lively(flight: ChannelRecording, vector: str) -> list[str]:
    """Return the axes of a vector that move more than its noise."""
    # Of 0.3 s means.
    least = 0.02 if vector in (SPIN, GYRO) else 0.03
    found = []
    for axis in 'xyz':
        values = flight.channels[f'{vector}.{axis}'].values
        calm = np.convolve(values, np.ones(15) / 15.0, mode='valid')
        if float(np.std(calm)) > least:
            found.append(axis)
    return found


def quick(flight: ChannelRecording, vector: str) -> bool:
    """Whether a vector changes within seconds, by 0.01 rad/s or m/s RMS at least in one axis."""
    time = flight.channels[f'{vector}.x'].time
    if len(time) < 200:
        return False
    step = float(np.median(np.diff(time)))
    table = np.stack([flight.channels[f'{vector}.{axis}'].values for axis in 'xyz'], axis=1)
    calm = smooth_columns(table, hann_kernel(0.3, step))
    end = round(1.5 / step)
    changing = (calm - smooth_columns(calm, hann_kernel(3.0, step)))[end:-end]
    return bool(len(changing) and changing.std(axis=0).max() > 0.01)


def throughout(flight: ChannelRecording, vector: str) -> bool:
    """Whether a vector does so in each third of the flight: else nothing can wander."""
    total = float(flight.channels[f'{vector}.x'].time[-1])
    thirds = (piece(flight, total * part / 3.0, total * (part + 1) / 3.0) for part in range(3))
    return all(quick(third, vector) for third in thirds)


def axes(flight: ChannelRecording, rng: Generator) -> Corrupted | None:
    """A sign, two axes, a frame or the order of a quaternion is another throughout."""
    way = int(rng.integers(6))
    if way <= 1:
        return flipped(flight, rng)
    if way == 2:
        return swapped(flight, rng)
    if way == 3:
        return reread(flight, rng)
    if way == 4 and f'{FORCE}.z' in flight.channels:
        new = scaled(flight, [f'{FORCE}.z'], -1.0)
        return Corrupted(new, (FORCE, f'{FORCE}.z'), *whole(flight.channels[f'{FORCE}.z']), '-z')
    return in_map(flight) if way == 5 else None


def flipped(flight: ChannelRecording, rng: Generator) -> Corrupted | None:
    """One axis of a vector that moves has the other sign."""
    choices = [f'{v}.{axis}' for v in judged(flight) for axis in lively(flight, v)]
    if not choices:
        return None
    name = choices[int(rng.integers(len(choices)))]
    new = scaled(flight, [name], -1.0)
    return Corrupted(
        new, (name, roles.vector_name(name)), *whole(flight.channels[name]), f'-{name}'
    )


def swapped(flight: ChannelRecording, rng: Generator) -> Corrupted | None:
    """Two axes of a vector, one of which moves, have changed places."""
    choices = [v for v in judged(flight) if lively(flight, v)]
    if not choices:
        return None
    vector = choices[int(rng.integers(len(choices)))]
    moving = lively(flight, vector)
    first = moving[int(rng.integers(len(moving)))]
    second = str(rng.choice([axis for axis in 'xyz' if axis != first]))
    one, two = (flight.channels[f'{vector}.{axis}'] for axis in (first, second))
    new = changed(flight, {one.name: two.values, two.name: one.values})
    names = (vector, one.name, two.name)
    return Corrupted(new, names, *whole(one), f'{vector} {first}<->{second}')


def turned(flight: ChannelRecording, quaternions: Array) -> ChannelRecording:
    """Return a recording with another attitude."""
    new = {f'{TURN}.{part}': column for part, column in zip('xyzw', quaternions.T, strict=True)}
    told = zip(('yaw', 'pitch', 'roll'), to_euler_angles(quaternions), strict=True)
    return changed(flight, new | {f'{TURN}.{part}': values for part, values in told})


def reread(flight: ChannelRecording, rng: Generator) -> Corrupted | None:
    """The quaternion is the inverse one, or has w first."""
    moving = [v for v in judged(flight) if v != SPEED and lively(flight, v)]
    if not moving:
        return None
    known = np.stack([flight.channels[f'{TURN}.{part}'].values for part in 'xyzw'], axis=1)
    inverse = bool(rng.integers(2))
    other = known * [-1.0, -1.0, -1.0, 1.0] if inverse else np.roll(known, 1, axis=1)
    names = (TURN, SPIN, GYRO, SPEED, PLACE)  # an inverse yaw and a turned sign look alike
    when = whole(flight.channels[f'{TURN}.x'])
    return Corrupted(turned(flight, other), names, *when, 'inverse' if inverse else 'w first')


def in_map(flight: ChannelRecording) -> Corrupted | None:
    """The velocity of an odometry is in the frame of the map."""
    if SPEED not in judged(flight) or not lively(flight, SPEED):
        return None
    turn = collect_attitudes(flight.channels)[TRUTH]
    yaw = to_euler_angles(turn.values).yaw
    known = np.stack([flight.channels[f'{SPEED}.{a}'].values for a in 'xyz'], axis=1)
    # Where the nose keeps to +x the two frames are one.
    if len(turn.values) != len(known) or np.median(np.abs(yaw)) < 0.8:
        return None
    rotated = Rotation.from_quat(turn.values).apply(known)
    new = {f'{SPEED}.{a}': column for a, column in zip('xyz', rotated.T, strict=True)}
    when = whole(flight.channels[f'{SPEED}.x'])
    return Corrupted(changed(flight, new), (SPEED, TURN, PLACE), *when, 'in the map')


def clock(flight: ChannelRecording, rng: Generator) -> Corrupted | None:
    """A vector is 0.08 to 1.5 s late or early against the pose, or wanders by 0.2 to 1 s."""
    choices = [v for v in judged(flight) if quick(flight, v)]
    if not choices:
        return None
    vector = choices[int(rng.integers(len(choices)))]
    channel = flight.channels[f'{vector}.x']
    time = channel.time
    if rng.random() < 0.7 or not throughout(flight, vector):
        late = np.full_like(time, float(np.exp(rng.uniform(np.log(0.08), np.log(1.5)))))
    else:
        late = np.linspace(0.0, float(rng.uniform(0.2, 1.0)), len(time))
    late *= float(rng.choice([-1.0, 1.0]))
    new = dict(flight.channels)
    for axis in 'xyz':
        name = f'{vector}.{axis}'
        values = np.interp(time - late, time, flight.channels[name].values)
        new[name] = replace(flight.channels[name], values=values)
    how = f'{vector} {late[0]:.3f} to {late[-1]:.3f} s'
    most = float(np.abs(late).max())
    inside = piece(replace(flight, channels=new), most, float(time[-1]) - most)
    if not quick(inside, vector):
        return None
    return Corrupted(inside, (vector,), 0.0, float(time[-1]) - 2.0 * most, how)
