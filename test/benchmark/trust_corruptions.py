"""
What can be wrong with a recording, done to a clean one: size, channel and interval by chance.

A corruption returns the changed recording and what a check should name, or None where the flight
has nothing that it could be done to (no IMU, no range, a craft that hardly moves). The least sizes
are those of docs/trust.md.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Final

from lta_analysis.bag.attitude import angles
from lta_analysis.bag.channels import Channel
from lta_analysis.trust import roles
from lta_analysis.trust.motion import attitudes
from lta_analysis.trust.recording import Recording
from lta_analysis.trust.smooth import kernel, smoothed
from lta_config.constants import STANDARD_GRAVITY
import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray
from scipy.signal import butter, sosfiltfilt
from scipy.spatial.transform import Rotation
from trust_flights import piece

Array = NDArray[np.float64]
TRUTH: Final = 'ground_truth/odom'
PLACE: Final = f'{TRUTH}/pose.pose.position'
TURN: Final = f'{TRUTH}/pose.pose.orientation'
SPEED: Final = f'{TRUTH}/twist.twist.linear'
SPIN: Final = f'{TRUTH}/twist.twist.angular'
GYRO: Final = 'imu/angular_velocity'
FORCE: Final = 'imu/linear_acceleration'


@dataclass(frozen=True, slots=True)
class Corrupted:
    """A corrupted recording, and what should be found: any of these names, in this interval."""

    recording: Recording
    names: tuple[str, ...]
    from_s: float
    to_s: float
    how: str


Corruption = Callable[[Recording, Generator], Corrupted | None]


def changed(flight: Recording, new: Mapping[str, Array]) -> Recording:
    """Return a recording with other values in some channels."""
    channels = dict(flight.channels)
    for name, values in new.items():
        channels[name] = replace(channels[name], values=values)
    return replace(flight, channels=channels)


def restless(flight: Recording) -> list[Channel]:
    """Return the channels of instruments that never rest and that move in this flight."""
    return [
        c
        for c in flight.channels.values()
        if roles.restless(c) and len(c.values) > 100 and len(np.unique(c.values)) > 40
    ]


def pick(rng: Generator, some: list[Channel]) -> Channel | None:
    """Draw a channel."""
    return some[int(rng.integers(len(some)))] if some else None


def span(rng: Generator, channel: Channel, least: float, most: float) -> tuple[int, int]:
    """Draw an interval inside a channel, not at its ends, as indices."""
    time = channel.time
    total = float(time[-1] - time[0])
    size = min(float(np.exp(rng.uniform(np.log(least), np.log(most)))), 0.4 * total)
    begin = float(time[0]) + float(rng.uniform(0.15, 0.85)) * (total - size)
    low, high = np.searchsorted(time, [begin, begin + size])
    return int(low), int(max(high, low + 2))


def over(channel: Channel, low: int, high: int) -> tuple[float, float]:
    """Return an interval of indices as times."""
    return float(channel.time[low]), float(channel.time[min(high, len(channel.time)) - 1])


def whole(channel: Channel) -> tuple[float, float]:
    """Return all of a channel's time."""
    return float(channel.time[0]), float(channel.time[-1])


def constant(flight: Recording, rng: Generator) -> Corrupted | None:
    """One channel has its first value throughout."""
    channel = pick(rng, restless(flight))
    if channel is None:
        return None
    values = np.full_like(channel.values, channel.values[len(channel.values) // 2])
    new = changed(flight, {channel.name: values})
    return Corrupted(new, (channel.name,), *whole(channel), f'{channel.name} constant')


def frozen(flight: Recording, rng: Generator) -> Corrupted | None:
    """One channel, or a whole vector, stands still for 0.4 to 5 s in flight."""
    channel = pick(rng, restless(flight))
    if channel is None:
        return None
    low, high = span(rng, channel, 0.4, 5.0)
    high = max(high, low + 10)
    family = roles.family(channel.name)
    names = [channel.name]
    if rng.random() < 0.3:
        names = [n for n, c in flight.channels.items() if roles.family(n) == family]
    new = {}
    for name in names:
        values = flight.channels[name].values.copy()
        values[low:high] = values[low]
        new[name] = values
    when = over(channel, low, high)
    return Corrupted(changed(flight, new), tuple(names), *when, f'{len(names)} {family} frozen')


def clipped(flight: Recording, rng: Generator) -> Corrupted | None:
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


def duplicate(flight: Recording, rng: Generator) -> Corrupted | None:
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


def impossible(flight: Recording, rng: Generator) -> Corrupted | None:
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
    return Corrupted(changed(flight, new), (name, roles.family(name)), *over(channel, low, high),
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


def filtered(flight: Recording, rng: Generator) -> Corrupted | None:
    """A vector passes a low-pass (Butterworth, order 4, both ways) at 2 to 8 % of its rate."""
    if flight.simulated or quiet(flight):
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


def quiet(flight: Recording) -> bool:
    """Whether a flight is filtered already: RGBlimp's are constant in command and very smooth."""
    return any(name.startswith('wrench_command') for name in flight.channels)


def scaled(flight: Recording, names: list[str], factor: float) -> Recording:
    """Return a recording with some channels multiplied."""
    return changed(flight, {name: flight.channels[name].values * factor for name in names})


UNITS: Final = (
    (SPIN, 180.0 / np.pi), (GYRO, 180.0 / np.pi), (GYRO, 180.0 / np.pi), (SPEED, 1000.0),
    (SPEED, 100.0), (PLACE, 1000.0), (PLACE, 1000.0), (FORCE, 1.0 / STANDARD_GRAVITY),
    (FORCE, 1000.0), (FORCE, 1000.0 / STANDARD_GRAVITY), ('range/range', 1000.0),
    ('pressure/fluid_pressure', 0.01), ('pressure/fluid_pressure', 0.001),
    ('battery/voltage', 1000.0), ('motors/effort', 100.0), ('motors/effort', 255.0),
    ('motors/effort', 65535.0),
)  # fmt: skip


def unit(flight: Recording, rng: Generator) -> Corrupted | None:
    """A quantity is in another unit throughout: 17 kinds."""
    vector, factor = UNITS[int(rng.integers(len(UNITS)))]
    names = [n for n, c in flight.channels.items() if n == vector or roles.family(n) == vector]
    if not names or (vector in (SPIN, GYRO) and TURN + '.x' not in flight.channels):
        return None
    channel = flight.channels[names[0]]
    if vector == 'range/range' and not np.isfinite(channel.values).mean() > 0.5:
        return None
    if vector == 'motors/effort' and max(flight.channels[n].values.max() for n in names) < 0.1:
        return None
    how = f'{vector} x {factor:.4g}'
    return Corrupted(scaled(flight, names, factor), (vector, *names), *whole(channel), how)


def axes(flight: Recording, rng: Generator) -> Corrupted | None:
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


def judged(flight: Recording) -> list[str]:
    """Return the vectors that have a tracked pose beside them."""
    if f'{TURN}.x' not in flight.channels:
        return []
    return [vector for vector in (SPIN, GYRO, SPEED) if f'{vector}.x' in flight.channels]


def lively(flight: Recording, vector: str) -> list[str]:
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


def quick(flight: Recording, vector: str) -> bool:
    """Whether a vector changes within seconds, by 0.01 rad/s or m/s RMS at least in one axis."""
    time = flight.channels[f'{vector}.x'].time
    if len(time) < 200:
        return False
    step = float(np.median(np.diff(time)))
    table = np.stack([flight.channels[f'{vector}.{axis}'].values for axis in 'xyz'], axis=1)
    calm = smoothed(table, kernel(0.3, step))
    end = round(1.5 / step)
    changing = (calm - smoothed(calm, kernel(3.0, step)))[end:-end]
    return bool(len(changing) and changing.std(axis=0).max() > 0.01)


def throughout(flight: Recording, vector: str) -> bool:
    """Whether a vector does so in each third of the flight: else nothing can wander."""
    total = float(flight.channels[f'{vector}.x'].time[-1])
    thirds = (piece(flight, total * part / 3.0, total * (part + 1) / 3.0) for part in range(3))
    return all(quick(third, vector) for third in thirds)


def flipped(flight: Recording, rng: Generator) -> Corrupted | None:
    """One axis of a vector that moves has the other sign."""
    choices = [f'{v}.{axis}' for v in judged(flight) for axis in lively(flight, v)]
    if not choices:
        return None
    name = choices[int(rng.integers(len(choices)))]
    new = scaled(flight, [name], -1.0)
    return Corrupted(new, (name, roles.family(name)), *whole(flight.channels[name]), f'-{name}')


def swapped(flight: Recording, rng: Generator) -> Corrupted | None:
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


def turned(flight: Recording, quaternions: Array) -> Recording:
    """Return a recording with another attitude."""
    new = {f'{TURN}.{part}': column for part, column in zip('xyzw', quaternions.T, strict=True)}
    told = zip(('yaw', 'pitch', 'roll'), angles(quaternions), strict=True)
    return changed(flight, new | {f'{TURN}.{part}': values for part, values in told})


def reread(flight: Recording, rng: Generator) -> Corrupted | None:
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


def in_map(flight: Recording) -> Corrupted | None:
    """The velocity of an odometry is in the frame of the map."""
    if SPEED not in judged(flight) or not lively(flight, SPEED):
        return None
    turn = attitudes(flight.channels)[TRUTH]
    yaw = angles(turn.values).yaw
    known = np.stack([flight.channels[f'{SPEED}.{a}'].values for a in 'xyz'], axis=1)
    # Where the nose keeps to +x the two frames are one.
    if len(turn.values) != len(known) or np.median(np.abs(yaw)) < 0.8:
        return None
    rotated = Rotation.from_quat(turn.values).apply(known)
    new = {f'{SPEED}.{a}': column for a, column in zip('xyz', rotated.T, strict=True)}
    when = whole(flight.channels[f'{SPEED}.x'])
    return Corrupted(changed(flight, new), (SPEED, TURN, PLACE), *when, 'in the map')


def clock(flight: Recording, rng: Generator) -> Corrupted | None:
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


def stamps(flight: Recording, rng: Generator) -> Corrupted | None:
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


def held(flight: Recording, rng: Generator) -> Corrupted | None:
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


def topics_of(flight: Recording) -> set[str]:
    """Return the topics of a recording."""
    return {channel.topic for channel in flight.channels.values()}


def moved(
    flight: Recording, start: float, end: float, rng: Generator, tremor: float, carry: float
) -> Recording:
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
            turn = attitudes(flight.channels)[TRUTH]
            at = np.stack([np.interp(time, turn.time, column) for column in turn.values.T], axis=1)
            added = Rotation.from_quat(at).inv().apply(added)
        for index, axis in enumerate('xyz'):
            new[f'{name}.{axis}'] = flight.channels[f'{name}.{axis}'].values + added[:, index]
    return changed(flight, new)


def twin(flight: Recording, rng: Generator) -> Corrupted | None:
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
