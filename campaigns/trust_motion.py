# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Corruptions that two ways of knowing a motion give away: axes, frames and clocks."""

from dataclasses import replace

from lta_data.data_quality import roles
from lta_data.data_quality.motion import collect_attitudes
from lta_data.even_grid import hann_kernel, smooth_columns
from lta_data.flight import Flight
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


def judged(flight: Flight) -> list[str]:
    """Return the vectors that have a tracked pose beside them."""
    if f'{TURN}.x' not in flight.channels:
        return []
    return [vector for vector in (SPIN, GYRO, SPEED) if f'{vector}.x' in flight.channels]


def lively(flight: Flight, vector: str) -> list[str]:
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


def quick(flight: Flight, vector: str) -> bool:
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


def throughout(flight: Flight, vector: str) -> bool:
    """Whether a vector does so in each third of the flight: else nothing can wander."""
    total = float(flight.channels[f'{vector}.x'].time[-1])
    thirds = (piece(flight, total * part / 3.0, total * (part + 1) / 3.0) for part in range(3))
    return all(quick(third, vector) for third in thirds)


def axes(flight: Flight, rng: Generator) -> Corrupted | None:
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


def flipped(flight: Flight, rng: Generator) -> Corrupted | None:
    """One axis of a vector that moves has the other sign."""
    choices = [f'{v}.{axis}' for v in judged(flight) for axis in lively(flight, v)]
    if not choices:
        return None
    name = choices[int(rng.integers(len(choices)))]
    new = scaled(flight, [name], -1.0)
    return Corrupted(
        new, (name, roles.vector_name(name)), *whole(flight.channels[name]), f'-{name}'
    )


def swapped(flight: Flight, rng: Generator) -> Corrupted | None:
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


def turned(flight: Flight, quaternions: Array) -> Flight:
    """Return a recording with another attitude."""
    new = {f'{TURN}.{part}': column for part, column in zip('xyzw', quaternions.T, strict=True)}
    told = zip(('yaw', 'pitch', 'roll'), to_euler_angles(quaternions), strict=True)
    return changed(flight, new | {f'{TURN}.{part}': values for part, values in told})


def reread(flight: Flight, rng: Generator) -> Corrupted | None:
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


def in_map(flight: Flight) -> Corrupted | None:
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


def clock(flight: Flight, rng: Generator) -> Corrupted | None:
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


def hand(time: Array, rng: Generator, tremor: float, carry: float) -> Array:
    """
    Return how a hand moves a craft over a stretch: slow carrying and a tremor [m].

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


def held(flight: Flight, rng: Generator) -> Corrupted | None:
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


def topics_of(flight: Flight) -> set[str]:
    return {channel.topic for channel in flight.channels.values()}


def moved(
    flight: Flight, start: float, end: float, rng: Generator, tremor: float, carry: float
) -> Flight:
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
