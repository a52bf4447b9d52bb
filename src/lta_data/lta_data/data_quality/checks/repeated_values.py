# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Detect values that no noisy instrument repeats: constant, frozen, clipped or copied.

Consecutive equal values are regular if a slow instrument is sampled fast, and random if its
resolution is coarse; a run is suspicious if it is much longer than either explains. Measured
values thin out towards their extremes; at a limit, the extreme value is the most frequent one, and
it lasts for several samples. And two stretches of an instrument's noise are never equal bit for
bit, in single precision either, so that a conversion of type does not hide a copy.
"""

from collections import defaultdict
from collections.abc import Iterator
import math

from lta_data.data_quality import limits, roles
from lta_data.data_quality.recording import CheckContext, CheckVerdict, QualityFinding, Severity
from lta_data.even_grid import find_coarse_unit, find_runs, median_period
from lta_data.flight import Channel
import numpy as np
from numpy.typing import NDArray

CONSTANT_KIND = 'constant'


def find_constant_channels(evidence: CheckContext) -> CheckVerdict:
    """Find constant channels, and vectors that were never filled in."""
    groups: defaultdict[str, list[Channel]] = defaultdict(list)
    for channel in evidence.recording.channels.values():
        if should_vary(channel) and np.isfinite(channel.values).sum() >= limits.LEAST_SAMPLES:
            groups[roles.vector_name(channel.name)].append(channel)
    findings: list[QualityFinding] = []
    for name, group in groups.items():
        still = [channel for channel in group if is_constant(channel)]
        # In a simulated truth, zero components and entirely constant vectors are legitimate.
        if evidence.recording.is_simulated and name.startswith('ground_truth'):
            still = [
                channel
                for channel in still
                if len(still) < len(group) and first_finite_value(channel)
            ]
        # Many senders leave unknown vectors at zero: a note, not a suspicion
        if len(still) == len(group) > 1 and all(
            first_finite_value(channel) == 0.0 for channel in still
        ):
            findings.append(build_unfilled_finding(name, still[0]))
        else:
            findings += [build_constant_finding(channel) for channel in still]
    return CheckVerdict(tuple(findings))


def should_vary(channel: Channel) -> bool:
    """Return whether a channel of an instrument should change all the time."""
    if roles.match_noisy_quantity(channel) is not None:
        return True
    lit = bool(roles.SHINE.match(channel.field)) and channel.topic == 'photodiodes'
    return roles.is_measured(channel) and (lit or channel.name == 'range/range')


def is_constant(channel: Channel) -> bool:
    """Return whether all finite values are equal."""
    values = channel.values[np.isfinite(channel.values)]
    return bool((values == values[0]).all())


def first_finite_value(channel: Channel) -> float:
    """Return the first finite value."""
    return float(channel.values[np.isfinite(channel.values)][0])


def build_unfilled_finding(name: str, channel: Channel) -> QualityFinding:
    """Return the finding of a vector that is always zero: its sender has no such quantity."""
    text = (
        f'All components are exactly 0 in all {len(channel.time)} messages: the sender does '
        'not fill them in.'
    )
    # Zero angles are an identity quaternion, which is set; an unset one has length 0
    if roles.ANGLE.match(channel.field):
        text = (
            f'The attitude is the identity in all {len(channel.time)} messages, exactly level '
            'with heading 0: the sender may not measure it.'
        )
    return QualityFinding(
        CONSTANT_KIND, name, float(channel.time[0]), float(channel.time[-1]), text, Severity.NOTE
    )


def build_constant_finding(channel: Channel) -> QualityFinding:
    """Return the finding of a constant channel."""
    held = first_finite_value(channel)
    why = 'the noise of a real sensor would change them.'
    if held == 0.0 and roles.ANGLE.match(channel.field):
        why = (
            'the angle was not recorded, and the import of a log without its column takes it as '
            'zero. Export it, too: models are fitted to the tilt.'
        )
    return QualityFinding(
        CONSTANT_KIND, channel.name, float(channel.time[0]), float(channel.time[-1]),
        f'All {len(channel.time)} values are {held:.6g} {channel.unit}; {why}',
        Severity.SUSPICIOUS, {'value': held},
    )  # fmt: skip


FROZEN = 'frozen'
START_SAMPLES = 3  # samples within which a run counts as starting at the beginning
RELEASED = 5.0  # least jump at the end of a freeze, in usual steps
HIDDEN_UNITS = 2.5  # units to which readings are rounded; a motion may change them so much at once
REST_RESIDUAL_SPEED = 1e-9  # residual speed of a simulated vehicle at rest
USUAL = 90.0  # percentile of the run lengths that counts as regular


def find_freezes(evidence: CheckContext) -> CheckVerdict:
    """Find freezes in noisy channels."""
    findings = [
        finding
        for channel in evidence.recording.channels.values()
        if roles.match_noisy_quantity(channel) and len(channel.values) >= limits.LEAST_SAMPLES
        for finding in find_channel_freezes(channel, evidence.recording.is_simulated)
    ]
    return CheckVerdict(tuple(findings))


def find_channel_freezes(channel: Channel, simulated: bool) -> Iterator[QualityFinding]:
    """Yield the freezes of one channel."""
    values = channel.values
    if not np.isfinite(values).any() or is_constant(channel):
        return
    with np.errstate(invalid='ignore'):
        equal = np.diff(values) == 0.0
    if simulated:  # exactly constant until take-off
        equal[: find_initial_run_end(equal)] = False
    runs = find_runs(equal)
    lengths = runs[:, 1] - runs[:, 0]
    # Of each value, most of which are read once
    holds = np.diff(np.flatnonzero(np.concatenate(([True], ~equal, [True]))))
    low, high = np.nanmin(values), np.nanmax(values)
    hidden = HIDDEN_UNITS * find_coarse_unit(values)
    for (begin, end), length in zip(runs.tolist(), lengths.tolist(), strict=True):
        held = values[begin]
        # A run at an extreme is clipping, which another check reports
        piled = held in {low, high} and not ends_with_jump(values, end)
        rests = (
            simulated
            and channel.topic.startswith('ground_truth')
            and (end == len(equal) or abs(held) < REST_RESIDUAL_SPEED)
        )
        # Rounded readings of a slow motion repeat; those of a frozen one jump when it goes on
        slow = hidden and not abs(values[min(end + 1, len(equal))] - held) > hidden
        if piled or rests or slow or length + 1 < limits.FROZEN_SAMPLES:
            continue
        # Sample-and-hold data have long runs all the time.
        usual = np.percentile(holds, USUAL)
        # Share of equal neighbours outside this run: how often the sensor repeats a value anyway
        share = (equal.sum() - length) / max(1, len(equal) - length)
        # Probability of such a run at any position, if equal neighbours were independent.
        chance = math.log(len(equal)) + length * math.log(max(share, 1.0 / len(equal)))
        last = float(channel.time[end]) - float(channel.time[begin])
        if (
            chance < math.log(limits.FROZEN_CHANCE)
            and length > limits.FROZEN_TIMES * max(1.0, float(usual))
            and last + median_period(channel.time) > limits.FROZEN_TIME
        ):
            yield build_freeze_finding(channel, begin, end)


def find_initial_run_end(equal: NDArray[np.bool_]) -> int:
    """Return the end of a run at the beginning; 0 without one."""
    runs = find_runs(equal)
    return int(runs[0, 1]) if len(runs) and runs[0, 0] <= START_SAMPLES else 0


def ends_with_jump(values: NDArray[np.float64], end: int) -> bool:
    """
    Return whether a run at an extreme ends with a jump.

    A clipped signal leaves the limit continuously; a frozen one has moved on in the meantime.
    """
    if end + 1 >= len(values):
        return False
    with np.errstate(invalid='ignore'):
        steps = np.abs(np.diff(values))
    steps = steps[np.isfinite(steps)]
    usual = float(np.median(steps[steps > 0.0]))
    return bool(abs(values[end + 1] - values[end]) > RELEASED * usual)


def build_freeze_finding(channel: Channel, begin: int, end: int) -> QualityFinding:
    """Return the finding of a frozen stretch."""
    first, last = float(channel.time[begin]), float(channel.time[end])
    held = float(channel.values[begin])
    return QualityFinding(
        FROZEN, channel.name, first, last,
        f'The value is stuck at {held:.6g} {channel.unit} for {end - begin + 1} readings '
        f'({last - first:.2f} s), but changes before and after.',
        Severity.SUSPICIOUS, {'value': held, 'readings': end - begin + 1.0},
    )  # fmt: skip


CLIPPED = 'clipped'
NEIGHBOURS = 3  # adjacent values whose counts are compared
ADC = 'photodiodes'
UNKNOWN_TOP = (
    "The range of the photodiodes' ADC is unknown, because the recording has no readable vehicle "
    'file: clipping at its upper end cannot be judged.'
)


def find_clipping(evidence: CheckContext) -> CheckVerdict:
    """Find accumulations at extremes, and ADC blocks at the limits of the ADC."""
    findings: list[QualityFinding] = []
    for channel in evidence.recording.channels.values():
        if roles.match_noisy_quantity(channel):
            findings += find_pileups(channel, evidence.recording.is_simulated)
        elif channel.topic == ADC and channel.field.startswith(('min[', 'max[')):
            findings += find_railed_blocks(channel, evidence)
    lit = any(channel.topic == ADC for channel in evidence.recording.channels.values())
    return CheckVerdict(
        tuple(findings), (UNKNOWN_TOP,) if lit and evidence.adc_full_scale is None else ()
    )


def find_pileups(channel: Channel, simulated: bool) -> Iterator[QualityFinding]:
    """Yield the extremes of one channel at which values accumulate."""
    good = np.isfinite(channel.values)
    if simulated:  # exactly constant until take-off
        good[
            : find_initial_run_end(np.diff(channel.values, prepend=channel.values[:1]) == 0.0)
        ] = False
    values, time = channel.values[good], channel.time[good]
    if len(values) < limits.LEAST_SAMPLES or is_constant(channel) or find_coarse_unit(values):
        return
    levels, counts = np.unique(values, return_counts=True)
    for side, word in ((0, 'lowest'), (-1, 'highest')):
        count = int(counts[side])
        # np.unique sorts, so the next counts belong to the values next to the extreme
        beside = counts[1 : 1 + NEIGHBOURS] if side == 0 else counts[-1 - NEIGHBOURS : -1]
        if count < limits.CLIPPED_SAMPLES or count < limits.CLIPPED_PILE * float(
            np.median(beside)
        ):
            continue
        at = find_runs(values == levels[side])
        alone = len(at) == 1
        # A simulated vehicle on the floor is at its extreme, unclipped.
        rests = simulated and alone and (at[0, 0] <= START_SAMPLES or at[0, 1] == len(values))
        # A single run that ends with a jump is a freeze, which another check reports
        stopped = alone and ends_with_jump(values, int(at[0, 1]) - 1)
        if (at[:, 1] - at[:, 0]).max() < limits.CLIPPED_RUN or rests or stopped:
            continue
        yield QualityFinding(
            CLIPPED, channel.name, float(time[at[0, 0]]), float(time[at[-1, 1] - 1]),
            f'{count} of {len(values)} readings have the {word} value, {levels[side]:.6g} '
            f'{channel.unit}, but the adjacent values occur only {np.median(beside):.0f} '
            'times each: the channel is clipped.',
            Severity.SUSPICIOUS, {'limit': float(levels[side]), 'readings': float(count)},
        )  # fmt: skip


def find_railed_blocks(channel: Channel, evidence: CheckContext) -> Iterator[QualityFinding]:
    """Yield the span in which blocks of one diode reach a limit of the ADC."""
    # Counts; the lower limit of a single-ended ADC is zero
    end = evidence.adc_full_scale if channel.field.startswith('max[') else 0.0
    if end is None:
        return
    at = channel.values == end
    if int(at.sum()) >= limits.ADC_BLOCKS:
        times = channel.time[at]
        yield QualityFinding(
            CLIPPED, channel.name, float(times[0]), float(times[-1]),
            f'{int(at.sum())} of {len(at)} sample blocks reach the ADC limit of {end:.0f} counts.',
            Severity.SUSPICIOUS, {'limit': end, 'blocks': float(at.sum())},
        )  # fmt: skip


DUPLICATE = 'duplicate'
ULPS = 256  # least range of a stretch, in steps of single precision


def find_duplication(evidence: CheckContext) -> CheckVerdict:
    """Find repeated stretches in noisy channels."""
    findings = [
        finding
        for channel in evidence.recording.channels.values()
        if roles.match_noisy_quantity(channel)
        for finding in find_repeats(channel)
    ]
    return CheckVerdict(tuple(findings))


def hash_windows(values: NDArray[np.float64], length: int) -> NDArray[np.uint64]:
    """Return a hash of each window of `length` readings, by single-precision bits."""
    # Plus one, or zeros would not contribute to the hash
    bits = values.astype(np.float32).view(np.uint32).astype(np.uint64) + np.uint64(1)
    # Random odd weights: a multilinear hash modulo 2^64.
    factor = np.random.default_rng(0).integers(1, 2**62, length, dtype=np.uint64) * np.uint64(2)
    total = np.zeros(len(values) - length + 1, dtype=np.uint64)
    # Overflow is the modulo 2^64
    with np.errstate(over='ignore'):
        for index, weight in enumerate(factor + np.uint64(1)):
            total += bits[index : index + len(total)] * weight
    return total


def find_repeats(channel: Channel) -> Iterator[QualityFinding]:
    """Yield the repeated stretches of one channel."""
    values, length = channel.values, limits.DUPLICATED_SAMPLES
    if len(values) < 2 * length or find_coarse_unit(values):
        return
    finite = np.isfinite(values)
    single = np.where(finite, values, 0.0).astype(np.float32)
    changing = np.diff(single) != 0.0
    # Number of changes within each window; constant windows are equal without duplication
    lively = np.convolve(changing, np.ones(length - 1), mode='valid') >= limits.DUPLICATED_LEVELS
    windows = np.lib.stride_tricks.sliding_window_view(single, length)
    # A slow channel has few distinct values in single precision and repeats by chance.
    fine = np.ptp(windows, axis=1) > ULPS * np.spacing(np.abs(windows).max(axis=1))
    lively &= fine & np.lib.stride_tricks.sliding_window_view(finite, length).all(axis=1)
    hashes = hash_windows(values, length)
    # Equal windows are adjacent after sorting by hash, the earlier one first
    order = np.argsort(hashes, kind='stable')
    same = (hashes[order][1:] == hashes[order][:-1]) & lively[order][1:]
    first, again = order[:-1][same], order[1:][same]
    apart = again - first
    rising = np.argsort(again)
    first, again, apart = first[rising], again[rising], apart[rising]
    # Consecutive windows with one distance form one stretch.
    breaks = np.flatnonzero((np.diff(again) != 1) | (np.diff(apart) != 0)) + 1
    for part in np.split(np.arange(len(again)), breaks):
        # A shorter distance would be an overlap of the window with itself
        if len(part) and apart[part[0]] >= length:
            yield build_repeat_finding(
                channel, int(first[part[0]]), int(again[part[0]]), len(part) + length - 1
            )


def build_repeat_finding(channel: Channel, first: int, again: int, count: int) -> QualityFinding:
    """Return the finding of a repeated stretch."""
    time = channel.time
    begin, end = float(time[again]), float(time[min(again + count, len(time)) - 1])
    return QualityFinding(
        DUPLICATE, channel.name, begin, end,
        f'{count} readings in a row are identical bit for bit to those from {time[first]:.2f} s '
        'on.',
        Severity.SUSPICIOUS, {'from_s': float(time[first]), 'readings': float(count)},
    )  # fmt: skip
