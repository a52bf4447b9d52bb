"""Values that cannot be, whatever the flight."""

from collections.abc import Iterator, Sequence

from lta_config.constants import STANDARD_GRAVITY
from lta_data.bag.channels import Channel
from lta_data.trust import roles
from lta_data.trust.evidence import Evidence
from lta_data.trust.finding import Finding, Severity, Verdict
from lta_data.trust.limits import Limits
from lta_data.trust.motion import Inertial, Pose
from lta_data.trust.possible import CELLS, of_light, Range, RANGES
from lta_data.trust.runs import merged, runs
import numpy as np
from numpy.typing import NDArray

KIND = 'impossible'
APART = 20  # samples between two bad ones that are told as one stretch
UNIT_LENGTH = 0.01  # of a quaternion: single precision and rounding to three digits
QUIET = 25  # samples of an accelerometer at rest


def check(evidence: Evidence) -> Verdict:
    """Find values outside what their quantity can have."""
    channels, limits = evidence.recording.channels, evidence.limits
    found: list[Finding] = []
    ranges = (*RANGES, *of_light(evidence.top))
    for channel in channels.values():
        found += outside(channel, ranges)
        found += not_numbers(channel)
        if channel.name == 'battery/voltage':
            found += no_cell(channel)
    for topic in dict.fromkeys(channel.topic for channel in channels.values()):
        found += lengths([c for c in channels.values() if c.topic == topic])
    for pose in evidence.poses:
        found += jumps(pose, limits)
    for sensor in evidence.inertials:
        found += at_rest(sensor, limits)
    return Verdict(tuple(found))


def stretches(
    channel: str, time: NDArray[np.float64], bad: NDArray[np.bool_], sentence: str
) -> Iterator[Finding]:
    """Yield a finding for each stretch of bad values."""
    for begin, end in merged(runs(bad), APART):
        count = int(bad[begin:end].sum())
        yield Finding(
            KIND, channel, float(time[begin]), float(time[end - 1]),
            f'{count} {"value" if count == 1 else "values"}: {sentence}.',
            Severity.ERROR, {'values': float(count)},
        )  # fmt: skip


def outside(channel: Channel, ranges: Sequence[Range]) -> Iterator[Finding]:
    """Yield values outside the range of their quantity."""
    for known in ranges:
        if known.names.search(channel.name):
            values = channel.values
            finite = np.isfinite(values)
            bad = finite & ((values < known.low) | (values > known.high))
            if bad.any():
                worst = values[bad][np.argmax(np.abs(values[bad]))]
                told = f'up to {worst:.6g} {channel.unit}, but {known.reason}'
                yield from stretches(channel.name, channel.time, bad, told)


def not_numbers(channel: Channel) -> Iterator[Finding]:
    """Yield what is infinite, or no number between numbers, in a quantity that always has one."""
    if roles.restless(channel) is None or not np.isfinite(channel.values).any():
        return
    infinite = np.isinf(channel.values)
    yield from stretches(channel.name, channel.time, infinite, 'infinite')
    missing = np.isnan(channel.values)
    first, last = np.flatnonzero(~missing)[[0, -1]]
    missing[:first] = missing[last:] = False
    yield from stretches(channel.name, channel.time, missing, 'not a number')


def no_cell(channel: Channel) -> Iterator[Finding]:
    """Yield voltages that no cell and no pack has."""
    values = channel.values
    inside = np.zeros(len(values), dtype=np.bool_)
    for low, high in CELLS:
        inside |= (values >= low) & (values <= high)
    bad = np.isfinite(values) & ~inside
    if bad.any():
        worst = float(values[bad][0])
        told = f'{worst:.4g} V, which no cell has (2.5 to 4.4 V) and no pack of them'
        yield from stretches(channel.name, channel.time, bad, told)


def lengths(channels: list[Channel]) -> Iterator[Finding]:
    """Yield the quaternions of a topic that are not of unit length."""
    parts: dict[str, dict[str, Channel]] = {}
    for channel in channels:
        match = roles.QUATERNION.match(channel.field)
        if match is not None:
            parts.setdefault(match[1], {})[match[2]] = channel
    for path, found in parts.items():
        if len(found) != 4:
            continue
        topic, time = found['w'].topic, found['w'].time
        length = np.sqrt(sum(found[part].values ** 2 for part in 'xyzw'))
        bad = np.isfinite(length) & (np.abs(length - 1.0) > UNIT_LENGTH)
        if bad.all() and not length.any():
            yield Finding(
                KIND, f'{topic}/{path}', float(time[0]), float(time[-1]),
                'Every quaternion is zero: nobody filled it in.', Severity.NOTE,
            )  # fmt: skip
        elif bad.any():
            told = f'a quaternion of length {length[bad][0]:.4g} is no attitude'
            yield from stretches(f'{topic}/{path}', time, bad, told)


def jumps(pose: Pose, limits: Limits) -> Iterator[Finding]:
    """Yield places that cannot be reached from the one before."""
    if pose.position is None or len(pose.position.time) < limits.least_samples:
        return
    time, place = pose.position.time, pose.position.values
    far = np.linalg.norm(np.diff(place, axis=0), axis=1)
    speed = far / np.diff(time)
    usual = float(np.percentile(speed, 75))
    # Where all of it is too fast, the unit is wrong, which another check says.
    bad = (speed > limits.jump_speed) & (far > limits.jump_size) & (speed > 20.0 * usual)
    if bad.any():
        told = f'a jump of {far[bad].max():.2f} m, at {speed[bad].max():.0f} m/s'
        yield from stretches(pose.position.name, time[1:], bad, told)


def at_rest(sensor: Inertial, limits: Limits) -> Iterator[Finding]:
    """Yield a resting accelerometer that does not feel gravity."""
    force = sensor.force
    if force is None or len(force.time) < 4 * QUIET:
        return
    size = np.linalg.norm(force.values, axis=1)
    count = len(size) // QUIET
    blocks = size[: count * QUIET].reshape(count, QUIET)
    rest = blocks.std(axis=1) < limits.still_spread * np.median(size) / STANDARD_GRAVITY
    if rest.sum() < 3:
        return
    felt = float(np.median(blocks[rest]))
    apart = abs(felt - STANDARD_GRAVITY)
    if limits.still_force < apart < 0.7 * STANDARD_GRAVITY:  # beyond it is a unit
        times = force.time[: count * QUIET].reshape(count, QUIET)[rest]
        yield Finding(
            KIND, force.name, float(times[0, 0]), float(times[-1, -1]),
            f'At rest the specific force is {felt:.2f} m/s2, not 9.81.',
            Severity.SUSPICIOUS, {'force': felt},
        )  # fmt: skip
