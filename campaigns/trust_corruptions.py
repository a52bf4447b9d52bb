# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
What can be wrong with a recording, done to a clean one: size, channel and interval by chance.

A corruption returns the changed recording and what a check should name, or None where the flight
has nothing that it could be done to (no IMU, no range, a craft that hardly moves). The least sizes
are those of docs/trust.md.
"""

from collections.abc import Callable
from dataclasses import replace
from typing import Final

from lta_config.constants import STANDARD_GRAVITY
from lta_data.data_quality import roles
from lta_data.flight import Channel, Flight
import numpy as np
from numpy.random import Generator
from scipy.signal import butter, sosfiltfilt

from campaigns.trust_case import (
    Array,
    changed,
    Corrupted,
    Corruption,
    FORCE,
    GYRO,
    over,
    PLACE,
    scaled,
    span,
    SPEED,
    SPIN,
    TURN,
    whole,
)
from campaigns.trust_flights import piece
from campaigns.trust_motion import axes, clock, held


def restless(flight: Flight) -> list[Channel]:
    """Return the channels of instruments that never rest and that move in this flight."""
    return [
        c
        for c in flight.channels.values()
        if roles.match_noisy_quantity(c) and len(c.values) > 100 and len(np.unique(c.values)) > 40
    ]


def pick(rng: Generator, some: list[Channel]) -> Channel | None:
    """Draw a channel."""
    return some[int(rng.integers(len(some)))] if some else None


def constant(flight: Flight, rng: Generator) -> Corrupted | None:
    """One channel has its first value throughout."""
    channel = pick(rng, restless(flight))
    if channel is None:
        return None
    values = np.full_like(channel.values, channel.values[len(channel.values) // 2])
    new = changed(flight, {channel.name: values})
    return Corrupted(new, (channel.name,), *whole(channel), f'{channel.name} constant')


def frozen(flight: Flight, rng: Generator) -> Corrupted | None:
    """One channel, or a whole vector, stands still for 0.4 to 5 s in flight."""
    channel = pick(rng, restless(flight))
    if channel is None:
        return None
    low, high = span(rng, channel, 0.4, 5.0)
    high = max(high, low + 10)
    family = roles.vector_name(channel.name)
    names = [channel.name]
    if rng.random() < 0.3:
        names = [n for n, c in flight.channels.items() if roles.vector_name(n) == family]
    new = {}
    for name in names:
        values = flight.channels[name].values.copy()
        values[low:high] = values[low]
        new[name] = values
    when = over(channel, low, high)
    return Corrupted(changed(flight, new), tuple(names), *when, f'{len(names)} {family} frozen')


def clipped(flight: Flight, rng: Generator) -> Corrupted | None:
    """One channel is cut off so that 2 to 20 % of its readings, 15 at least, are at the limit."""
    if rng.random() < 0.2 and 'photodiodes/max[0]' in flight.channels:
        channel = flight.channels[f'photodiodes/max[{int(rng.integers(4))}]']
        low, high = span(rng, channel, 0.6, 5.0)
        values = channel.values.copy()
        values[low:high] = 4095.0
        new = changed(flight, {channel.name: values})
        return Corrupted(new, (channel.name,), *over(channel, low, high), 'converter railed')
    channel = pick(rng, restless(flight))
    if channel is None:
        return None
    share = max(float(rng.uniform(0.02, 0.2)), 15.0 / len(channel.values))
    bottom, top = np.quantile(channel.values, [share, 1.0 - share])
    side = int(rng.integers(3))
    low, high = (-np.inf, top) if side == 0 else (bottom, np.inf) if side == 1 else (bottom, top)
    values = np.clip(channel.values, low, high)
    when = channel.time[values != channel.values]
    new = changed(flight, {channel.name: values})
    how = f'{channel.name} {100 * share:.0f} %'
    return Corrupted(new, (channel.name,), float(when[0]), float(when[-1]), how)


def duplicate(flight: Flight, rng: Generator) -> Corrupted | None:
    """A stretch of 0.5 to 5 s of a topic, 20 readings at least, is there a second time."""
    channel = pick(rng, restless(flight))
    if channel is None:
        return None
    low, high = span(rng, channel, 0.5, 5.0)
    count = max(20, high - low)
    source = int(rng.integers(0, len(channel.values) - count))
    target = int(rng.integers(0, len(channel.values) - count))
    if abs(source - target) < count:
        return None
    names = [n for n, c in flight.channels.items() if c.topic == channel.topic
             and len(c.values) == len(channel.values)]  # fmt: skip
    new = {}
    for name in names:
        values = flight.channels[name].values.copy()
        values[target : target + count] = flight.channels[name].values[source : source + count]
        new[name] = values
    later = max(source, target)  # nobody can tell which of the two was first
    when = over(channel, later, later + count)
    return Corrupted(changed(flight, new), tuple(names), *when, f'{channel.topic} {count} twice')


def impossible(flight: Flight, rng: Generator) -> Corrupted | None:
    """Values that cannot be: one kind of ten, in one sample up to a second of them."""
    kind = int(rng.integers(len(IMPOSSIBLE)))
    names, make = IMPOSSIBLE[kind]
    there = [name for name in names if name in flight.channels]
    if not there:
        return None
    name = there[int(rng.integers(len(there)))]
    channel = flight.channels[name]
    if len(channel.time) < 60:
        return None
    low, high = span(rng, channel, 0.01, 1.0)
    values = channel.values.copy()
    values[low:high] = make(values[low:high], rng)
    new = {name: values}
    if name.startswith(TURN):
        factor = float(rng.choice([0.5, 0.9, 1.05, 1.5]))
        new = {}
        for part in 'xyzw':
            column = flight.channels[f'{TURN}.{part}'].values.copy()
            column[low:high] *= factor
            new[f'{TURN}.{part}'] = column
    return Corrupted(changed(flight, new), (name, roles.vector_name(name)),
                     *over(channel, low, high),
                     f'{name} {make(np.array([1.0]), rng)[0]:.3g}')  # fmt: skip


def _put(*choices: float) -> Callable[[Array, Generator], Array]:
    return lambda old, rng: np.full_like(old, float(rng.choice(choices)))


MOVING: Final = tuple(f'{v}.{a}' for v in (PLACE, SPEED, SPIN, GYRO, FORCE) for a in 'xyz')
IMPOSSIBLE: Final = (
    (MOVING, _put(np.nan)),
    (MOVING, _put(np.inf, -np.inf)),
    ((f'{TURN}.w',), _put(1.0)),
    (('range/range',), _put(-0.01, -1.0)),
    (('illuminance/illuminance',), _put(-1.0, 3e5)),
    (('battery/voltage',), _put(0.0, 2.3, 4.6, 70.0)),
    (('motors/effort.up_left', 'motors/effort.m1', 'motors/effort.forward_left'), _put(1.1, -2.0)),
    (('photodiodes/max[0]',), _put(4096.0, 65535.0)),
    (('pressure/fluid_pressure',), _put(0.0, 2e5)),
    (tuple(f'{PLACE}.{a}' for a in 'xyz'), lambda old, rng: old + float(rng.choice([2.0, -5.0]))),
    (tuple(f'{FORCE}.{a}' for a in 'xyz'), _put(400.0, -1000.0)),
    (tuple(f'{GYRO}.{a}' for a in 'xyz'), _put(100.0, -500.0)),
)


def filtered(flight: Flight, rng: Generator) -> Corrupted | None:
    """A vector passes a low-pass (Butterworth, order 4, both ways) at 2 to 8 % of its rate."""
    if flight.is_simulated or quiet(flight):
        return None
    vectors = [v for v in (PLACE, SPEED, SPIN, GYRO, FORCE) if f'{v}.x' in flight.channels
               and len(flight.channels[f'{v}.x'].values) > 300]  # fmt: skip
    if not vectors:
        return None
    vector = vectors[int(rng.integers(len(vectors)))]
    cut = float(rng.uniform(0.02, 0.08))
    sos = butter(4, 2.0 * cut, output='sos')
    new = {
        f'{vector}.{a}': sosfiltfilt(sos, flight.channels[f'{vector}.{a}'].values) for a in 'xyz'
    }
    when = whole(flight.channels[f'{vector}.x'])
    return Corrupted(
        changed(flight, new), (vector,), *when, f'{vector} below {cut:.3f} of the rate'
    )


def quiet(flight: Flight) -> bool:
    """Whether a flight is filtered already: RGBlimp's are constant in command and very smooth."""
    return any(name.startswith('wrench_command') for name in flight.channels)


UNITS: Final = (
    (SPIN, 180.0 / np.pi), (GYRO, 180.0 / np.pi), (GYRO, 180.0 / np.pi), (SPEED, 1000.0),
    (SPEED, 100.0), (PLACE, 1000.0), (PLACE, 1000.0), (FORCE, 1.0 / STANDARD_GRAVITY),
    (FORCE, 1000.0), (FORCE, 1000.0 / STANDARD_GRAVITY), ('range/range', 1000.0),
    ('pressure/fluid_pressure', 0.01), ('pressure/fluid_pressure', 0.001),
    ('battery/voltage', 1000.0), ('motors/effort', 100.0), ('motors/effort', 255.0),
    ('motors/effort', 65535.0),
)  # fmt: skip


def unit(flight: Flight, rng: Generator) -> Corrupted | None:
    """A quantity is in another unit throughout: 17 kinds."""
    vector, factor = UNITS[int(rng.integers(len(UNITS)))]
    names = [
        n for n, c in flight.channels.items() if n == vector or roles.vector_name(n) == vector
    ]
    if not names or (vector in (SPIN, GYRO) and TURN + '.x' not in flight.channels):
        return None
    channel = flight.channels[names[0]]
    if vector == 'range/range' and not np.isfinite(channel.values).mean() > 0.5:
        return None
    if vector == 'motors/effort' and max(flight.channels[n].values.max() for n in names) < 0.1:
        return None
    how = f'{vector} x {factor:.4g}'
    return Corrupted(scaled(flight, names, factor), (vector, *names), *whole(channel), how)


def stamps(flight: Flight, rng: Generator) -> Corrupted | None:
    """A topic's stamps go back, jump, leave out a stretch or many messages, or come twice."""
    topics = sorted({c.topic for c in flight.channels.values() if len(c.time) > 150})
    if not topics:
        return None
    topic = topics[int(rng.integers(len(topics)))]
    channel = next(c for c in flight.channels.values() if c.topic == topic)
    period = float(np.median(np.diff(channel.time)))
    keep, time = np.ones(len(channel.time), dtype=np.bool_), channel.time.copy()
    low, high = span(rng, channel, max(0.4, 8.0 * period), 4.0)
    way = int(rng.integers(4))
    if way == 0:
        keep[low:high] = False
    elif way == 1:
        keep = rng.random(len(keep)) > float(rng.uniform(0.1, 0.4))
        low, high = 0, len(keep)
    elif way == 2:
        time[low:] -= float(rng.uniform(0.05, 2.0)) + period
    else:
        time[low:high] = time[low]
    when = (min(float(time[low]), over(channel, low, high)[0]), over(channel, low, high)[1])
    new = dict(flight.channels)
    for name, known in flight.channels.items():
        if known.topic == topic and len(known.time) == len(keep):
            new[name] = replace(known, time=time[keep], values=known.values[keep])
    ways = ('gap', 'dropouts', 'back', 'twice')
    return Corrupted(replace(flight, channels=new), (topic,), *when, f'{topic} {ways[way]}')


def twin(flight: Flight, rng: Generator) -> Corrupted | None:
    """
    The same run again: trimmed, moved in time, its place moved, rounded, in single precision.

    At least 6 s and 60 % of it are left.
    """
    if f'{PLACE}.x' not in flight.channels and f'{GYRO}.x' not in flight.channels:
        return None
    name = f'{PLACE}.x' if f'{PLACE}.x' in flight.channels else f'{GYRO}.x'
    total = float(flight.channels[name].time[-1])
    size = max(8.0, total * float(rng.uniform(0.6, 0.95)))
    begin = float(rng.uniform(0.0, total - size))
    cut = piece(flight, begin, begin + size)
    late = float(rng.uniform(0.0, 5.0))
    new = {}
    for channel in cut.channels.values():
        values = channel.values.astype(np.float32).astype(np.float64)
        if channel.name.startswith(PLACE):
            values = values + float(rng.uniform(-1.0, 1.0))
        step = float(rng.choice([1e-6, 1e-5, 1e-4]))
        values = np.round(values / step) * step
        new[channel.name] = replace(channel, time=channel.time + late, values=values)
    return Corrupted(
        replace(cut, channels=new), (), late, late + size, f'{size:.0f} of {total:.0f} s'
    )


CORRUPTIONS: Final[dict[str, Corruption]] = {
    'constant': constant,
    'frozen': frozen,
    'clipped': clipped,
    'duplicate': duplicate,
    'impossible': impossible,
    'filtered': filtered,
    'unit': unit,
    'axes': axes,
    'clock': clock,
    'stamps': stamps,
    'held': held,
}
