# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Detect values that are impossible, whatever the flight.

Above a third of the sampling rate an airship hardly moves, so that the spectrum there is the noise
of the instrument. Second differences remove the motion before the spectrum is taken, to avoid
leakage. A noise floor below any instrument's means that there was no noise, or that filtering
removed it and distorted derivatives and lags as well.
"""

from collections import defaultdict
from collections.abc import Iterator, Sequence

from lta_config.constants import STANDARD_GRAVITY
from lta_data.data_quality import limits, roles
from lta_data.data_quality.motion import collect_poses, InertialSeries, PoseSeries
from lta_data.data_quality.recording import CheckContext, CheckVerdict, QualityFinding, Severity
from lta_data.data_quality.roles import build_light_ranges, CELLS, RANGES, ValidRange
from lta_data.even_grid import find_runs, merge_runs, sort_samples
from lta_data.flight import Channel
from lta_data.interpretation.jumps import find_steps
import numpy as np
from numpy.typing import NDArray

KIND = 'impossible'
LOST_KEY = 'lost'  # key of a finding about values that are not there, rather than wrong
STRETCH_GAP = 20  # samples between bad values that still form one stretch
MAX_STRETCHES = 20  # stretches beyond which all are one
UNIT_LENGTH = 0.01  # tolerance of a quaternion: single precision, three-digit rounding
REST_BLOCK = 25  # samples per block in the search for rest


def find_impossible_values(evidence: CheckContext) -> CheckVerdict:
    """Find values outside the possible range of their quantity."""
    channels = evidence.recording.channels
    findings: list[QualityFinding] = []
    ranges = (*RANGES, *build_light_ranges(evidence.adc_full_scale))
    for channel in channels.values():
        findings += find_out_of_range(channel, ranges)
        findings += find_non_numbers(channel)
        if channel.name == 'battery/voltage':
            findings += find_impossible_voltages(channel)
    for topic in dict.fromkeys(channel.topic for channel in channels.values()):
        findings += find_unnormalized_quaternions(
            [c for c in channels.values() if c.topic == topic]
        )
    for pose in collect_poses(channels, evenly=False):
        # An estimate jumps where a lamp or a tracker corrects it
        if roles.is_instrument_topic(pose.topic):
            findings += find_jumps(pose)
    for sensor in evidence.inertials:
        findings += find_missing_gravity(sensor)
    return CheckVerdict(tuple(findings))


def build_stretch_findings(
    channel: str,
    time: NDArray[np.float64],
    bad: NDArray[np.bool_],
    sentence: str,
    key: str = 'values',
) -> Iterator[QualityFinding]:
    """Yield a finding for each stretch of bad values, whose number is stored by a key."""
    stretches = [*merge_runs(find_runs(bad), STRETCH_GAP)]
    if len(stretches) > MAX_STRETCHES:
        stretches = [(stretches[0][0], stretches[-1][1])]
    for begin, end in stretches:
        count = int(bad[begin:end].sum())
        yield QualityFinding(
            KIND, channel, float(time[begin]), float(time[end - 1]),
            f'{count} impossible {"value" if count == 1 else "values"}: {sentence}.',
            Severity.ERROR, {key: float(count)},
        )  # fmt: skip


def find_out_of_range(channel: Channel, ranges: Sequence[ValidRange]) -> Iterator[QualityFinding]:
    """Yield values outside the range of their quantity."""
    for allowed in ranges:
        if allowed.names.search(channel.name):
            values = channel.values
            finite = np.isfinite(values)
            bad = finite & ((values < allowed.low) | (values > allowed.high))
            if bad.any():
                worst = values[bad][np.argmax(np.abs(values[bad]))]  # with its sign
                text = f'the most extreme is {worst:.6g} {channel.unit}, but {allowed.reason}'
                yield from build_stretch_findings(channel.name, channel.time, bad, text)


def find_non_numbers(channel: Channel) -> Iterator[QualityFinding]:
    """Yield infinite values, and NaN between numbers, in quantities that are always defined."""
    if roles.match_noisy_quantity(channel) is None or not np.isfinite(channel.values).any():
        return  # `coverage` says what was never measured
    infinite = np.isinf(channel.values)
    yield from build_stretch_findings(channel.name, channel.time, infinite, 'infinite')
    missing = np.isnan(channel.values)
    first, last = np.flatnonzero(~missing)[[0, -1]]
    # NaN before the first and after the last value means not yet or no longer measured.
    missing[:first] = missing[last:] = False
    yield from build_stretch_findings(
        channel.name, channel.time, missing, 'not a number', LOST_KEY
    )


def find_impossible_voltages(channel: Channel) -> Iterator[QualityFinding]:
    """Yield voltages that neither a cell nor a pack can have."""
    values = channel.values
    inside = np.zeros(len(values), dtype=np.bool_)
    for low, high in CELLS:
        inside |= (values >= low) & (values <= high)
    bad = np.isfinite(values) & ~inside
    if bad.any():
        worst = float(values[bad][0])
        text = f'{worst:.4g} V is neither a cell (2.5 to 4.4 V) nor a battery pack (5 to 61 V)'
        yield from build_stretch_findings(channel.name, channel.time, bad, text)


def find_unnormalized_quaternions(channels: list[Channel]) -> Iterator[QualityFinding]:
    """Yield quaternions of a topic without unit length."""
    parts: dict[str, dict[str, Channel]] = {}
    for channel in channels:
        match = roles.QUATERNION_FIELD.match(channel.field)
        if match is not None:
            parts.setdefault(match[1], {})[match[2]] = channel
    for path, channels_by_part in parts.items():
        if len(channels_by_part) != 4:
            continue
        topic, time = channels_by_part['w'].topic, channels_by_part['w'].time
        length = np.sqrt(sum(channels_by_part[part].values ** 2 for part in 'xyzw'))
        bad = np.isfinite(length) & (np.abs(length - 1.0) > UNIT_LENGTH)
        # Many senders leave the attitude unset: a note only
        if bad.all() and not length.any():
            yield QualityFinding(
                KIND, f'{topic}/{path}', float(time[0]), float(time[-1]),
                'Every quaternion is zero: the sender does not fill it in.', Severity.NOTE,
            )  # fmt: skip
        elif bad.any():
            text = f'a quaternion has length {length[bad][0]:.4g}, but an attitude needs length 1'
            yield from build_stretch_findings(f'{topic}/{path}', time, bad, text)


def find_jumps(pose: PoseSeries) -> Iterator[QualityFinding]:
    """Yield positions and attitudes that the inertia of no vehicle reaches from the last ones."""
    for vector, least, unit in (
        (pose.position, limits.JUMP_SIZE, 'm'),
        (pose.attitude, limits.JUMP_TURN, 'rad'),
    ):
        if vector is None or len(vector.time) < limits.LEAST_SAMPLES:
            continue
        step = np.diff(vector.time)
        bad, off = find_steps(vector.time, vector.values, least)
        if not bad.any():
            continue
        size = float(off[bad].max())
        how = (
            f'the position jumps by up to {size:.2f} m'
            if unit == 'm'
            else f'the attitude turns by up to {np.degrees(size):.0f} degrees'
        )
        text = (
            f'{how} from one pose to the next ({np.median(step[bad]):.3g} s), which the inertia '
            'of no vehicle allows: the tracker took other markers, or another body, for it'
        )
        yield from build_stretch_findings(vector.name, vector.time[1:], bad, text)


def find_missing_gravity(sensor: InertialSeries) -> Iterator[QualityFinding]:
    """Yield an accelerometer at rest that does not measure gravity."""
    force = sensor.force
    if force is None or len(force.time) < 4 * REST_BLOCK:
        return
    size = np.linalg.norm(force.values, axis=1)
    count = len(size) // REST_BLOCK
    blocks = size[: count * REST_BLOCK].reshape(count, REST_BLOCK)
    # The limit scales with the reading, so that a wrong unit does not hide rest.
    rest = blocks.std(axis=1) < limits.STILL_SPREAD * np.median(size) / STANDARD_GRAVITY
    # A single quiet block may be chance
    if rest.sum() < 3:
        return
    felt = float(np.median(blocks[rest]))
    apart = abs(felt - STANDARD_GRAVITY)
    if (
        limits.STILL_FORCE < apart < 0.7 * STANDARD_GRAVITY
    ):  # larger deviations come from a wrong unit
        times = force.time[: count * REST_BLOCK].reshape(count, REST_BLOCK)[rest]
        yield QualityFinding(
            KIND, force.name, float(times[0, 0]), float(times[-1, -1]),
            f'At rest the accelerometer measures {felt:.2f} m/s2, not 9.81 m/s2.',
            Severity.SUSPICIOUS, {'force': felt},
        )  # fmt: skip


FILTERED = 'filtered'
NOISE_LEVELS = {
    'position': limits.QUIET_POSITION,
    'attitude': limits.QUIET_ATTITUDE,
    'velocity': limits.QUIET_VELOCITY,
    'turning': limits.QUIET_RATES,
    'rates': limits.QUIET_RATES,
    'force': limits.QUIET_FORCE,
    'pressure': limits.QUIET_PRESSURE,
}
SPECTRUM_WINDOW = 128  # samples of a spectrum
FROM = 0.35  # lower limit of the noise band, of the sampling rate
QUIET_AXES_SHARE = 0.5  # least share of the axes of a vector that lack noise


def find_missing_noise(evidence: CheckContext) -> CheckVerdict:
    """Find vectors with less noise than any instrument."""
    # A declared simulation may be free of noise.
    if evidence.recording.is_simulated:
        return CheckVerdict()
    groups: defaultdict[tuple[str, str], list[Channel]] = defaultdict(list)
    for channel in evidence.recording.channels.values():
        what = roles.match_noisy_quantity(channel)
        # A quantity that was not logged has no numbers
        if what is not None and np.isfinite(channel.values).any():
            groups[what, roles.vector_name(channel.name)].append(channel)
    findings, unjudged = [], []
    for (what, name), group in groups.items():
        levels = [channel_noise(channel) for channel in group]
        # Zero noise is a constant channel, which another check reports.
        positive = np.array([level for level in levels if level is not None and level > 0.0])
        if len(positive) == 0:
            unjudged.append(
                f"The noise of '{name}' cannot be judged: it has fewer than "
                f'{2 * SPECTRUM_WINDOW} values.'
            )
            continue
        least = NOISE_LEVELS[what]
        if np.mean(positive < least) >= QUIET_AXES_SHARE and (positive < least).sum() >= min(
            2, len(group)
        ):
            findings.append(
                build_smoothness_finding(name, group[0], float(np.median(positive)), least)
            )
    return CheckVerdict(tuple(findings), tuple(unjudged))


def channel_noise(channel: Channel) -> float | None:
    """Return the RMS noise of a channel, in its unit; None if it is too short."""
    _, table = sort_samples(channel.time, channel.values[:, None]).select_complete()
    # A jump from pi to -pi would look like noise
    values = np.unwrap(table[:, 0]) if channel.angular else table[:, 0]
    if len(values) < 2 * SPECTRUM_WINDOW:
        return None
    return high_frequency_noise(np.asarray(values, dtype=np.float64))


def high_frequency_noise(values: NDArray[np.float64]) -> float:
    """
    Return the RMS of white noise at the level of the highest frequencies, in the unit of values.

    The spectrum is the median over half-overlapping Blackman windows.
    """
    # Second differences suppress the slow motion, which would leak into the noise band
    bent = np.diff(values, 2)
    starts = np.arange(0, len(bent) - SPECTRUM_WINDOW + 1, SPECTRUM_WINDOW // 2)
    # Low side lobes, for the same reason
    shape = np.blackman(SPECTRUM_WINDOW)
    pieces = np.stack([bent[start : start + SPECTRUM_WINDOW] for start in starts]) * shape
    power = np.abs(np.fft.rfft(pieces, axis=1)) ** 2 / (shape**2).sum()
    share = np.arange(power.shape[1]) / SPECTRUM_WINDOW
    high = share >= FROM
    # Undo the frequency response of the second difference.
    gain = (2.0 * np.sin(np.pi * share[high])) ** 4
    # The median over windows ignores those with impacts
    return float(np.sqrt(np.mean(np.median(power, axis=0)[high] / gain)))


def build_smoothness_finding(
    name: str, channel: Channel, level: float, least: float
) -> QualityFinding:
    """Return the finding of a vector without noise."""
    unit = channel.unit
    return QualityFinding(
        FILTERED, name, float(channel.time[0]), float(channel.time[-1]),
        f'The noise above a third of the sampling rate is {level:.1e} {unit}, but even the '
        f'quietest real sensors have {least:.0e} {unit}: the data are heavily filtered, or '
        'simulated but not marked so; do not rely on their derivatives, delays and fast motion.',
        Severity.WARNING, {'noise': level, 'least': least},
    )  # fmt: skip
